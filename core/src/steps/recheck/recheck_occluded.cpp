#include "steps/recheck/recheck_occluded.hpp"

#include <algorithm>

#include "steps/recheck/facing.hpp"
#include "steps/recheck/occluded_points.hpp"
#include "steps/recheck/visibility_test.hpp"

namespace cagecast {
namespace {

/// What the first rays found.
struct FirstRays {
  const Facing& facing;
  const std::uint16_t* blocked;  ///< 1 per point: a bit for each ray that needs not be sent again.
};

/// Tests points that their own segment hides, whose rays may pass other segments.
void lookPastOthers(const Scene& scene, PointData& data, const Array<SegmentStats>& stats, const FirstRays& first,
                    HiderRecords& records) {
  const auto& [facing, blocked] = first;
  auto* queue = scene.arena.allocate<std::uint32_t>(data.points.count);
  OccludedPoints occluded(scene, data, stats, true);
  VisibilityTest test(scene, facing);
  SegmentHits hits(data.segments, RaySearch::kMaxRays, scene.arena);
  if (scene.arena.failed()) return;
  std::uint32_t end = occluded.queueBorder(queue);
  for (std::uint32_t next = 0; next < end;) {
    for (; next < end && test.hasRoomForAll(); ++next) {
      const std::uint32_t p = queue[next];
      if (!facing.isTwoSided[p] && dot(facing.normals[p], facing.normals[p]) > 0)
        test.add(p, facing.isTurned[data.segments[p]], blocked[p]);
    }
    test.sendPastOthers(data.segments, hits, [&](std::uint32_t p, std::span<const std::uint32_t> clear) {
      data.hiddenBy[p] = records.add(VisibilityTest::kEnough, clear, hits);
      data.recovery[p] = Recovery::always;
      end = occluded.queueNeighbours(p, queue, end);
    });
  }
  if (hits.failed() || records.failed()) scene.arena.fail();
}

}  // namespace

void recheckOccluded(const Scene& scene, PointData& data, const Array<SegmentStats>& stats,
                     HiderRecords& records) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* queue = arena.allocate<std::uint32_t>(data.points.count);
  auto* isChosen = arena.allocate<bool>(stats.size());  // Segments with a queued point.
  auto* blocked = arena.allocate<std::uint16_t>(data.points.count);
  OccludedPoints occluded(scene, data, stats);
  if (arena.failed()) return;
  std::fill(blocked, blocked + data.points.count, std::uint16_t{0});
  std::uint32_t end = occluded.queueBorder(queue);
  std::fill(isChosen, isChosen + stats.size(), false);
  for (std::uint32_t i = 0; i < end; ++i) isChosen[data.segments[queue[i]]] = true;
  if (!records.empty()) {
    for (std::uint32_t p = 0; p < data.points.count; ++p) {
      if (data.hiddenBy[p] != 0) isChosen[data.segments[p]] = true;
    }
  } else if (end == 0) {
    return;
  }
  Facing facing;
  findFacing(scene, data, {isChosen, stats.size()}, occluded.flags(), facing);
  {
    const Arena::Scope ofTest(arena);
    VisibilityTest test(scene, facing);
    if (arena.failed()) return;
    // Whether a point is seen depends on no other point, so the points recovered do not depend on the order of the
    // queue.
    for (std::uint32_t next = 0; next < end || !test.isIdle();) {
      for (; next < end && test.hasRoom(); ++next) {
        const std::uint32_t p = queue[next];
        if (dot(facing.normals[p], facing.normals[p]) > 0) test.add(p, facing.isTurned[data.segments[p]]);
      }
      const auto onSeen = [&](std::uint32_t p) {
        data.recovery[p] = Recovery::always;
        data.hiddenBy[p] = 0;
        end = occluded.queueNeighbours(p, queue, end);
      };
      test.advance(data.segments, onSeen, [&](std::uint32_t p, std::uint16_t rays) { blocked[p] = rays; });
    }
  }
  if (stats.size() > 1) lookPastOthers(scene, data, stats, {facing, blocked}, records);
}

}  // namespace cagecast
