#include "steps/motion/posed.hpp"

#include <algorithm>
#include <cmath>

#include "base/area_unit.hpp"
#include "search/target_tree.hpp"

namespace cagecast {
namespace {

MeshView meshOf(const Scene& rest, const PointData& data, std::span<const float> positions) {
  const std::size_t vertexCount = positions.size() / 3;
  auto* segments = rest.arena.allocate<std::uint32_t>(vertexCount);
  if (segments == nullptr) return {};
  for (std::size_t v = 0; v < vertexCount; ++v) segments[v] = data.segments[data.points.ofVertex[v]];
  return {positions, rest.targetMesh.indices, {}, {segments, vertexCount}};
}

/// The box of some positions, in scaled units.
void setBox(std::span<const float> positions, Units& units) {
  for (std::size_t k = 0; k < 3; ++k) units.low[k] = units.high[k] = positions[k] * units.scale;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const float x = positions[i] * units.scale;
    units.low[i % 3] = std::min(units.low[i % 3], x);
    units.high[i % 3] = std::max(units.high[i % 3], x);
  }
}

/// How many times over the box is as large as that of a target at rest may be, as a power of two.
int sizeBitsOf(const Units& units) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double side = static_cast<double>(units.high[k]) - static_cast<double>(units.low[k]);
    squared += side * side;
  }
  int exponent = 0;
  std::frexp(std::sqrt(squared), &exponent);
  return std::max(0, exponent - 1);
}

}  // namespace

Posed::Posed(const Scene& rest, const PointData& data, std::span<const float> positions) noexcept
    : mesh(meshOf(rest, data, positions)), scene(rest.cageMesh, mesh, rest.options, rest.arena) {
  Arena& arena = rest.arena;
  if (arena.failed()) return;
  scene.units = rest.units;
  setBox(positions, scene.units);
  scene.cage = rest.cage;
  scene.cageTree = rest.cageTree;
  if (weld(mesh, scene.units, 0, arena, scene.points) != Code::ok) return;
  scene.points.sizeBits = sizeBitsOf(scene.units);
  if (!buildTargetTree(scene.points, scene.units, arena, scene.targetTree)) return;

  points.points = scene.points;
  const std::uint32_t count = scene.points.count;
  points.segments = arena.allocate<std::uint32_t>(count);
  points.visibility = arena.allocate<Visibility>(count);
  points.cageTriangles = arena.allocate<std::uint32_t>(count);
  points.areas = arena.allocate<std::int64_t>(count);
  if (arena.failed()) return;
  // Of several vertices the first one counts.
  for (std::size_t v = positions.size() / 3; v-- > 0;) {
    const std::uint32_t p = scene.points.ofVertex[v];
    const std::uint32_t atRest = data.points.ofVertex[v];
    points.segments[p] = data.segments[atRest];
    points.visibility[p] = data.visibility[atRest];
    points.cageTriangles[p] = data.cageTriangles[atRest];
  }
  std::fill(points.areas, points.areas + count, 0);
  const AreaUnit unit = scene.points.areaUnit();
  for (std::uint32_t t = 0; t < scene.points.triangleCount; ++t) {
    for (int k = 0; k < 3; ++k)
      points.areas[scene.points.triangles[std::size_t{3} * t + static_cast<std::size_t>(k)]] +=
          unit.third(scene.points.doubleAreas[t]);
  }
}

}  // namespace cagecast
