#pragma once

#include <cmath>
#include <cstdint>

#include "geometry/triangle.hpp"

/// Closest points on triangles, in double precision.
namespace cagecast {

/// The point of a triangle that is closest to a point p.
struct ClosestPoint {
  double distance;  ///< From p.
  double v, w;      ///< Barycentric coordinates of corners b and c.
  double height;    ///< Of p above the triangle's plane; negative below it.
  bool inside;      ///< Whether it lies strictly inside the triangle, not on an edge or a corner.
};

/// The point of a triangle's edges that is closest to a point p.
struct ClosestEdgePoint {
  double distance;  ///< From p.
  double v, w;      ///< Barycentric coordinates of corners b and c.
};

/// Finds it for a point p whose projection onto the triangle's plane is not inside the triangle.
/// @param v,w  The barycentric coordinates of b and c of that projection.
ClosestEdgePoint closestPointOnEdges(const Triangle& t, const Vec3& p, double v, double w) noexcept;

/// Finds the point of a triangle that is closest to p.
inline ClosestPoint closestPointOnTriangle(const Triangle& t, const Vec3& p) {
  const Vec3 offset = p - Vec3::from(t.a);
  const double height = dot(offset, t.normal.exact);
  const double v = dot(offset, t.gradientB);
  const double w = dot(offset, t.gradientC);
  // The projection of most points is inside.
  if (v > 0 && w > 0 && v + w < 1) return {std::abs(height), v, w, height, true};
  const ClosestEdgePoint onEdge = closestPointOnEdges(t, p, v, w);
  return {onEdge.distance, onEdge.v, onEdge.w, height, false};
}

/// The position of a closest point.
inline Vec3 positionOf(const Triangle& t, const ClosestPoint& closest) {
  const Vec3 a = Vec3::from(t.a);
  return a + closest.v * (Vec3::from(t.b) - a) + closest.w * (Vec3::from(t.c) - a);
}

/// A triangle that could be the closest one.
struct Candidate {
  std::uint32_t cageTriangle;
  ClosestPoint point;
};

/// Picks one of at least one candidate by the tie rule of docs/method.md, step 1: of those within `kTieDistance` of the
/// closest the one whose plane is farthest from p, of equals the one with the lowest index.
/// @param diagonal  Of the target, scaled.
const Candidate& nearestOf(const Candidate* candidates, std::uint32_t count, double diagonal) noexcept;

/// A point in the texture.
struct Uv {
  double u, v;
};

}  // namespace cagecast
