#include "search/ray_leaf.hpp"

#include <algorithm>
#include <cstddef>

#include "geometry/vec3.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// The sine of the angle between a ray and a plane below which the ray counts as parallel: with corners that are
/// floats, double precision cannot tell smaller ones from 0. (In exact arithmetic the edge functions of such a ray are
/// 0 and their sum rejects it. This catches what rounding leaves of them; no test has needed it so far.)
constexpr double kParallel = 1e-10;

/// The rounding error of an edge function in single precision, for a ray through the leaf's box, as a share of the
/// scene's size R times the size E of that box. Moved and sheared corners are off by up to 11 · 2^-24 R, of which 4
/// are for an origin that is not a float, and lie within 2 E of the ray; four of their products are off by as much,
/// together less than 0.7 · 2^-17 R E. (It may be too small for triangles beyond the leaf's own, but those have their
/// own leaf.)
constexpr float kEdgeRounding = 0x1p-17f;

/// The same for a triangle whose corners lie within s of the ray, and within d of its origin along the ray: moved and
/// sheared corners are off by up to (4 R + 7 d + 2 s) · 2^-24, edge functions by (20 R + 35 d + 13 s) · 2^-24 s. These
/// are the factors of R s and (d + s) s.
constexpr float kOriginRounding = 0x1p-19f;
constexpr float kShearRounding = 0x1p-18f;

/// The rounding error of a distance times the sum of the edge functions has two terms. The first is three times the
/// error of an edge function, times the depth of a corner along the ray, which is at most R, times the stretch of the
/// shear, which is below 2. This is the factor, rounded up:
constexpr float kDistanceRounding = 8.0f;
/// The second, for the depths themselves, is some 2^-21 of R times that sum. This is the factor, rounded up:
constexpr float kDepthRounding = 0x1p-19f;

/// The most that the edge functions of a ray through a leaf's box add up to, in squares of the box's size.
constexpr float kMaxSum = 24.0f;

}  // namespace

RayLeaf::RayLeaf(const RayTree& tree, std::uint32_t child, float size, float loose) noexcept
    : edgeRounding(size * kEdgeRounding * tree.sceneSize),
      leastDistance(size * size * (std::min(loose, 0.0f) * kMaxSum) -
                    edgeRounding * kDistanceRounding * tree.sceneSize) {
  const std::uint32_t* index = tree.corners + std::size_t{3} * firstOf(child);
  for (int i = 0; i < 3; ++i) {
    const auto row = [&](int lane) { return load(tree.positions + std::size_t{4} * index[3 * lane + i]); };
    f32x4 rows[4] = {row(0), row(1), row(2), row(3)};
    simd::transpose(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < kRow; ++k) simd::store(corner[k][i], rows[k % 3]);
  }
}

Verdict judge(const RayLeaf& leaf, const FloatRay& ray, float sceneSize, const HitLimits& limits, float end) noexcept {
  const HitEstimate of = estimateHits(leaf, ray);
  const auto most = [](const f32x4(&a)[3]) {
    return simd::max(simd::abs(a[0]), simd::max(simd::abs(a[1]), simd::abs(a[2])));
  };
  const f32x4 depth = most(of.z);
  const f32x4 width = simd::max(most(of.x), most(of.y));
  const f32x4 rounding =
      width * simd::multiplyAdd(depth + width, splat(kShearRounding), splat(kOriginRounding * sceneSize));
  const f32x4 size = simd::abs(of.sum);
  const f32x4 slack =
      simd::multiplyAdd(depth * rounding, splat(kDistanceRounding), size * splat(kDepthRounding * sceneSize));
  const f32x4 inside = simd::max(of.least, splat(0) - of.most);
  const mask4 isHit = (rounding < inside) & (splat(limits.strict) * size + slack <= of.distance) &
                      (of.distance <= splat(end) * size - slack);
  const mask4 isOpen = (splat(0) - rounding <= inside) & (splat(limits.loose) * size - slack <= of.distance);
  return {simd::bits(isHit), simd::bits(isOpen)};
}

// The watertight test of Woop, Benthin, Wald (2013). Corners are moved and sheared so that the ray is the z-axis; the
// signs of the three edge functions then tell on which side of each edge the ray passes. Two triangles that share an
// edge compute the same number with opposite signs, and 0 counts for both, so no ray passes between them.
double hitDistance(const RayLeaf& leaf, int lane, const Ray& ray) noexcept {
  const RayDirection& direction = *ray.direction;
  const auto corner = [&](int i) {
    return Vec3{static_cast<double>(leaf.corner[0][i][lane]), static_cast<double>(leaf.corner[1][i][lane]),
                static_cast<double>(leaf.corner[2][i][lane])};
  };
  const Vec3 a = corner(0);
  const Vec3 normal = cross(corner(1) - a, corner(2) - a);
  const double slope = dot(normal, direction.exact);
  if (slope * slope <= kParallel * kParallel * dot(normal, normal)) return kNoHit;
  const double d[3] = {direction.exact.x, direction.exact.y, direction.exact.z};
  const std::uint32_t axes[3] = {(direction.rough.z + 1) % 3, (direction.rough.z + 2) % 3, direction.rough.z};
  double x[3];
  double y[3];
  double z[3];
  for (int i = 0; i < 3; ++i) {
    const auto offset = [&](std::uint32_t axis) {
      return static_cast<double>(leaf.corner[axis][i][lane]) - ray.origin(axis);
    };
    z[i] = offset(axes[2]) / d[axes[2]];
    x[i] = offset(axes[0]) - z[i] * d[axes[0]];
    y[i] = offset(axes[1]) - z[i] * d[axes[1]];
  }
  const double u = x[2] * y[1] - y[2] * x[1];
  const double v = x[0] * y[2] - y[0] * x[2];
  const double w = x[1] * y[0] - y[1] * x[0];
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kNoHit;
  const double sum = u + v + w;
  return sum != 0 ? (u * z[0] + v * z[1] + w * z[2]) / sum : kNoHit;
}

}  // namespace cagecast
