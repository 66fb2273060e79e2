#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "input/cage.hpp"
#include "search/kd_tree.hpp"

/// Places on the cage, decided in double: which triangle is nearest, and where on it.
namespace cagecast {

/// The point of a cage triangle that is nearest to a point p.
struct ClosestPoint {
  double distance;
  double v, w;    ///< Barycentrics of corners b and c.
  double height;  ///< Of p over the triangle's plane.
  bool inside;    ///< Strictly: not on an edge or a corner.
};

/// The point of a triangle's border that is nearest to a point p.
struct BorderPlace {
  double distance;
  double v, w;
};

/// Finds it for a point that lies beside the triangle: on one of the edges that its foot is beyond.
/// @param v,w  Barycentrics of b and c of its foot.
BorderPlace placeOnBorder(const CageTriangle& t, const Vec3& p, double v, double w) noexcept;

/// Finds the point of a triangle that is nearest to p.
inline ClosestPoint closestPointOnTriangle(const CageTriangle& t, const Vec3& p) {
  const Vec3 offset = p - Vec3::from(t.a);
  const double height = dot(offset, t.normal.exact);
  // Most points lie straight under their triangle.
  const double v = dot(offset, t.gradientB);
  const double w = dot(offset, t.gradientC);
  if (v > 0 && w > 0 && v + w < 1) return {std::abs(height), v, w, height, true};
  const BorderPlace place = placeOnBorder(t, p, v, w);
  return {place.distance, place.v, place.w, height, false};
}

/// A triangle that could be the nearest.
struct Candidate {
  std::uint32_t slot;
  ClosestPoint place;
};

/// Picks, of the triangles that could be the nearest, the one that the tie rule of docs/method.md, step 1, names: of
/// those within `kTieDistance` of the nearest the one whose plane is farthest from p, of equals the first.
const Candidate& nearestOf(const Candidate* candidates, std::uint32_t count, double diagonal) noexcept;

/// A place in the texture.
struct Uv {
  double u, v;
};

/// Blends the UVs of a triangle's corners at a place on it.
inline Uv uvAt(const CageTriangle& t, const ClosestPoint& place) {
  const auto blend = [&](int axis) {
    const auto a = static_cast<double>(t.uvs[axis]);
    const double ab = static_cast<double>(t.uvs[2 + axis]) - a;
    const double ac = static_cast<double>(t.uvs[4 + axis]) - a;
    return a + place.v * ab + place.w * ac;
  };
  return {blend(0), blend(1)};
}

}  // namespace cagecast
