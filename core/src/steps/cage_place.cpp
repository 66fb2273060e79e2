#include "steps/cage_place.hpp"

#include <algorithm>

namespace cagecast {

// Not inlined: there are many callers, none of which is called for most points.
[[gnu::noinline]] CagePlace::CagePlace(const Scene& scene, const PointData& data, std::uint32_t point) noexcept {
  const std::uint32_t t = data.cageTriangles[point];
  const CageTriangle& triangle = scene.cage.triangles[t];
  const Vec3 p = data.points.exactly(point);
  closest = closestPointOnTriangle(triangle, p);
  const Vec3 q = positionOf(triangle, closest);
  loop = scene.loops.at(triangle, t, q, scene.units.diagonal);
  const Vec3 offset = p - q;
  overhang = length(offset - dot(offset, triangle.normal.exact) * triangle.normal.exact);
}

bool CagePlace::isSlight(const Scene& scene) const noexcept {
  constexpr double kOverhang = 0.005;
  constexpr double kOverhangOfHole = 0.05;
  return overhang <= std::min(scene.length(kOverhang), kOverhangOfHole * scene.loops.boxes[loop].diagonal());
}

}  // namespace cagecast
