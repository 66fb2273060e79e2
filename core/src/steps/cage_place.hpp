#pragma once

#include <algorithm>

#include "geometry/closest_point.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Where the closest point q of a point lies on the cage.
struct CagePlace {
  ClosestPoint closest;
  std::uint32_t loop;  ///< The boundary loop that q is on, or `BoundaryLoops::kNone`.
  double overhang;     ///< How far the point lies sideways from the cage.

  CagePlace(const Scene& scene, const PointData& data, std::uint32_t point) noexcept {
    const std::uint32_t t = data.cageTriangles[point];
    const CageTriangle& triangle = scene.cage.triangles[t];
    const Vec3 p = data.points.exactly(point);
    closest = closestPointOnTriangle(triangle, p);
    const Vec3 q = positionOf(triangle, closest);
    loop = scene.loops.at(triangle, t, q, scene.units.diagonal);
    const Vec3 offset = p - q;
    overhang = length(offset - dot(offset, triangle.normal.exact) * triangle.normal.exact);
  }

  /// docs/method.md, step 10: whether the point is hardly beside its loop: by at most the lesser of a share of the
  /// target's diagonal, and a share of the diagonal of the loop's box.
  [[nodiscard]] bool isSlight(const Scene& scene) const noexcept {
    constexpr double kOverhang = 0.005;
    constexpr double kOverhangOfHole = 0.05;
    return overhang <= std::min(scene.length(kOverhang), kOverhangOfHole * scene.loops.boxes[loop].diagonal());
  }
};

}  // namespace cagecast
