#pragma once

#include "geometry/ray_direction.hpp"
#include "geometry/vec3.hpp"

namespace cagecast {

/// Twice the area times the unit normal.
inline Vec3 areaNormal(const float* a, const float* b, const float* c) {
  const Vec3 origin = Vec3::from(a);
  return cross(Vec3::from(b) - origin, Vec3::from(c) - origin);
}

/// A triangle that has an area, with what closest points and rays need of it.
struct Triangle {
  float a[4], b[4], c[4];  ///< Corners: x, y, z, 0.
  /// The gradients of the barycentric coordinates of b and c: their dot products with p − a are the coordinates of p's
  /// projection onto the plane.
  Vec3 gradientB, gradientC;
  RayDirection normal;  ///< Of unit length.
};

}  // namespace cagecast
