#include "steps/areas.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 5′: no depth below this share of the diagonal counts as deep.
constexpr double kNotDeep = 0.01;

/// Of what is covered: its area, and its area times its depth.
struct Covered {
  std::int64_t area = 0, depth = 0;
  void add(Covered other) {
    area += other.area;
    depth += other.depth;
  }
};

}  // namespace

bool findDepthWeightedAreas(const Points& points, const Cage& cage, const HalfEdges& edges,
                            const InteriorSamples& samples, const PointAreas& areas, const Units& units,
                            const PointResults& results, Arena& arena, Array<SegmentStats>& stats) noexcept {
  const Arena::Mark mark = arena.mark();
  auto* inTriangles = arena.allocate<Covered>(cage.count);
  auto* aroundVertices = arena.allocate<Covered>(edges.vertexCount);
  auto* usual = arena.allocate<double>(cage.count);
  auto* sunk = arena.allocate<std::int64_t>(stats.size());
  if (arena.failed()) return false;

  // Depths as shares of what none exceeds, so that whole numbers have room for their sums.
  const double deepest = 2.0 * static_cast<double>(units.reach);
  const AreaUnit unit(points.triangleCount, units.diagonal);
  const auto eachCovered = [&](auto call) {
    for (std::uint32_t i = 0; i < points.count; ++i) {
      if (results.zones[i] != Zone::cosmetic) continue;
      call(results.segments[i], results.triangles[i], static_cast<double>(results.distances[i]),
           areas.interiorSamples[i]);
    }
    for (std::uint32_t i = 0; i < samples.points.count; ++i) {
      if (samples.results.zones[i] != Zone::cosmetic) continue;
      const std::uint32_t t = samples.triangles[i / 4];
      call(results.segments[points.triangles[std::size_t{3} * t]], samples.results.triangles[i],
           static_cast<double>(samples.results.distances[i]), unit.quarter(points.doubleAreas[t]));
    }
  };
  // What is usual about each triangle of the cage: in those around its corners.
  std::fill(inTriangles, inTriangles + cage.count, Covered{});
  eachCovered([&](std::uint32_t, std::uint32_t slot, double depth, std::int64_t area) {
    inTriangles[slot].add({area, static_cast<std::int64_t>(static_cast<double>(area) * (depth / deepest))});
  });
  std::fill(aroundVertices, aroundVertices + edges.vertexCount, Covered{});
  const auto vertexAt = [&](std::uint32_t slot, std::size_t corner) {
    return edges.starts[std::size_t{3} * slot + corner];
  };
  for (std::uint32_t slot = 0; slot < cage.count; ++slot) {
    if (inTriangles[slot].area == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) aroundVertices[vertexAt(slot, k)].add(inTriangles[slot]);
  }
  for (std::uint32_t slot = 0; slot < cage.count; ++slot) {
    double area = 0;
    double depth = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      area += static_cast<double>(aroundVertices[vertexAt(slot, k)].area);
      depth += static_cast<double>(aroundVertices[vertexAt(slot, k)].depth);
    }
    usual[slot] = std::max(area > 0 ? depth / area * deepest : 0.0, kNotDeep * units.diagonal);
  }

  std::fill(sunk, sunk + stats.size(), 0);
  eachCovered([&](std::uint32_t segment, std::uint32_t slot, double depth, std::int64_t area) {
    const double share = usual[slot] / std::max(depth, usual[slot]);
    sunk[segment] +=
        depth > usual[slot] ? static_cast<std::int64_t>(static_cast<double>(area) * (share * share)) : area;
  });
  const double toInput = 1.0 / units.scale / units.scale;
  for (std::size_t s = 0; s < stats.size(); ++s) stats[s].depthWeightedArea = unit.area(sunk[s]) * toInput;
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
