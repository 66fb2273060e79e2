#include <limits>
#include <utility>

#include "steps/areas.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 7: how far a point may overhang the loop of any hole, as a share of the diagonal and of the
/// hole's, and of a hole that something else explains.
constexpr double kOverhang = 0.005;
constexpr double kOverhangOfHole = 0.05;
constexpr double kExplainedOverhang = 0.03;

struct Share {
  std::uint32_t loop, segment;
  std::int64_t exposed, uncovered, hidden;
};

}  // namespace

bool assignHoles(const Points& points, const Cage& cage, const BoundaryLoops& loops, const Units& units,
                 const PointResults& results, const PointAreas& areas, const Array<SegmentStats>& stats, Arena& arena,
                 std::uint32_t* recovery, Array<HoleShare>& shares) noexcept {
  const auto segmentCount = static_cast<std::uint32_t>(stats.size());
  const Arena::Mark mark = arena.mark();
  auto* loopOf = arena.allocate<std::uint32_t>(points.count);
  auto* atLoops = arena.allocate<std::uint32_t>(points.count);
  auto* starts = arena.allocate<std::uint32_t>(std::size_t{loops.count} + 1);
  auto* found = arena.allocate<Share>(points.count);
  auto* shareOf = arena.allocate<std::uint32_t>(segmentCount);
  if (arena.failed()) return false;

  // Where the points lie that are not occluded, or not under the cage either, and what brings those back that are
  // uncovered.
  std::fill(starts, starts + loops.count + 1, 0u);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    loopOf[i] = BoundaryLoops::kNone;
    const std::uint32_t slot = results.triangles[i];
    const bool isUncovered = results.zones[i] == Zone::uncovered;
    if (isUncovered) recovery[i] = Recovery::always;
    if (results.zones[i] == Zone::occluded) {
      const bool isUnderCage =
          results.cageDistances == nullptr || results.cageDistances[i] < std::numeric_limits<double>::infinity();
      if (isUnderCage || !(stats[results.segments[i]].coveredArea > 0)) continue;
    }
    if (!loops.touches(slot)) continue;
    const CageTriangle& t = cage.triangles[slot];
    const Vec3 p = points.exactly(i);
    const ClosestPoint place = closestPointOnTriangle(t, p);
    const Vec3 q = positionOf(t, place);
    const std::uint32_t loop = loops.at(t, slot, q, units.diagonal);
    if (loop == BoundaryLoops::kNone) continue;
    loopOf[i] = loop;
    ++starts[loop];
    if (!isUncovered) continue;
    const Vec3 offset = p - q;
    const double overhang = length(offset - dot(offset, t.normal.exact) * t.normal.exact);
    const double little = std::min(kOverhang * units.diagonal, kOverhangOfHole * loops.boxes[loop].diagonal());
    if (overhang > little) {
      recovery[i] = overhang <= kExplainedOverhang * units.diagonal ? Recovery::throughHole + loop : Recovery::never;
    }
  }

  // Rim by loop, what each segment has there.
  std::uint32_t total = 0;
  for (std::uint32_t loop = 0; loop <= loops.count; ++loop) total += std::exchange(starts[loop], total);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (loopOf[i] != BoundaryLoops::kNone)
      atLoops[starts[loopOf[i]]++] = i;  // A start becomes its end, the next one's start.
  }
  std::fill(shareOf, shareOf + segmentCount, 0u);
  std::uint32_t count = 0;
  for (std::uint32_t loop = 0, i = 0; loop < loops.count; ++loop) {
    const std::uint32_t first = count;
    for (; i < starts[loop]; ++i) {
      const std::uint32_t p = atLoops[i];
      const std::uint32_t s = results.segments[p];
      // A share found at an earlier loop, or never, is not this one's.
      if (shareOf[s] < first || shareOf[s] >= count || found[shareOf[s]].segment != s) {
        shareOf[s] = count;
        found[count++] = {loop, s, 0, 0, 0};
      }
      Share& share = found[shareOf[s]];
      (results.zones[p] == Zone::occluded ? share.hidden : share.exposed) += areas.all[p];
      if (results.zones[p] == Zone::uncovered) share.uncovered += areas.all[p];
    }
  }
  if (!shares.reset(count)) return false;
  const AreaUnit unit(points.triangleCount, units.diagonal);
  const double toInput = 1.0 / units.scale / units.scale;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& [loop, segment, exposed, uncovered, hidden] = found[i];
    shares[i] = {loop, segment, unit.summableArea(exposed) * toInput, unit.summableArea(uncovered) * toInput,
                 unit.summableArea(hidden) * toInput};
  }
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
