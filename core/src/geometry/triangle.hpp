#pragma once

#include "geometry/vec3.hpp"

namespace cagecast {

/// Twice the area times the unit normal.
inline Vec3 areaNormal(const float* a, const float* b, const float* c) {
  const Vec3 origin = Vec3::from(a);
  return cross(Vec3::from(b) - origin, Vec3::from(c) - origin);
}

}  // namespace cagecast
