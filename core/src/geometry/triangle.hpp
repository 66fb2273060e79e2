#pragma once

#include "geometry/vec3.hpp"
#include "simd/simd.hpp"

namespace cagecast {

/// Twice the area times the unit normal.
inline Vec3 areaNormal(const float* a, const float* b, const float* c) {
  const Vec3 origin = Vec3::from(a);
  return cross(Vec3::from(b) - origin, Vec3::from(c) - origin);
}

/// Two points, axis by axis.
using TwoVec3 = Vector<simd::f64x2>;

inline TwoVec3 twice(Vec3 p) { return {simd::splatDouble(p.x), simd::splatDouble(p.y), simd::splatDouble(p.z)}; }

/// @param p,q  Four floats each, the last of which does not count.
inline TwoVec3 pointsAt(const float* p, const float* q) {
  const simd::f32x4 a = simd::load(p);
  const simd::f32x4 b = simd::load(q);
  const simd::f32x4 xy = simd::interleaveLow(a, b);
  return {simd::lowDoubles(xy), simd::highDoubles(xy), simd::lowDoubles(simd::interleaveHigh(a, b))};
}

/// Twice the areas of two triangles: to the bit the length of `areaNormal` of each.
/// @param positions  4 floats each, by index.
inline simd::f64x2 doubleAreas(const float* positions, const std::uint32_t* one, const std::uint32_t* other) {
  const auto corners = [&](int i) {
    return pointsAt(positions + std::size_t{4} * one[i], positions + std::size_t{4} * other[i]);
  };
  const TwoVec3 origins = corners(0);
  return length(cross(corners(1) - origins, corners(2) - origins));
}

}  // namespace cagecast
