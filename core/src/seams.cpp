#include "seams.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "atlas.hpp"
#include "near_kernel.hpp"
#include "place.hpp"
#include "rims.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 9: how far from a corner's place its patch reaches, in longest edges and in shares of the diagonal.
constexpr double kPatchEdges = 1.5;
constexpr double kPatchSlack = 0.01;
/// docs/method.md, step 9: sums of distances within this share of the diagonal are equal.
constexpr double kTieSum = 1e-7;

/// UVs up to here are exact enough as floats for a first look: they are off by a hundredth of the slack at most.
constexpr float kMostUv = 256;
/// What the first look allows of the squares of the explained length and of the slack: less than the exact limit, which is the square
/// of their sum, by more than floats round.
constexpr double kFirstLook = 0.99 * kSmear * kSmear;
constexpr double kFirstSlack = 0.9 * kSmearSlack * kSmearSlack;

/// What the first look knows of the place of a point of the target.
struct alignas(16) FirstLook {
  float u, v;
  float explains;  ///< Squared UV length per squared length, on the triangle of the cage under the point.
  float island;    ///< Of that triangle: the number.
};
/// Numbers up to here are exact as floats.
constexpr std::uint32_t kMostIslands = 1u << 24;

/// A corner of a target triangle, and its place on the cage.
struct Corner {
  std::uint32_t point;
  const float* position;  ///< x, y, z.
  Vec3 p;                 ///< The same.
  Candidate at;
  Uv uv;  ///< Of that place.
};

/// Finds the patch of the cage that serves a triangle across a seam.
class Mender {
 public:
  /// Takes what it needs from `scratch`; `scratch.failed()` tells if that was there.
  Mender(const Cage& cage, const CageTree& tree, const Atlas& atlas, double diagonal, Scratch& scratch) noexcept
      : cage_(cage),
        tree_(tree),
        atlas_(atlas),
        diagonal_(diagonal),
        fixedSlack_(fixedSlack(slackOf(tree, diagonal), kRelativeSlack)),
        rows_(scratch.take<NearTriangle>(cage.count)),
        candidates_(scratch.take<Candidate>(cage.count)) {
    for (int k = 0; k < 3; ++k) {
      near_[k] = scratch.take<std::uint32_t>(std::size_t{cage.count} + 1);
      Patch& patch = patches_[k];
      patch.triangles = scratch.take<std::uint32_t>(std::size_t{cage.count} + 3);
      patch.squaredDistances = scratch.take<float>(std::size_t{4} * (std::size_t{cage.count} + 1));
      patch.seen = scratch.take<std::uint32_t>(std::size_t{4} * cage.count);
      if (scratch.failed()) return;
      patch.sideSeen = patch.seen + cage.count;
      std::fill(patch.seen, patch.sideSeen + std::size_t{3} * cage.count, 0u);
    }
    for (std::uint32_t i = 0; i < tree.leafCount; ++i) {
      NearTriangle four[4];
      NearTriangle::of(tree.near[i], four);
      // Leaves are full but for the last.
      for (std::uint32_t k = 0; k < std::min(4u, cage.count - 4 * i); ++k) rows_[tree.near[i].slot[k]] = four[k];
    }
  }

  /// Finds the place of a point of the target on the triangle that it is nearest to.
  void setCorner(Corner& corner, std::uint32_t point, const float* position, std::uint32_t t) const noexcept {
    corner.point = point;
    corner.position = position;
    corner.p = Vec3::from(position);
    setPlace(corner.at, corner.p, t);
    corner.uv = uvOf(corner.at);
  }

  /// Whether the texture is torn or smeared over a triangle, in double.
  [[nodiscard]] bool isAcross(const Corner* const (&corners)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      const Corner& a = *corners[k];
      const Corner& b = *corners[(k + 1) % 3];
      const Landing from{a.at.slot, a.at.place.distance, a.uv};
      const Landing to{b.at.slot, b.at.place.distance, b.uv};
      if (atlas_.tears(from, to, length(b.p - a.p))) return true;
    }
    return false;
  }

  /// Projects the corners onto the patch around that one of them which brings all of them nearest.
  /// @param[out] uvs  6 floats.
  void mend(const Corner* const (&corners)[3], float* uvs) noexcept {
    double longest = 0;  // Squared.
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = corners[(k + 1) % 3]->p - corners[k]->p;
      longest = std::max(longest, dot(edge, edge));
      known_[k].count = 0;
    }
    const double reach = kPatchEdges * std::sqrt(longest) + kPatchSlack * diagonal_;

    // In float first: which of the patches might bring the corners nearest. They grow in turn, ring by ring. How many triangles a
    // ring leaves is known only when its looks are through: until then there are those of the other patches.
    ++triangle_;
    const auto isKnown = [&](int k) {
      return std::any_of(corners, corners + k, [&](const Corner* c) { return c->at.slot == corners[k]->at.slot; });
    };
    for (int k = 0; k < 3; ++k) {
      if (isKnown(k)) {
        patches_[k].size = patches_[k].end = 0;
        patches_[k].leastSquares = simd::splat(std::numeric_limits<float>::infinity());
      } else {
        begin(corners, k, reach, patches_[k]);
      }
    }
    grow();
    double sums[3];
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      sums[k] = patches_[k].sum();
      least = std::min(least, sums[k]);
    }
    const double unsure = kTieSum * diagonal_ + 6 * (kTieDistance * diagonal_ + kRounding * (tree_.extent + least));
    Choice choices[3];
    int count = 0;
    const double limit = least + unsure;
    least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      if (sums[k] > limit) continue;
      project(corners, patches_[k], choices[count]);
      least = std::min(least, choices[count++].sum);
    }
    int chosen = 0;
    while (choices[chosen].sum > least + kTieSum * diagonal_) ++chosen;
    std::copy_n(choices[chosen].uvs, 6, uvs);
  }

 private:
  /// The corners' places on one patch.
  struct Choice {
    double sum;  ///< Of the distances.
    float uvs[6];
  };
  /// Places of a corner that were decided already: patches of a triangle have most of them in common.
  struct Known {
    static constexpr std::uint32_t kMost = 3;
    std::uint32_t count;
    Candidate places[kMost];
  };

  /// What hangs together in the texture with the triangle under a corner, within reach of the corner's place: rings of
  /// triangles, and how far they are from the three corners and, lane 3, from the place.
  struct Patch {
    Vec3 place;
    double reach;
    std::uint32_t first;         ///< The triangle that the place is on.
    std::uint32_t size;          ///< Triangles so far,
    std::uint32_t kept;          ///< with what was kept of those next to the last ring,
    std::uint32_t end;           ///< and, before they are looked at, with all of those.
    std::uint32_t* triangles;
    float* squaredDistances;     ///< 4 per triangle.
    simd::f32x4 leastSquares;    ///< For each of the four.
    simd::f32x4 x, y, z;         ///< The corners and the place.
    simd::f32x4 limits;          ///< Squared distances: up to lane 0 surely within reach, up to the others perhaps.
    std::uint32_t* seen;         ///< 1 per triangle: the last one of the target for which it was met.
    std::uint32_t* sideSeen;     ///< 1 per side: the last one for which a round about its edge was made.

    [[nodiscard]] bool isGrowing() const noexcept { return size < end; }
    /// Of the corners' distances to the patch, in float.
    [[nodiscard]] double sum() const noexcept {
      float least[4];
      simd::store(least, leastSquares);
      double all = 0;
      for (int c = 0; c < 3; ++c) all += std::sqrt(static_cast<double>(least[c]));
      return all;
    }
  };

  static constexpr int kPlace = 3;
  /// Beyond lane 0 of `Patch::limits`, within the others.
  static constexpr unsigned kUnsure = 0b1110;

  /// Begins the patch of corner k.
  void begin(const Corner* const (&corners)[3], int k, double reach, Patch& patch) noexcept {
    const auto& [from, place] = corners[k]->at;
    const Vec3 q = positionOf(cage_.triangles[from], place);
    // One look at a triangle, in float, tells how far it is from the three corners and from q.
    const auto four = [&](int axis, double ofPlace) {
      const auto lane = [&](int c) { return corners[c]->position[axis]; };
      return simd::of(lane(0), lane(1), lane(2), static_cast<float>(ofPlace)) - simd::splat(tree_.middle[axis]);
    };
    patch.x = four(0, q.x);
    patch.y = four(1, q.y);
    patch.z = four(2, q.z);
    const double rounding = 2 * kRounding * (tree_.extent + reach + std::abs(q.x) + std::abs(q.y) + std::abs(q.z));
    const double surely = std::max(0.0, reach - rounding);
    const auto within = static_cast<float>(surely * surely);
    const auto beyond = static_cast<float>((reach + rounding) * (reach + rounding));
    patch.limits = simd::of(within, beyond, beyond, beyond);
    patch.leastSquares = simd::splat(std::numeric_limits<float>::max());
    patch.place = q;
    patch.reach = reach;
    patch.first = from;
    patch.seen[patch.first] = triangle_;
    patch.triangles[0] = patch.first;
    patch.size = 0;
    patch.end = 1;
  }

  /// Grows the patches, ring by ring. By itself, so that it has all registers.
  [[gnu::noinline]] void grow() noexcept {
    while (patches_[0].isGrowing() || patches_[1].isGrowing() || patches_[2].isGrowing()) {
      for (Patch& patch : patches_) look(patch);
      for (Patch& patch : patches_) meet(patch);
    }
  }

  /// Looks at the triangles next to the last ring, and keeps those near enough.
  void look(Patch& patch) noexcept {
    // In registers, as stores might change the patch for all the compiler knows.
    std::uint32_t* const triangles = patch.triangles;
    float* const squares = patch.squaredDistances;
    const NearTriangle* const rows = rows_;
    const std::uint32_t end = patch.end;
    std::uint32_t size = patch.size;
    for (std::uint32_t i = size; i < end; ++i) {
      const std::uint32_t t = triangles[i];
      const simd::f32x4 squared = squaredDistances(rows[t], patch.x, patch.y, patch.z);
      // No branch that is a coin toss: what is not kept is written over by the next.
      const unsigned isWithin = simd::bits(simd::splatLane<kPlace>(squared) <= patch.limits);
      std::uint32_t isNear = isWithin & 1;
      if (isWithin == kUnsure) isNear = t == patch.first || placeOn(cage_.triangles[t], patch.place).distance <= patch.reach;
      simd::store(squares + std::size_t{4} * size, squared);
      triangles[size] = t;
      size += isNear;
    }
    patch.kept = size;
  }

  /// Adds the triangles that were kept, and finds what is next to them.
  void meet(Patch& patch) noexcept {
    // In registers, as above.
    std::uint32_t* const triangles = patch.triangles;
    std::uint32_t* const seen = patch.seen;
    const float* const squares = patch.squaredDistances;
    const Beside* const besides = atlas_.beside;
    const std::uint32_t triangle = triangle_;
    const std::uint32_t kept = patch.kept;
    simd::f32x4 least = patch.leastSquares;
    std::uint32_t end = kept;
    const auto add = [&](std::uint32_t t) {
      triangles[end] = t;
      end += seen[t] != triangle;
      seen[t] = triangle;
    };
    for (std::uint32_t i = patch.size; i < kept; ++i) {
      least = simd::min(least, simd::load(squares + std::size_t{4} * i));
      const Beside& beside = besides[triangles[i]];
      for (const std::uint32_t t : beside.triangles) add(t);
      if (beside.isOnFan == 0) continue;
      const std::uint32_t sides = 3 * triangles[i];
      for (std::uint32_t side = sides; side < sides + 3; ++side) {
        if (patch.sideSeen[side] == triangle_) continue;
        // One round for all triangles that share the edge, however many.
        for (std::uint32_t more = atlas_.nextSide[side]; more != side; more = atlas_.nextSide[more]) {
          patch.sideSeen[more] = triangle_;
          add(more / 3);
        }
      }
    }
    patch.leastSquares = least;
    patch.size = kept;
    patch.end = end;
  }

  /// Projects the corners onto a patch: step 1 once more, with the patch for a cage.
  void project(const Corner* const (&corners)[3], const Patch& patch, Choice& out) noexcept {
    const simd::f32x4 limits = patch.leastSquares * simd::splat(1 + static_cast<float>(kRelativeSlack)) + simd::splat(fixedSlack_);
    std::uint32_t counts[3] = {};
    for (std::uint32_t i = 0; i < patch.size; ++i) {
      const unsigned isNear = simd::bits(simd::load(patch.squaredDistances + 4 * i) <= limits);
      for (int c = 0; c < 3; ++c) {
        near_[c][counts[c]] = patch.triangles[i];
        counts[c] += isNear >> c & 1;
      }
    }
    out.sum = 0;
    for (int c = 0; c < 3; ++c) {
      const auto candidate = [&](std::uint32_t i) -> const Candidate& {
        return placeOf(*corners[c], known_[c], near_[c][i], candidates_[i]);
      };
      // Copied only if there are several.
      const Candidate* nearest = &candidate(0);
      if (counts[c] > 1) {
        candidates_[0] = *nearest;
        for (std::uint32_t i = 1; i < counts[c]; ++i) candidates_[i] = candidate(i);
        nearest = &nearestOf(candidates_, counts[c], diagonal_);
      }
      out.sum += nearest->place.distance;
      simd::storeRounded(out.uvs + 2 * c, blendUvs(cage_.triangles[nearest->slot], nearest->place));
    }
  }

  [[nodiscard]] Uv uvOf(const Candidate& at) const noexcept { return uvAt(cage_.triangles[at.slot], at.place); }

  void setPlace(Candidate& at, const Vec3& p, std::uint32_t t) const noexcept {
    at.slot = t;
    at.place = placeOn(cage_.triangles[t], p);
  }
  /// @param spare  Where to put the place if too many are known.
  [[nodiscard]] const Candidate& placeOf(const Corner& corner, Known& known, std::uint32_t t, Candidate& spare) const noexcept {
    if (corner.at.slot == t) return corner.at;
    for (std::uint32_t i = 0; i < known.count; ++i) {
      if (known.places[i].slot == t) return known.places[i];
    }
    Candidate& place = known.count < Known::kMost ? known.places[known.count++] : spare;
    setPlace(place, corner.p, t);
    return place;
  }

  const Cage& cage_;
  const CageTree& tree_;
  const Atlas& atlas_;
  double diagonal_;
  float fixedSlack_;
  NearTriangle* rows_;           ///< 1 per triangle: all that a look needs in two cache lines, where a leaf has it in six.
  std::uint32_t triangle_ = 0;   ///< How many of the target's were mended.
  Patch patches_[3];             ///< Around each corner's place,
  std::uint32_t* near_[3];       ///< what of it might be nearest to each corner,
  Candidate* candidates_;        ///< and where: of one corner.
  Known known_[3];               ///< Of each corner.
};

}  // namespace

bool findCornerUvs(const MeshView& targetMesh, const Points& points, const Cage& cage, const CageEdges& edges,
                   const CageTree& tree, const Units& units, const PointResults& results, Scratch& scratch, float* cornerUvs) noexcept {
  const Scratch::Mark mark = scratch.mark();
  Atlas atlas;
  if (!findAtlas(cage, edges, scratch, atlas)) return false;
  Mender mender(cage, tree, atlas, units.diagonal, scratch);
  auto* looks = scratch.take<FirstLook>(points.count);
  if (scratch.failed()) return false;

  // A first look in float: most triangles are clearly whole in the texture.
  const bool looksTell = atlas.mostUv <= kMostUv && cage.count <= kMostIslands;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t slot = results.triangles[i];
    // Below infinity, so that a product with it stays a number.
    const double explained = std::min(kFirstLook * atlas.stretch[slot] * atlas.stretch[slot], 1e30);
    looks[i] = {results.uvs[2 * i], results.uvs[2 * i + 1], looksTell ? static_cast<float>(explained) : -std::numeric_limits<float>::infinity(),
                static_cast<float>(atlas.islands[slot])};
  }
  // Of each triangle four bits, all of them set if it is whole; two triangles at a time where there are eight lanes.
  const auto areWhole = [&](const std::uint32_t (&point)[simd::kParts][3]) {
    const simd::wide zero = simd::splatWide(0);
    // First by edge, then by axis: how far it goes, how far in UV, what the more stretched of its ends explains, and from island
    // to island.
    simd::wide lengths[4], inUv[4];
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const auto place = [&](int corner) { return simd::loadParts([&](int part) { return points.at(point[part][corner]); }); };
      const auto look = [&](int corner) { return simd::loadParts([&](int part) { return &looks[point[part][corner]].u; }); };
      lengths[k] = place(l) - place(k);
      inUv[k] = simd::withLane<2>(look(l) - look(k), simd::max(look(k), look(l)));
    }
    lengths[3] = inUv[3] = zero;
    auto& [x, y, z, unused] = lengths;
    auto& [u, v, explains, islands] = inUv;
    simd::transpose(x, y, z, unused);
    simd::transpose(u, v, explains, islands);
    const simd::wide squared = simd::multiplyAdd(z, z, simd::multiplyAdd(y, y, x * x));
    const simd::wide limit = simd::multiplyAdd(explains, squared, simd::splatWide(static_cast<float>(kFirstSlack)));
    const simd::wide squaredInUv = simd::multiplyAdd(v, v, u * u);
    return simd::bits((squaredInUv <= limit) & (islands * islands <= zero));
  };
  // The triangles around a point often come one soon after the other.
  constexpr std::uint32_t kRecent = 64;
  auto* recent = scratch.take<Corner>(kRecent + 3);
  if (scratch.failed()) return false;
  for (std::uint32_t i = 0; i < kRecent; ++i) recent[i].point = UINT32_MAX;
  const auto mendIfAcross = [&](const std::uint32_t (&point)[3], float* ofCorners) {
    // Not copied: what was just written field by field cannot be read as a whole yet.
    const Corner* corners[3];
    for (int c = 0; c < 3; ++c) {
      Corner* corner = recent + point[c] % kRecent;
      if (corner->point != point[c]) {
        if (std::find(corners, corners + c, corner) != corners + c) corner = recent + kRecent + c;
        mender.setCorner(*corner, point[c], points.at(point[c]), results.triangles[point[c]]);
      }
      corners[c] = corner;
    }
    if (mender.isAcross(corners)) mender.mend(corners, ofCorners);
  };
  const std::size_t allTriangles = targetMesh.indices.size() / 3;
  const bool allHaveArea = points.triangleCount == allTriangles;
  const auto hasArea = [&](const std::uint32_t (&point)[3]) {
    const Vec3 normal = areaNormal(points.at(point[0]), points.at(point[1]), points.at(point[2]));
    return dot(normal, normal) > 0;
  };
  for (std::size_t first = 0; first < allTriangles; first += simd::kParts) {
    std::uint32_t point[simd::kParts][3];
    for (std::size_t part = 0; part < simd::kParts; ++part) {
      const std::size_t t = std::min(first + part, allTriangles - 1);
      for (std::size_t c = 0; c < 3; ++c) {
        point[part][c] = points.ofVertex[targetMesh.indices[3 * t + c]];
        std::memcpy(cornerUvs + 6 * t + 2 * c, &looks[point[part][c]].u, 2 * sizeof(float));
      }
    }
    const unsigned whole = areWhole(point);
    if (whole == (1u << simd::kWide) - 1) continue;
    for (std::size_t part = 0; part < simd::kParts && first + part < allTriangles; ++part) {
      if ((whole >> 4 * part & 0xF) == 0xF) continue;
      if (allHaveArea || hasArea(point[part])) mendIfAcross(point[part], cornerUvs + 6 * (first + part));
    }
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
