#pragma once

#include <cmath>

namespace cagecast {

/// Three doubles. Decisions are made in double precision from the 32-bit input; SIMD in 32 bits only finds what is
/// worth deciding.
struct Vec3 {
  double x, y, z;

  static Vec3 from(const float* p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }

  friend double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
  friend double length(Vec3 a) { return std::sqrt(dot(a, a)); }
};

}  // namespace cagecast
