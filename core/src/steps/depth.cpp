#include "steps/depth.hpp"

#include <algorithm>

#include "base/area_unit.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 5′: a depth up to this share of the diagonal is never too deep.
constexpr double kShallow = 0.01;

/// Sums over covered points: of their areas, and of area times depth.
struct Covered {
  std::int64_t area = 0, depth = 0;
  void add(Covered other) {
    area += other.area;
    depth += other.depth;
  }
};

/// Calls for each covered point or interior sample.
/// @param call  Takes its segment, its cage triangle, its depth and its area.
template <typename Call>
void eachCovered(const PointData& data, const InteriorSamples& samples, const AreaUnit& unit, Call call) {
  const Points& points = data.points;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (data.zones[i] != Zone::cosmetic) continue;
    call(data.segments[i], data.cageTriangles[i], static_cast<double>(data.distances[i]), data.unsampledAreas[i]);
  }
  for (std::uint32_t i = 0; i < samples.data.points.count; ++i) {
    if (samples.data.zones[i] != Zone::cosmetic) continue;
    const std::uint32_t t = samples.triangles[i / 4];
    call(data.segments[points.triangles[std::size_t{3} * t]], samples.data.cageTriangles[i],
         static_cast<double>(samples.data.distances[i]), unit.quarter(points.doubleAreas[t]));
  }
}

/// Finds the typical depth under each cage triangle: the mean over the points covered by the triangles around its
/// corners.
/// @param ofTriangles        1 per cage triangle: of the points that it covers.
/// @param[out] typicalDepth  1 per cage triangle.
void findTypicalDepths(const Scene& scene, const Covered* ofTriangles, double deepest, double* typicalDepth) {
  const HalfEdges& halfEdges = scene.halfEdges;
  const Arena::Scope scope(scene.arena);
  auto* aroundVertices = scene.arena.allocate<Covered>(halfEdges.vertexCount);
  if (scene.arena.failed()) return;
  std::fill(aroundVertices, aroundVertices + halfEdges.vertexCount, Covered{});
  const auto aroundCorner = [&](std::uint32_t t, std::size_t corner) -> Covered& {
    return aroundVertices[halfEdges.origins[std::size_t{3} * t + corner]];
  };
  for (std::uint32_t t = 0; t < scene.cage.count; ++t) {
    if (ofTriangles[t].area == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) aroundCorner(t, k).add(ofTriangles[t]);
  }
  for (std::uint32_t t = 0; t < scene.cage.count; ++t) {
    double area = 0;
    double depth = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      area += static_cast<double>(aroundCorner(t, k).area);
      depth += static_cast<double>(aroundCorner(t, k).depth);
    }
    typicalDepth[t] = std::max(area > 0 ? depth / area * deepest : 0.0, scene.length(kShallow));
  }
}

}  // namespace

void weightByDepth(const Scene& scene, const PointData& data, const InteriorSamples& samples,
                   Array<SegmentStats>& stats) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const std::uint32_t cageCount = scene.cage.count;
  auto* ofTriangles = arena.allocate<Covered>(cageCount);
  auto* typicalDepth = arena.allocate<double>(cageCount);
  auto* weighted = arena.allocate<std::int64_t>(stats.size());
  if (arena.failed()) return;

  // Depths are summed as shares of a bound on all of them, so that 63 bits are enough.
  const double deepest = 2.0 * static_cast<double>(scene.units.sceneSize);
  const AreaUnit unit(data.points.triangleCount);
  std::fill(ofTriangles, ofTriangles + cageCount, Covered{});
  eachCovered(data, samples, unit, [&](std::uint32_t, std::uint32_t t, double depth, std::int64_t area) {
    ofTriangles[t].add({area, static_cast<std::int64_t>(static_cast<double>(area) * (depth / deepest))});
  });
  findTypicalDepths(scene, ofTriangles, deepest, typicalDepth);
  if (arena.failed()) return;

  std::fill(weighted, weighted + stats.size(), 0);
  eachCovered(data, samples, unit, [&](std::uint32_t segment, std::uint32_t t, double depth, std::int64_t area) {
    // area · min(1, typical depth / depth)²; what is not deep keeps its area without rounding.
    const double share = typicalDepth[t] / std::max(depth, typicalDepth[t]);
    weighted[segment] +=
        depth > typicalDepth[t] ? static_cast<std::int64_t>(static_cast<double>(area) * (share * share)) : area;
  });
  const double toInput = scene.units.areaToInput();
  for (std::size_t s = 0; s < stats.size(); ++s) stats[s].depthWeightedArea = unit.area(weighted[s]) * toInput;
}

}  // namespace cagecast
