#include "steps/segments.hpp"

#include <algorithm>

#include "base/union_find.hpp"

namespace cagecast {

void findSegments(const Scene& scene, PointData& data, Array<SegmentStats>& stats) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const Points points = data.points;
  const std::span<const std::uint32_t> groups = scene.targetMesh.groups;
  const auto vertexCount = static_cast<std::uint32_t>(scene.targetMesh.positions.size() / 3);
  auto* parents = arena.allocate<std::uint32_t>(points.count);
  auto* firstVertex = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed()) return;
  UnionFind sets(parents, points.count);
  const std::uint32_t* corner = points.triangles;
  for (std::uint32_t t = 0; t < points.triangleCount; ++t, corner += 3) sets.join({corner[0], corner[1], corner[2]});
  sets.flatten(points.count);

  std::uint32_t* const segments = data.segments;
  std::fill(segments, segments + points.count, UINT32_MAX);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t root = parents[points.ofVertex[v]];
    if (segments[root] != UINT32_MAX) continue;
    firstVertex[count] = v;
    segments[root] = count++;
  }
  if (!stats.reset(count)) return arena.fail();
  for (std::uint32_t s = 0; s < count; ++s) {
    stats[s] = {};
    if (!groups.empty()) stats[s].group = groups[firstVertex[s]];
  }
  for (std::uint32_t i = 0; i < points.count; ++i) {
    segments[i] = segments[parents[i]];
    ++stats[segments[i]].points;
  }
  for (const std::uint32_t group : scene.options.parts.ignore) {
    for (SegmentStats& segment : stats) {
      if (segment.group != group) continue;
      segment.points = 0;
      segment.culledBy = CulledBy::ignore;
    }
  }
}

}  // namespace cagecast
