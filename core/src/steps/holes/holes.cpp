#include "steps/holes/holes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/area_unit.hpp"
#include "steps/cage_place.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 10.
/// At an explained hole, its overhang may be this share of the target's diagonal.
constexpr double kExplainedOverhang = 0.03;

constexpr std::uint32_t kNone = BoundaryLoops::kNone;

/// A `HoleShare` with its areas in an `AreaUnit`.
struct Share {
  std::uint32_t loop, segment;
  std::int64_t exposed, uncovered, hidden;
};

/// The points at loops, loop by loop.
struct LoopPoints {
  std::span<const std::uint32_t> points;
  std::span<const std::uint32_t> ends;  ///< 1 per loop: where its points end.
};

/// Whether the ray of an occluded point surely misses the cage.
bool missesCage(const PointData& data, std::uint32_t point) {
  return data.cageDistances != nullptr && data.cageDistances[point] == std::numeric_limits<double>::infinity();
}

/// Whether a point takes part in the areas at holes. Exposed points take part. Occluded ones only if their ray misses
/// the cage and their segment has C > 0.
bool takesPart(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats, std::uint32_t point) {
  if (data.visibility[point] != Visibility::occluded) return data.visibility[point] != Visibility::beyond;
  return std::isfinite(scene.options.occlusionReach) && missesCage(data, point) &&
         stats[data.segments[point]].coveredArea > 0;
}

/// Whether an occluded point counts as exposed all the same, as it is bare in a pose.
bool isBareInPose(const PointData& data, std::uint32_t point) {
  return data.isBareInPose != nullptr && data.isBareInPose[point];
}

/// Whether a point would be uncovered if what hides it were culled. One that step 9 recovers is seen under the cage.
bool isUncoveredIfFree(const PointData& data, std::uint32_t point) {
  return data.hiddenBy != nullptr && data.hiddenBy[point] != 0 && data.recovery[point] == Recovery::never;
}

/// Finds the boundary loop that a point's closest point on the cage lies on, and decides by the overhang whether a
/// point at a loop is recovered.
/// @param[in,out] recovery  `always` before, else it stays as it is.
std::uint32_t loopOfPoint(const Scene& scene, const PointData& data, std::uint32_t point, std::uint32_t& recovery) {
  if (!scene.loops.touches(data.cageTriangles[point])) return kNone;
  const CagePlace place(scene, data, point);
  if (place.loop != kNone && recovery == Recovery::always && !place.isSlight(scene)) {
    recovery =
        place.overhang <= scene.length(kExplainedOverhang) ? Recovery::throughHole + place.loop : Recovery::never;
  }
  return place.loop;
}

/// Adds up, loop by loop, the areas that each segment has there.
/// @param[out] found  Room for as many as there are points.
/// @return How many there are.
std::uint32_t sumShares(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats,
                        const LoopPoints& atLoops, std::span<Share> found) {
  const auto& [points, ends] = atLoops;
  const Arena::Scope scope(scene.arena);
  auto* shareOf = scene.arena.allocate<std::uint32_t>(found.size());  // By segment.
  if (scene.arena.failed()) return 0;
  std::fill(shareOf, shareOf + found.size(), 0u);
  std::uint32_t count = 0;
  for (std::uint32_t loop = 0, i = 0; loop < ends.size(); ++loop) {
    const std::uint32_t first = count;
    for (; i < ends[loop]; ++i) {
      const std::uint32_t p = points[i];
      const std::uint32_t s = data.segments[p];
      // A share found at an earlier loop, or never, is not this one's.
      if (shareOf[s] < first || shareOf[s] >= count || found[shareOf[s]].segment != s) {
        shareOf[s] = count;
        found[count++] = {loop, s, 0, 0, 0};
      }
      Share& share = found[shareOf[s]];
      const bool isHidden = data.visibility[p] == Visibility::occluded && takesPart(scene, data, stats, p);
      if (isHidden) share.hidden += data.areas[p];
      if (data.visibility[p] != Visibility::occluded || isBareInPose(data, p)) share.exposed += data.areas[p];
      if (data.visibility[p] == Visibility::uncovered) share.uncovered += data.areas[p];
    }
  }
  return count;
}

}  // namespace

void assignHoles(const Scene& scene, PointData& data, const Array<SegmentStats>& stats,
                 Array<HoleShare>& shares) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const std::uint32_t pointCount = data.points.count;
  const std::uint32_t loopCount = scene.loops.count;
  auto* loopOf = arena.allocate<std::uint32_t>(pointCount);
  auto* atLoops = arena.allocate<std::uint32_t>(pointCount);
  auto* ends = arena.allocate<std::uint32_t>(loopCount);
  auto* found = arena.allocate<Share>(pointCount);
  if (arena.failed()) return;

  std::fill(ends, ends + loopCount, 0u);
  for (std::uint32_t i = 0; i < pointCount; ++i) {
    std::uint32_t recovery = Recovery::never;
    const bool isUncovered = data.visibility[i] == Visibility::uncovered || isUncoveredIfFree(data, i);
    if (isUncovered) recovery = Recovery::always;
    const bool isCounted = takesPart(scene, data, stats, i) || isBareInPose(data, i);
    loopOf[i] = isCounted || isUncovered ? loopOfPoint(scene, data, i, recovery) : kNone;
    if (isUncovered) data.recovery[i] = recovery;
    if (!isCounted) loopOf[i] = kNone;
    if (loopOf[i] != kNone) ++ends[loopOf[i]];
  }
  // List the points loop by loop. Each entry of `ends` is first the start of its loop, and moves to its end.
  std::uint32_t total = 0;
  for (std::uint32_t loop = 0; loop < loopCount; ++loop) total += std::exchange(ends[loop], total);
  for (std::uint32_t i = 0; i < pointCount; ++i) {
    if (loopOf[i] != kNone) atLoops[ends[loopOf[i]]++] = i;
  }
  const std::uint32_t count = sumShares(scene, data, stats, {{atLoops, total}, {ends, loopCount}}, {found, pointCount});
  if (arena.failed() || !shares.reset(count)) return arena.fail();

  const AreaUnit unit(data.points.triangleCount);
  const double toInput = scene.units.areaToInput();
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& [loop, segment, exposed, uncovered, hidden] = found[i];
    shares[i] = {loop, segment, unit.summableArea(exposed) * toInput, unit.summableArea(uncovered) * toInput,
                 unit.summableArea(hidden) * toInput};
  }
}

}  // namespace cagecast
