#pragma once

#include <cstdint>
#include <limits>

#include "search/ray.hpp"
#include "search/ray_tree.hpp"
#include "simd/simd.hpp"

/// The ray tests of four triangles in single precision, and of one in double precision.
namespace cagecast {

/// A ray in single precision, as the tests of boxes and triangles read it.
struct alignas(16) FloatRay {
  float inverse[3];      ///< 1 / component of the direction, of at most 1e20.
  float end;             ///< Not before the ray's end; −infinity once the ray needs no further tests.
  float offset[3];       ///< −origin · inverse.
  float shearX, shearY;  ///< As in `RayDirection::Rough`.
  float scaleZ;
  float origin[3];     ///< z, x, y in the order of `axis`.
  std::uint32_t axis;  ///< Which axis of space serves as z.
  float leastDepth;    ///< Hits of at most this `HitEstimate::depth` do not count.
};

/// Where hits begin to count, for tests in single precision.
struct HitLimits {
  float loose;   ///< Hits beyond this may count.
  float strict;  ///< Hits beyond this count.
};

/// The distance that `hitDistance` returns if there is no hit.
inline constexpr double kNoHit = -std::numeric_limits<double>::infinity();

/// Four triangles side by side. They are gathered whenever rays come to a leaf: a leaf is visited by a few groups of
/// rays only, and stored like this it would be three times as large.
struct RayLeaf {
  static constexpr int kRow = 5;  ///< x, y, z, x, y: the next two axes follow each axis.
  float corner[kRow][3][4];       ///< corner[row][a, b, c][lane]
  float edgeRounding;             ///< The rounding error of the edge functions of a ray through the leaf's box.
  float leastDistance;            ///< The least computed distance, times the sum of the edge functions, of a hit.

  /// @param size   The sides of the leaf's box, summed up.
  /// @param loose  As in `HitLimits`.
  RayLeaf(const RayTree& tree, std::uint32_t child, float size, float loose) noexcept;
};

/// The test of `hitDistance` for four triangles in single precision.
struct HitEstimate {
  simd::f32x4 x[3], y[3], z[3];  ///< From the corners to the ray's origin, sheared: z is along the ray.
  simd::f32x4 least, most;       ///< Of the three edge functions.
  simd::f32x4 sum;               ///< Of the edge functions.
  simd::f32x4 depth;             ///< The sum of the edge functions times z. Exactly 0 if a corner is the origin.
  simd::f32x4 distance;          ///< The hit's distance times the size of `sum`, to avoid a division.
};

inline HitEstimate estimateHits(const RayLeaf& leaf, const FloatRay& ray) noexcept {
  using simd::f32x4;
  using simd::load;
  using simd::splat;
  const f32x4 shearX = splat(ray.shearX);
  const f32x4 shearY = splat(ray.shearY);
  const f32x4 originZ = splat(ray.origin[0]);
  const f32x4 originX = splat(ray.origin[1]);
  const f32x4 originY = splat(ray.origin[2]);
  const float(*corner)[3][4] = leaf.corner + ray.axis;
  HitEstimate of;
  auto& [x, y, z, least, most, sum, depth, distance] = of;
  // Origin minus corner, not the other way round, so that the load can be part of the subtraction. The edge functions
  // are the same for both.
  for (int i = 0; i < 3; ++i) {
    z[i] = originZ - load(corner[0][i]);
    x[i] = simd::multiplyAdd(z[i], shearX, originX - load(corner[1][i]));
    y[i] = simd::multiplyAdd(z[i], shearY, originY - load(corner[2][i]));
  }
  const f32x4 u = x[2] * y[1] - y[2] * x[1];
  const f32x4 v = x[0] * y[2] - y[0] * x[2];
  const f32x4 w = x[1] * y[0] - y[1] * x[0];
  least = simd::min(u, simd::min(v, w));
  most = simd::max(u, simd::max(v, w));
  sum = u + v + w;
  depth = simd::multiplyAdd(w, z[2], simd::multiplyAdd(v, z[1], u * z[0]));
  const f32x4 scaled = depth * splat(ray.scaleZ);
  distance = simd::select(sum < splat(0), splat(0) - scaled, scaled);
  return of;
}

/// The triangles that the ray may hit, a bit each.
inline unsigned possibleHits(const RayLeaf& leaf, const HitEstimate& of, float leastDepth) noexcept {
  using simd::splat;
  // The edge functions have the same sign, or are 0: none is negative, or none is positive.
  const simd::mask4 isThrough = simd::min(splat(0) - of.least, of.most) <= splat(leaf.edgeRounding);
  const simd::mask4 isBeyond = splat(leaf.leastDistance) <= of.distance;
  return simd::bits(isThrough & isBeyond & (splat(leastDepth) < simd::abs(of.depth)));
}

/// Which of four triangles a ray hits, a bit each.
struct Verdict {
  unsigned hit;   ///< Certainly: double precision would give the same answer.
  unsigned open;  ///< Perhaps: to be decided in double precision.
};

/// Tests again, with the rounding error of these very triangles, which is smaller than what `possibleHits` assumes.
/// @param sceneSize  As in `RayTree`.
/// @param end    Hits beyond it do not count.
Verdict judge(const RayLeaf& leaf, const FloatRay& ray, float sceneSize, const HitLimits& limits, float end) noexcept;

/// The distance at which a ray hits a triangle, or `kNoHit`, decided in double precision.
double hitDistance(const RayLeaf& leaf, int lane, const Ray& ray) noexcept;

}  // namespace cagecast
