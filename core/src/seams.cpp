#include "seams.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "index_table.hpp"
#include "place.hpp"
#include "union_find.hpp"

namespace cagecast {
namespace {

/// SPEC §9: an edge is smeared if it is so many times longer in UV than the cage explains, and so much in UV besides.
constexpr double kSmear = 4;
constexpr double kSmearSlack = 0.005;
/// SPEC §9: how far from a corner's place its patch reaches, in longest edges and in shares of the diagonal.
constexpr double kPatchEdges = 1.5;
constexpr double kPatchSlack = 0.01;
/// SPEC §9: sums of distances within this share of the diagonal are equal.
constexpr double kTieSum = 1e-7;

/// UVs up to here are exact enough as floats for a first look: they are off by less than the slack above.
constexpr float kMostUv = 16384;
/// What the first look allows of the explained length, squared: the exact limit less what floats round.
constexpr double kFirstLook = 0.99 * kSmear * kSmear;

/// A vertex of the cage as the texture knows it.
struct Site {
  float x, y, z, u, v;

  static Site of(const MeshView& mesh, std::size_t vertex) {
    const float* p = mesh.positions.data() + 3 * vertex;
    const float* uv = mesh.uvs.data() + 2 * vertex;
    return {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f, uv[0] + 0.0f, uv[1] + 0.0f};  // Now −0 is 0.
  }
  friend bool operator==(const Site& a, const Site& b) { return std::memcmp(&a, &b, sizeof(Site)) == 0; }
  [[nodiscard]] std::uint64_t hash() const {
    std::uint32_t words[5];
    static_assert(sizeof words == sizeof(Site));
    std::memcpy(words, this, sizeof words);
    std::uint64_t hash = 0;
    for (const std::uint32_t word : words) hash = IndexTable::mix(hash, word);
    return hash;
  }
};

/// How the cage's triangles hang together in the texture: over edges with equal position and UV at both ends.
/// Side 3 · t + k goes from corner k of triangle t to the next one.
struct Atlas {
  std::uint32_t* nextSide;  ///< 1 per side: another side on the same edge; all sides of an edge form a ring.
  std::uint32_t* islands;   ///< 1 per triangle: equal for those that hang together.
  double* stretch;          ///< 1 per triangle: the most of its edges' UV length / length, squared.
  float* explains;          ///< 1 per triangle: what the first look allows per squared length.
};

bool findAtlas(const MeshView& mesh, const Cage& cage, Scratch& scratch, Atlas& atlas) {
  const std::size_t sideCount = std::size_t{3} * cage.count;
  atlas.nextSide = scratch.take<std::uint32_t>(sideCount);
  atlas.islands = scratch.take<std::uint32_t>(cage.count);
  atlas.stretch = scratch.take<double>(cage.count);
  atlas.explains = scratch.take<float>(cage.count);
  const Scratch::Mark mark = scratch.mark();
  const std::size_t vertexCount = mesh.positions.size() / 3;
  auto* siteOf = scratch.take<std::uint32_t>(vertexCount);
  auto* edges = scratch.take<std::uint64_t>(sideCount);
  IndexTable sites(vertexCount, scratch);
  IndexTable edgeTable(sideCount, scratch);
  if (scratch.failed()) return false;

  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const Site site = Site::of(mesh, v);
    siteOf[v] = sites.firstEqual(v, site.hash(), [&](std::uint32_t other) { return Site::of(mesh, other) == site; });
  }
  UnionFind sets(atlas.islands, cage.count);
  float mostUv = 0;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const CageTriangle& triangle = cage.triangles[t];
    const std::uint32_t* index = mesh.indices.data() + std::size_t{3} * triangle.index;
    double stretch = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3;
      const std::uint32_t side = 3 * t + k;
      const std::uint64_t low = std::min(siteOf[index[k]], siteOf[index[l]]);
      const std::uint64_t edge = low << 32 | std::max(siteOf[index[k]], siteOf[index[l]]);
      edges[side] = edge;
      const std::uint32_t first =
          edgeTable.firstEqual(side, IndexTable::mix(0, edge), [&](std::uint32_t other) { return edges[other] == edge; });
      atlas.nextSide[side] = side;
      std::swap(atlas.nextSide[side], atlas.nextSide[first]);
      sets.join(t, first / 3);

      const double du = static_cast<double>(triangle.uvs[2 * l]) - static_cast<double>(triangle.uvs[2 * k]);
      const double dv = static_cast<double>(triangle.uvs[2 * l + 1]) - static_cast<double>(triangle.uvs[2 * k + 1]);
      stretch = std::max(stretch, (du * du + dv * dv) * triangle.inverseSquare[k]);
    }
    atlas.stretch[t] = stretch;
    // Below infinity, so that a product with it stays a number.
    atlas.explains[t] = static_cast<float>(std::min(kFirstLook * stretch, 1e30));
    for (const float x : triangle.uvs) mostUv = std::max(mostUv, std::abs(x));
  }
  sets.flatten(cage.count);
  if (mostUv > kMostUv) std::fill(atlas.explains, atlas.explains + cage.count, -std::numeric_limits<float>::infinity());
  scratch.rewind(mark);
  return true;
}

/// A corner of a target triangle, and its place on the cage.
struct Corner {
  Vec3 p;
  std::uint32_t slot;
  Place place;
};

/// Finds the patch of the cage that serves a triangle across a seam.
class Mender {
 public:
  /// Takes what it needs from `scratch`; `scratch.failed()` tells if that was there.
  Mender(const Cage& cage, const Atlas& atlas, double diagonal, Scratch& scratch) noexcept
      : cage_(cage),
        atlas_(atlas),
        diagonal_(diagonal),
        patch_(scratch.take<std::uint32_t>(cage.count)),
        triangleSeen_(scratch.take<std::uint32_t>(cage.count)),
        sideSeen_(scratch.take<std::uint32_t>(std::size_t{3} * cage.count)),
        candidates_(scratch.take<Candidate>(cage.count)) {
    if (scratch.failed()) return;
    std::fill(triangleSeen_, triangleSeen_ + cage.count, 0u);
    std::fill(sideSeen_, sideSeen_ + std::size_t{3} * cage.count, 0u);
  }

  /// Whether the texture is torn or smeared over a triangle, in double.
  [[nodiscard]] bool isAcross(const Corner (&corners)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      const Corner& a = corners[k];
      const Corner& b = corners[(k + 1) % 3];
      if (atlas_.islands[a.slot] != atlas_.islands[b.slot]) return true;
      double uvA[2];
      double uvB[2];
      uvAt(cage_.triangles[a.slot], a.place, uvA);
      uvAt(cage_.triangles[b.slot], b.place, uvB);
      const double du = uvB[0] - uvA[0];
      const double dv = uvB[1] - uvA[1];
      const double path = length(b.p - a.p) + std::abs(b.place.distance - a.place.distance);
      const double explained = std::sqrt(std::max(atlas_.stretch[a.slot], atlas_.stretch[b.slot])) * path;
      if (std::sqrt(du * du + dv * dv) > kSmear * explained + kSmearSlack) return true;
    }
    return false;
  }

  /// Projects the corners onto the patch around that one of them which brings all of them nearest.
  /// @param[out] uvs  6 floats.
  void mend(const Corner (&corners)[3], float* uvs) noexcept {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, length(corners[(k + 1) % 3].p - corners[k].p));
    const double reach = kPatchEdges * longest + kPatchSlack * diagonal_;

    struct Choice {
      double sum;
      Candidate corners[3];
    };
    Choice choices[3];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const bool isKnown = std::any_of(corners, corners + k, [&](const Corner& c) { return c.slot == corners[k].slot; });
      if (isKnown) continue;
      const std::uint32_t size = grow(corners[k], reach);
      Choice& choice = choices[count++];
      choice.sum = 0;
      for (int c = 0; c < 3; ++c) {
        choice.corners[c] = nearestInPatch(size, corners[c].p);
        choice.sum += choice.corners[c].place.distance;
      }
    }
    double least = choices[0].sum;
    for (int i = 1; i < count; ++i) least = std::min(least, choices[i].sum);
    int chosen = 0;
    while (choices[chosen].sum > least + kTieSum * diagonal_) ++chosen;
    for (int c = 0; c < 3; ++c) {
      const Candidate& corner = choices[chosen].corners[c];
      uvAt(cage_.triangles[corner.slot], corner.place, uvs + 2 * c);
    }
  }

 private:
  /// Floods the cage from a corner's triangle over edges shared in the texture, as far as it is within reach of the
  /// corner's place.
  /// @return How many triangles `patch_` now holds: at least 1.
  std::uint32_t grow(const Corner& from, double reach) noexcept {
    const CageTriangle& start = cage_.triangles[from.slot];
    const Vec3 a = Vec3::from(start.a);
    const Vec3 q = a + from.place.v * (Vec3::from(start.b) - a) + from.place.w * (Vec3::from(start.c) - a);
    ++flood_;  // Marks of earlier floods do not count.
    patch_[0] = from.slot;
    triangleSeen_[from.slot] = flood_;
    std::uint32_t size = 1;
    for (std::uint32_t i = 0; i < size; ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t side = 3 * patch_[i] + k;
        if (sideSeen_[side] == flood_) continue;
        sideSeen_[side] = flood_;
        for (std::uint32_t other = atlas_.nextSide[side]; other != side; other = atlas_.nextSide[other]) {
          sideSeen_[other] = flood_;
          const std::uint32_t t = other / 3;
          if (triangleSeen_[t] == flood_) continue;
          triangleSeen_[t] = flood_;
          if (placeOn(cage_.triangles[t], q).distance <= reach) patch_[size++] = t;
        }
      }
    }
    return size;
  }

  /// Step 1 once more, with the patch for a cage.
  [[nodiscard]] Candidate nearestInPatch(std::uint32_t size, Vec3 p) noexcept {
    std::uint32_t count = 0;
    double limit = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < size; ++i) {
      const Place place = placeOn(cage_.triangles[patch_[i]], p);
      if (place.distance > limit) continue;
      limit = std::min(limit, place.distance + kTieDistance * diagonal_);
      candidates_[count++] = {patch_[i], place};
    }
    return nearestOf(candidates_, count, diagonal_);
  }

  const Cage& cage_;
  const Atlas& atlas_;
  double diagonal_;
  std::uint32_t* patch_;         ///< Triangles of the cage.
  std::uint32_t* triangleSeen_;  ///< 1 per triangle: the last flood that met it.
  std::uint32_t* sideSeen_;      ///< 1 per side, likewise.
  std::uint32_t flood_ = 0;      ///< At most 3 · kMaxTriangles, less than 2^32.
  Candidate* candidates_;
};

}  // namespace

bool findCornerUvs(const MeshView& cageMesh, const MeshView& targetMesh, const Points& points, const Cage& cage,
                   const Units& units, const PointResults& results, Scratch& scratch, float* cornerUvs) noexcept {
  const Scratch::Mark mark = scratch.mark();
  Atlas atlas;
  if (!findAtlas(cageMesh, cage, scratch, atlas)) return false;
  Mender mender(cage, atlas, units.diagonal, scratch);
  if (scratch.failed()) return false;

  // A first look in float: most triangles are clearly whole in the texture.
  const auto edgeIsWhole = [&](std::uint32_t i, std::uint32_t j) {
    const float* p = points.at(i);
    const float* q = points.at(j);
    const float x = q[0] - p[0];
    const float y = q[1] - p[1];
    const float z = q[2] - p[2];
    const float u = results.uvs[2 * j] - results.uvs[2 * i];
    const float v = results.uvs[2 * j + 1] - results.uvs[2 * i + 1];
    const float explains = std::max(atlas.explains[results.triangles[i]], atlas.explains[results.triangles[j]]);
    return atlas.islands[results.triangles[i]] == atlas.islands[results.triangles[j]] &&
           u * u + v * v <= explains * (x * x + y * y + z * z);
  };
  const std::size_t allTriangles = targetMesh.indices.size() / 3;
  std::uint32_t usable = 0;
  for (std::size_t t = 0; t < allTriangles; ++t) {
    const std::uint32_t* index = targetMesh.indices.data() + 3 * t;
    const std::uint32_t point[3] = {points.ofVertex[index[0]], points.ofVertex[index[1]], points.ofVertex[index[2]]};
    float* uvs = cornerUvs + 6 * t;
    for (int c = 0; c < 3; ++c) std::memcpy(uvs + 2 * c, results.uvs + std::size_t{2} * point[c], 2 * sizeof(float));
    // `points.triangles` has those with an area, in the same order.
    if (usable == points.triangleCount || !std::equal(point, point + 3, points.triangles + std::size_t{3} * usable)) continue;
    ++usable;
    if (edgeIsWhole(point[0], point[1]) && edgeIsWhole(point[1], point[2]) && edgeIsWhole(point[2], point[0])) continue;

    Corner corners[3];
    for (int c = 0; c < 3; ++c) {
      const Vec3 p = Vec3::from(points.at(point[c]));
      const std::uint32_t slot = results.triangles[point[c]];
      corners[c] = {p, slot, placeOn(cage.triangles[slot], p)};
    }
    if (mender.isAcross(corners)) mender.mend(corners, uvs);
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
