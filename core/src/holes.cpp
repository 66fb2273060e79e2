#include <limits>
#include <utility>

#include "areas.hpp"
#include "steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 7: how far a point may overhang the rim of any hole, as a share of the diagonal and of the hole's, and of a hole
/// that something else explains.
constexpr double kOverhang = 0.005;
constexpr double kOverhangOfHole = 0.05;
constexpr double kExplainedOverhang = 0.03;

struct Share {
  std::uint32_t rim, segment;
  std::int64_t exposed, uncovered, hidden;
};

}  // namespace

bool lookUnderHoles(const Points& points, const Cage& cage, const Rims& rims, const Units& units, const PointResults& results,
                    const PointAreas& areas, const Array<SegmentStats>& stats, Scratch& scratch, std::uint32_t* restores,
                    Array<HoleShare>& shares) noexcept {
  const auto segmentCount = static_cast<std::uint32_t>(stats.size());
  const Scratch::Mark mark = scratch.mark();
  auto* rimOf = scratch.take<std::uint32_t>(points.count);
  auto* atRims = scratch.take<std::uint32_t>(points.count);
  auto* starts = scratch.take<std::uint32_t>(std::size_t{rims.count} + 1);
  auto* found = scratch.take<Share>(points.count);
  auto* shareOf = scratch.take<std::uint32_t>(segmentCount);
  if (scratch.failed()) return false;

  // Where the points lie that are not occluded, or not under the cage either, and what brings those back that are uncovered.
  std::fill(starts, starts + rims.count + 1, 0u);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    rimOf[i] = Rims::kNone;
    const std::uint32_t slot = results.triangles[i];
    const bool isUncovered = results.zones[i] == Zone::uncovered;
    if (isUncovered) restores[i] = Restores::always;
    if (results.zones[i] == Zone::occluded) {
      const bool isUnderCage = results.cageDistances == nullptr || results.cageDistances[i] < std::numeric_limits<double>::infinity();
      if (isUnderCage || !(stats[results.segments[i]].coveredArea > 0)) continue;
    }
    if (!rims.touches(slot)) continue;
    const CageTriangle& t = cage.triangles[slot];
    const Vec3 p = points.exactly(i);
    const Place place = placeOn(t, p);
    const Vec3 q = positionOf(t, place);
    const std::uint32_t rim = rims.at(t, slot, q, units.diagonal);
    if (rim == Rims::kNone) continue;
    rimOf[i] = rim;
    ++starts[rim];
    if (!isUncovered) continue;
    const Vec3 offset = p - q;
    const double overhang = length(offset - dot(offset, t.normal.exact) * t.normal.exact);
    const double little = std::min(kOverhang * units.diagonal, kOverhangOfHole * rims.boxes[rim].diagonal());
    if (overhang > little) {
      restores[i] = overhang <= kExplainedOverhang * units.diagonal ? Restores::throughHole + rim : Restores::never;
    }
  }

  // Rim by rim, what each segment has there.
  std::uint32_t total = 0;
  for (std::uint32_t rim = 0; rim <= rims.count; ++rim) total += std::exchange(starts[rim], total);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (rimOf[i] != Rims::kNone) atRims[starts[rimOf[i]]++] = i;  // A start becomes its end, the next one's start.
  }
  std::fill(shareOf, shareOf + segmentCount, 0u);
  std::uint32_t count = 0;
  for (std::uint32_t rim = 0, i = 0; rim < rims.count; ++rim) {
    const std::uint32_t first = count;
    for (; i < starts[rim]; ++i) {
      const std::uint32_t p = atRims[i];
      const std::uint32_t s = results.segments[p];
      // A share found at an earlier rim, or never, is not this one's.
      if (shareOf[s] < first || shareOf[s] >= count || found[shareOf[s]].segment != s) {
        shareOf[s] = count;
        found[count++] = {rim, s, 0, 0, 0};
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
    const auto& [rim, segment, exposed, uncovered, hidden] = found[i];
    shares[i] = {rim, segment, unit.summableArea(exposed) * toInput, unit.summableArea(uncovered) * toInput,
                 unit.summableArea(hidden) * toInput};
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
