#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/heap_sort.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 5′: how much larger a copy may be, and how much its extent may differ.
constexpr double kSameArea = 0.01;
constexpr double kSameExtent = 0.02;
/// docs/method.md, step 5′: parts of equal area and another shape may lie between twins; not many do.
constexpr std::uint32_t kRuns = 8;

}  // namespace

bool findTwins(const Points& points, const PointResults& results, Arena& arena, Array<SegmentStats>& stats) noexcept {
  const Arena::Mark mark = arena.mark();
  const auto count = static_cast<std::uint32_t>(stats.size());
  auto* centres = arena.allocate<Vec3>(count);
  auto* extents = arena.allocate<double>(count);       // Sums of squared distances of the points from their mean.
  auto* order = arena.allocate<std::uint64_t>(count);  // Segments.
  auto* shares = arena.allocate<double>(count);        // Of a point in their mean.
  auto* runs = arena.allocate<std::uint32_t>(count);   // By their first.
  auto* isAlone = arena.allocate<bool>(count);         // With so many points: it has no copy, and needs no extent.
  auto* list = arena.allocate<std::uint32_t>(points.count);  // Points of the others.
  if (arena.failed()) return false;
  for (std::uint32_t s = 0; s < count; ++s) order[s] = s;
  heapSort(order, order + count, [&](std::uint64_t s, std::uint64_t t) {
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
    stats[s].twinOf = run == oldest ? s : runs[run - 1];
  }
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
