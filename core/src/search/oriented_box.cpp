#include "search/oriented_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/simd.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::multiplyAdd;
using simd::splat;
using simd::splatLane;

constexpr int kCorners = 12;

/// The orientations tried: 0°, 22.5°, 45° and 67.5°. At 90° a rectangle would be the first one again.
constexpr float kCosines[4] = {1, 0.92387953f, 0.70710678f, 0.38268343f};
constexpr float kSines[4] = {0, 0.38268343f, 0.70710678f, 0.92387953f};

Vec3 toVec3(f32x4 v) {
  float lanes[4];
  simd::store(lanes, v);
  return Vec3::from(lanes);
}

/// The normal of the plane that fits the corners best, approximately; 0 if there is none.
/// @param guess  The normal of one of the triangles.
Vec3 fittedNormal(const f32x4 (&corners)[kCorners], Vec3 guess) {
  // The covariance matrix of the corners, row by row.
  f32x4 sum = splat(0);
  f32x4 row0 = splat(0);
  f32x4 row1 = splat(0);
  f32x4 row2 = splat(0);
  const auto add = [&](f32x4 a, f32x4 b) {
    row0 = multiplyAdd(a, splatLane<0>(b), row0);
    row1 = multiplyAdd(a, splatLane<1>(b), row1);
    row2 = multiplyAdd(a, splatLane<2>(b), row2);
  };
  for (const f32x4 corner : corners) {
    add(corner, corner);
    sum = sum + corner;
  }
  add(sum * splat(-1.0f / kCorners), sum);
  const Vec3 a = toVec3(row0);
  const Vec3 b = toVec3(row1);
  const Vec3 c = toVec3(row2);
  // Its eigenvector with the least eigenvalue, by one step of inverse iteration with the adjugate.
  const Vec3 turned = guess.x * cross(b, c) + guess.y * cross(c, a) + guess.z * cross(a, b);
  const double size = length(turned);
  return size > 0 ? 1 / size * turned : Vec3{0, 0, 0};
}

struct Range {
  f32x4 low = splat(std::numeric_limits<float>::infinity());
  f32x4 high = splat(-std::numeric_limits<float>::infinity());

  void grow(f32x4 x) {
    low = simd::min(low, x);
    high = simd::max(high, x);
  }
};

}  // namespace

OrientedBox orientedBoxAround(const Triangle* const (&triangles)[4], const float* centre, float padding) noexcept {
  const f32x4 origin = load(triangles[0]->a);
  f32x4 corners[kCorners];
  for (int i = 0; i < 4; ++i) {
    corners[3 * i] = load(triangles[i]->a) - origin;
    corners[3 * i + 1] = load(triangles[i]->b) - origin;
    corners[3 * i + 2] = load(triangles[i]->c) - origin;
  }
  const Vec3 normal = triangles[0]->normal.exact;
  Vec3 z = fittedNormal(corners, normal);
  if (!(dot(z, z) > 0)) z = normal;
  const Vec3 aside = std::abs(z.x) < 0.5 ? Vec3{0, z.z, -z.y} : Vec3{-z.z, 0, z.x};
  const Vec3 x = 1 / length(aside) * aside;
  const Vec3 y = cross(z, x);
  OrientedBox box{};
  const auto putAxis = [&box](int i, Vec3 axis) {
    box.axes[0][i] = static_cast<float>(axis.x);
    box.axes[1][i] = static_cast<float>(axis.y);
    box.axes[2][i] = static_cast<float>(axis.z);
  };
  const auto placeOf = [&box](f32x4 offset) {
    return multiplyAdd(load(box.axes[2]), splatLane<2>(offset),
                       multiplyAdd(load(box.axes[1]), splatLane<1>(offset), load(box.axes[0]) * splatLane<0>(offset)));
  };
  putAxis(0, x);
  putAxis(1, y);
  putAxis(2, z);
  // One lane for each orientation of the rectangle in the plane of x and y. The extent along z is the same for all.
  const f32x4 cosines = load(kCosines);
  const f32x4 sines = load(kSines);
  Range rangeX, rangeY, range;
  for (const f32x4 corner : corners) {
    const f32x4 place = placeOf(corner);
    const f32x4 alongX = splatLane<0>(place);
    const f32x4 alongY = splatLane<1>(place);
    rangeX.grow(multiplyAdd(alongX, cosines, alongY * sines));
    rangeY.grow(alongY * cosines - alongX * sines);
    range.grow(place);
  }
  float areas[4];
  simd::store(areas, (rangeX.high - rangeX.low) * (rangeY.high - rangeY.low));
  const auto least = std::min_element(areas, areas + 4) - areas;

  const auto cosine = static_cast<double>(kCosines[least]);
  const auto sine = static_cast<double>(kSines[least]);
  putAxis(0, cosine * x + sine * y);
  putAxis(1, cosine * y - sine * x);
  const f32x4 start = placeOf(origin - load(centre));
  const auto putEnds = [&](float(&to)[4], f32x4 endX, f32x4 endY, f32x4 end, float beyond) {
    float lanes[3][4];
    simd::store(lanes[0], endX);
    simd::store(lanes[1], endY);
    simd::store(lanes[2], end);
    const float ends[4] = {lanes[0][least], lanes[1][least], lanes[2][2], 0};
    simd::store(to, start + load(ends) + splat(beyond));
  };
  putEnds(box.low, rangeX.low, rangeY.low, range.low, -padding);
  putEnds(box.high, rangeX.high, rangeY.high, range.high, padding);
  return box;
}

}  // namespace cagecast
