#pragma once

#include "vec3.hpp"

namespace cagecast {

/// Twice the area times the unit normal.
inline Vec3 areaNormal(const float* a, const float* b, const float* c) {
  const Vec3 origin = Vec3::from(a);
  return cross(Vec3::from(b) - origin, Vec3::from(c) - origin);
}

/// Whether the triangle's area, computed in double, is not zero.
inline bool hasArea(const float* a, const float* b, const float* c) {
  const Vec3 n = areaNormal(a, b, c);
  return dot(n, n) > 0;
}

/// The nearest point of a triangle.
struct ClosestPoint {
  double squaredDistance;
  double u, v, w;  ///< Barycentrics of the corners a, b, c.
  bool inside;     ///< Strictly: not on an edge or a corner.
};

/// Finds the point of triangle abc nearest to p, by the Voronoi regions of its corners and edges
/// (Ericson, "Real-Time Collision Detection", 2005, §5.1.5).
inline ClosestPoint closestPoint(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto at = [&](double u, double v, double w, bool inside) {
    const Vec3 offset = (p - a) - (v * (b - a) + w * (c - a));
    return ClosestPoint{dot(offset, offset), u, v, w, inside};
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return at(1, 0, 0, false);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return at(0, 1, 0, false);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return at(1 - v, v, 0, false);
  }
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return at(0, 0, 1, false);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return at(1 - w, 0, w, false);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(0, 1 - w, w, false);
  }
  const double scale = 1 / (va + vb + vc);
  const double v = vb * scale;
  const double w = vc * scale;
  return at(1 - v - w, v, w, true);
}

}  // namespace cagecast
