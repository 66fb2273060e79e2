#include "steps/recheck/recheck_occluded.hpp"

#include <algorithm>

#include "steps/recheck/facing.hpp"
#include "steps/recheck/occluded_points.hpp"
#include "steps/recheck/visibility_test.hpp"

namespace cagecast {

void recheckOccluded(const Scene& scene, PointData& data, const Array<SegmentStats>& stats) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* queue = arena.allocate<std::uint32_t>(data.points.count);
  auto* isChosen = arena.allocate<bool>(stats.size());  // Segments with a queued point.
  OccludedPoints occluded(scene, data, stats);
  if (arena.failed()) return;
  std::uint32_t end = occluded.queueBorder(queue);
  if (end == 0) return;
  std::fill(isChosen, isChosen + stats.size(), false);
  for (std::uint32_t i = 0; i < end; ++i) isChosen[data.segments[queue[i]]] = true;
  Facing facing;
  findFacing(scene, data, {isChosen, stats.size()}, occluded.flags(), facing);
  VisibilityTest test(scene, facing);
  if (arena.failed()) return;

  // Whether a point is seen depends on no other point, so the points recovered do not depend on the order of the queue.
  for (std::uint32_t next = 0; next < end || !test.isIdle();) {
    for (; next < end && test.hasRoom(); ++next) {
      const std::uint32_t p = queue[next];
      if (dot(facing.normals[p], facing.normals[p]) > 0) test.add(p, facing.isTurned[data.segments[p]]);
    }
    test.advance([&](std::uint32_t p) {
      data.recovery[p] = Recovery::always;
      end = occluded.queueNeighbours(p, queue, end);
    });
  }
}

}  // namespace cagecast
