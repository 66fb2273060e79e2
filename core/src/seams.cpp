#include "seams.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "atlas.hpp"
#include "near_kernel.hpp"
#include "place.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 9: an edge is smeared if it is so many times longer in UV than the cage explains, and so much in UV besides.
constexpr double kSmear = 4;
constexpr double kSmearSlack = 0.005;
/// docs/method.md, step 9: how far from a corner's place its patch reaches, in longest edges and in shares of the diagonal.
constexpr double kPatchEdges = 1.5;
constexpr double kPatchSlack = 0.01;
/// docs/method.md, step 9: sums of distances within this share of the diagonal are equal.
constexpr double kTieSum = 1e-7;

/// UVs up to here are exact enough as floats for a first look: they are off by less than the slack above.
constexpr float kMostUv = 16384;
/// What the first look allows of the explained length, squared: the exact limit less what floats round.
constexpr double kFirstLook = 0.99 * kSmear * kSmear;

/// What the first look knows of a triangle of the cage.
struct FirstLook {
  std::uint32_t island;
  float explains;  ///< Squared UV length per squared length.
};

/// A corner of a target triangle, and its place on the cage.
struct Corner {
  Vec3 p;
  Candidate at;
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
        fixedSlack_(fixedSlack(tree, diagonal)),
        laneOf_(scratch.take<std::uint32_t>(cage.count)),
        seen_(scratch.take<std::uint32_t>(cage.count)),
        sideSeen_(scratch.take<std::uint32_t>(std::size_t{3} * cage.count)) {
    for (int k = 0; k < 3; ++k) {
      candidates_[k] = scratch.take<Candidate>(cage.count);
      patches_[k].triangles = scratch.take<std::uint32_t>(std::size_t{cage.count} + 1);
      patches_[k].squaredDistances = scratch.take<float>(std::size_t{4} * (std::size_t{cage.count} + 1));
    }
    if (scratch.failed()) return;
    std::fill(seen_, seen_ + cage.count, 0u);
    std::fill(sideSeen_, sideSeen_ + std::size_t{3} * cage.count, 0u);
    // Leaves are full but for the last.
    for (std::uint32_t i = 0; i < cage.count; ++i) laneOf_[tree.near[i / 4].slot[i % 4]] = i;
  }

  [[nodiscard]] Candidate placeOf(Vec3 p, std::uint32_t t) const noexcept { return {t, placeOn(cage_.triangles[t], p)}; }

  /// Whether the texture is torn or smeared over a triangle, in double.
  [[nodiscard]] bool isAcross(const Corner (&corners)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      const Corner& a = corners[k];
      const Corner& b = corners[(k + 1) % 3];
      if (atlas_.islands[a.at.slot] != atlas_.islands[b.at.slot]) return true;
      const Uv from = uvOf(a.at);
      const Uv to = uvOf(b.at);
      const double du = to.u - from.u;
      const double dv = to.v - from.v;
      const double path = length(b.p - a.p) + std::abs(b.at.place.distance - a.at.place.distance);
      const double explained = std::sqrt(std::max(atlas_.stretch[a.at.slot], atlas_.stretch[b.at.slot])) * path;
      if (std::sqrt(du * du + dv * dv) > kSmear * explained + kSmearSlack) return true;
    }
    return false;
  }

  /// Projects the corners onto the patch around that one of them which brings all of them nearest.
  /// @param[out] uvs  6 floats.
  void mend(const Corner (&corners)[3], float* uvs) noexcept {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, length(corners[(k + 1) % 3].p - corners[k].p));
      known_[k].count = 1;
      known_[k].places[0] = corners[k].at;
    }
    const double reach = kPatchEdges * longest + kPatchSlack * diagonal_;

    // In float first: which of the patches might bring the corners nearest.
    double sums[3];
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const bool isKnown = std::any_of(corners, corners + k, [&](const Corner& c) { return c.at.slot == corners[k].at.slot; });
      sums[k] = isKnown ? std::numeric_limits<double>::infinity() : flood(corners, k, reach, patches_[k]);
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
    for (int c = 0; c < 3; ++c) {
      const Uv uv = uvOf(choices[chosen].corners[c]);
      uvs[2 * c] = static_cast<float>(uv.u);
      uvs[2 * c + 1] = static_cast<float>(uv.v);
    }
  }

 private:
  /// The corners' places on one patch.
  struct Choice {
    double sum;  ///< Of the distances.
    Candidate corners[3];
  };
  /// Places of a corner that were decided already: patches of a triangle have most of them in common.
  struct Known {
    static constexpr std::uint32_t kMost = 4;
    std::uint32_t count;
    Candidate places[kMost];
  };

  /// Triangles, and how far they are from the three corners and, lane 3, from the place they are around.
  struct Patch {
    std::uint32_t size;
    std::uint32_t* triangles;
    float* squaredDistances;   ///< 4 per triangle.
    simd::f32x4 leastSquares;  ///< For each of the four.
  };

  static constexpr int kPlace = 3;

  /// Floods the cage from the triangle of corner k, over edges shared in the texture, through all that is within reach of
  /// the corner's place.
  /// @return The sum of the corners' distances to the patch, in float.
  double flood(const Corner (&corners)[3], int k, double reach, Patch& patch) noexcept {
    const auto& [from, place] = corners[k].at;
    const CageTriangle& start = cage_.triangles[from];
    const Vec3 a = Vec3::from(start.a);
    const Vec3 q = a + place.v * (Vec3::from(start.b) - a) + place.w * (Vec3::from(start.c) - a);
    // One look at a triangle, in float, tells how far it is from the three corners and from q.
    const auto lanes = [&](double Vec3::*axis) {
      const float four[4] = {static_cast<float>(corners[0].p.*axis), static_cast<float>(corners[1].p.*axis),
                             static_cast<float>(corners[2].p.*axis), static_cast<float>(q.*axis)};
      return simd::load(four);
    };
    const simd::f32x4 x = lanes(&Vec3::x);
    const simd::f32x4 y = lanes(&Vec3::y);
    const simd::f32x4 z = lanes(&Vec3::z);
    const double rounding = 2 * kRounding * (tree_.extent + reach + std::abs(q.x) + std::abs(q.y) + std::abs(q.z));
    const double surely = std::max(0.0, reach - rounding);
    const simd::f32x4 within = simd::splat(static_cast<float>(surely * surely));
    const simd::f32x4 beyond = simd::splat(static_cast<float>((reach + rounding) * (reach + rounding)));

    ++flood_;  // Marks of earlier floods do not count.
    seen_[from] = flood_;
    patch.triangles[0] = from;
    patch.leastSquares = simd::splat(std::numeric_limits<float>::max());
    std::uint32_t size = 0;
    std::uint32_t end = 1;
    const auto meet = [&](std::uint32_t t) {
      patch.triangles[end] = t;
      end += seen_[t] != flood_;
      seen_[t] = flood_;
    };
    // Ring by ring: what is next to the last ring is put behind it, looked at, and kept if it is near enough.
    for (std::uint32_t ring = 0; size < end; ring = size) {
      for (std::uint32_t i = ring; i < end; ++i) {
        const std::uint32_t t = patch.triangles[i];
        const std::uint32_t lane = laneOf_[t] % 4;
        const simd::f32x4 squared = squaredDistances(tree_.near[laneOf_[t] / 4], x, y, z,
                                                     [lane](const float (&field)[4]) { return simd::splat(field[lane]); });
        // No branch that is a coin toss: what is not kept is written over by the next.
        std::uint32_t isNear = simd::bits(squared <= within) >> kPlace;
        const std::uint32_t mayBeNear = simd::bits(squared <= beyond) >> kPlace;
        if (isNear != mayBeNear) isNear = t == from || placeOf(q, t).place.distance <= reach;
        simd::store(patch.squaredDistances + 4 * size, squared);
        patch.triangles[size] = t;
        size += isNear;
      }
      end = size;
      for (std::uint32_t i = ring; i < size; ++i) {
        patch.leastSquares = simd::min(patch.leastSquares, simd::load(patch.squaredDistances + 4 * i));
        for (std::uint32_t side = 3 * patch.triangles[i]; side < 3 * patch.triangles[i] + 3; ++side) {
          const std::uint32_t other = atlas_.nextSide[side];  // Itself if there is no other: met already.
          meet(other / 3);
          if (atlas_.nextSide[other] == side || sideSeen_[side] == flood_) continue;
          // More than two triangles share the edge: one round for all of them, however many.
          for (std::uint32_t more = atlas_.nextSide[other]; more != side; more = atlas_.nextSide[more]) {
            sideSeen_[more] = flood_;
            meet(more / 3);
          }
        }
      }
    }
    patch.size = size;
    float least[4];
    simd::store(least, patch.leastSquares);
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::sqrt(static_cast<double>(least[c]));
    return sum;
  }

  /// Projects the corners onto a patch: step 1 once more, with the patch for a cage.
  void project(const Corner (&corners)[3], const Patch& patch, Choice& out) noexcept {
    const simd::f32x4 limits = patch.leastSquares * simd::splat(1 + static_cast<float>(kRelativeSlack)) + simd::splat(fixedSlack_);
    std::uint32_t counts[3] = {};
    for (std::uint32_t i = 0; i < patch.size; ++i) {
      unsigned near = simd::bits(simd::load(patch.squaredDistances + 4 * i) <= limits) & 7;
      for (; near != 0; near &= near - 1) {
        const auto c = static_cast<std::uint32_t>(std::countr_zero(near));
        candidates_[c][counts[c]++] = placeOf(corners[c], known_[c], patch.triangles[i]);
      }
    }
    out.sum = 0;
    for (std::uint32_t c = 0; c < 3; ++c) {
      out.corners[c] = counts[c] == 1 ? candidates_[c][0] : nearestOf(candidates_[c], counts[c], diagonal_);
      out.sum += out.corners[c].place.distance;
    }
  }

  [[nodiscard]] Uv uvOf(const Candidate& at) const noexcept { return uvAt(cage_.triangles[at.slot], at.place); }

  [[nodiscard]] Candidate placeOf(const Corner& corner, Known& known, std::uint32_t t) const noexcept {
    for (std::uint32_t i = 0; i < known.count; ++i) {
      if (known.places[i].slot == t) return known.places[i];
    }
    const Candidate found = placeOf(corner.p, t);
    if (known.count < Known::kMost) known.places[known.count++] = found;
    return found;
  }

  const Cage& cage_;
  const CageTree& tree_;
  const Atlas& atlas_;
  double diagonal_;
  float fixedSlack_;
  std::uint32_t* laneOf_;        ///< 1 per triangle: 4 · its leaf in the tree + its lane.
  std::uint32_t* seen_;          ///< 1 per triangle: the last flood that met it.
  std::uint32_t* sideSeen_;      ///< 1 per side of an edge of three or more: the last flood that went around that edge.
  std::uint32_t flood_ = 0;      ///< At most 3 · kMaxTriangles, less than 2^32.
  Patch patches_[3];             ///< Around each corner's place,
  Candidate* candidates_[3];     ///< and what of it might be nearest to each corner.
  Known known_[3];               ///< Of each corner.
};

}  // namespace

bool findCornerUvs(const MeshView& cageMesh, const MeshView& targetMesh, const Points& points, const Cage& cage,
                   const CageTree& tree, const Units& units, const PointResults& results, Scratch& scratch, float* cornerUvs) noexcept {
  const Scratch::Mark mark = scratch.mark();
  Atlas atlas;
  if (!findAtlas(cageMesh, cage, scratch, atlas)) return false;
  Mender mender(cage, tree, atlas, units.diagonal, scratch);
  auto* looks = scratch.take<FirstLook>(cage.count);
  if (scratch.failed()) return false;

  // A first look in float: most triangles are clearly whole in the texture.
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    // Below infinity, so that a product with it stays a number.
    const double explained = std::min(kFirstLook * atlas.stretch[t], 1e30);
    looks[t] = {atlas.islands[t], atlas.mostUv <= kMostUv ? static_cast<float>(explained) : -std::numeric_limits<float>::infinity()};
  }
  const auto edgeIsWhole = [&](std::uint32_t i, std::uint32_t j) {
    const float* p = points.at(i);
    const float* q = points.at(j);
    const float x = q[0] - p[0];
    const float y = q[1] - p[1];
    const float z = q[2] - p[2];
    const float u = results.uvs[2 * j] - results.uvs[2 * i];
    const float v = results.uvs[2 * j + 1] - results.uvs[2 * i + 1];
    const FirstLook& a = looks[results.triangles[i]];
    const FirstLook& b = looks[results.triangles[j]];
    return a.island == b.island && u * u + v * v <= std::max(a.explains, b.explains) * (x * x + y * y + z * z);
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
      corners[c] = {p, mender.placeOf(p, results.triangles[point[c]])};
    }
    if (mender.isAcross(corners)) mender.mend(corners, uvs);
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
