#pragma once

#include <cmath>

namespace cagecast {

/// Three numbers; doubles, or several doubles each.
template <typename T>
struct Vector {
  T x, y, z;

  static Vector from(const float* p) { return {static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2])}; }
  friend Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(T s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }

  friend T dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend T length(Vector a) {
    using std::sqrt;
    return sqrt(dot(a, a));
  }
};

/// Decisions are made in double precision from the 32-bit input; SIMD in 32 bits only finds what is worth deciding.
using Vec3 = Vector<double>;

}  // namespace cagecast
