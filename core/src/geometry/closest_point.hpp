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
  const simd::f64x2 both = dot(twice(offset), t.gradients);
  const double v = simd::doubleOf<0>(both);
  const double w = simd::doubleOf<1>(both);
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
inline simd::f64x2 blendUvs(const CageTriangle& t, const ClosestPoint& place) {
  const simd::f64x2 a = simd::lowDoubles(simd::load(t.uvs));
  const simd::f64x2 ab = simd::lowDoubles(simd::load(t.uvs + 2)) - a;
  const simd::f64x2 ac = simd::highDoubles(simd::load(t.uvs + 2)) - a;
  return a + simd::splatDouble(place.v) * ab + simd::splatDouble(place.w) * ac;
}
inline Uv uvAt(const CageTriangle& t, const ClosestPoint& place) {
  double uv[2];
  simd::store(uv, blendUvs(t, place));
  return {uv[0], uv[1]};
}

}  // namespace cagecast
