#include <algorithm>
#include <cmath>
#include <tuple>

#include "sort.hpp"
#include "steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 5′: how much larger a copy may be, and how much its extent may differ.
constexpr double kSameArea = 0.01;
constexpr double kSameExtent = 0.02;
/// docs/method.md, step 5′: parts of equal area and another shape may lie between copies; not many do.
constexpr std::uint32_t kRuns = 8;

}  // namespace

bool findCopies(const Points& points, const PointResults& results, Scratch& scratch, Array<SegmentStats>& stats) noexcept {
  const Scratch::Mark mark = scratch.mark();
  const auto count = static_cast<std::uint32_t>(stats.size());
  auto* centres = scratch.take<Vec3>(count);
  auto* extents = scratch.take<double>(count);  // Sums of squared distances of the points from their mean.
  auto* order = scratch.take<std::uint64_t>(count);  // Segments.
  auto* shares = scratch.take<double>(count);   // Of a point in their mean.
  auto* runs = scratch.take<std::uint32_t>(count);  // By their first.
  auto* isAlone = scratch.take<bool>(count);        // With so many points: it has no copy, and needs no extent.
  auto* list = scratch.take<std::uint32_t>(points.count);  // Points of the others.
  if (scratch.failed()) return false;
  for (std::uint32_t s = 0; s < count; ++s) order[s] = s;
  sortSeldom(order, order + count, [&](std::uint64_t s, std::uint64_t t) {
    const SegmentStats& a = stats[static_cast<std::uint32_t>(s)];
    const SegmentStats& b = stats[static_cast<std::uint32_t>(t)];
    return std::tie(a.points, a.area, s) < std::tie(b.points, b.area, t);
  });
  const auto at = [order](std::uint32_t i) { return static_cast<std::uint32_t>(order[i]); };
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto isAsMany = [&](std::uint32_t j) { return j < count && stats[at(j)].points == stats[at(i)].points; };
    isAlone[at(i)] = !isAsMany(i - 1) && !isAsMany(i + 1);
  }

  for (std::uint32_t s = 0; s < count; ++s) {
    shares[s] = 1.0 / stats[s].points;
    centres[s] = {0, 0, 0};
    extents[s] = 0;
  }
  // Listed first: where they begin and end nobody can guess.
  std::uint32_t listed = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    list[listed] = i;
    listed += !isAlone[results.segments[i]];
  }
  const auto eachPoint = [&](auto call) {
    for (std::uint32_t i = 0; i < listed; ++i) call(results.segments[list[i]], Vec3::from(points.at(list[i])));
  };
  eachPoint([&](std::uint32_t s, Vec3 p) { centres[s] = centres[s] + shares[s] * p; });
  eachPoint([&](std::uint32_t s, Vec3 p) { extents[s] += dot(p - centres[s], p - centres[s]); });

  std::uint32_t runCount = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t s = at(i);
    const auto isLike = [&](std::uint32_t first) {
      return stats[s].points == stats[first].points && stats[s].area <= (1 + kSameArea) * stats[first].area &&
             std::abs(extents[s] - extents[first]) <= kSameExtent * extents[first];
    };
    const std::uint32_t oldest = runCount - std::min(kRuns, runCount);
    std::uint32_t run = runCount;
    while (run > oldest && !isLike(runs[run - 1])) --run;
    if (run == oldest) runs[runCount++] = s;
    stats[s].copyOf = run == oldest ? s : runs[run - 1];
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
