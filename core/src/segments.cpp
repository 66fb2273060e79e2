#include "areas.hpp"
#include "steps.hpp"
#include "union_find.hpp"

namespace cagecast {
namespace {

struct Sums {
  std::int64_t all, exposed, covered;
};

}  // namespace

bool findSegments(const Points& points, std::uint32_t vertexCount, std::span<const std::uint32_t> groups, Scratch& scratch,
                  PointResults& results, Array<SegmentStats>& stats) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* parents = scratch.take<std::uint32_t>(points.count);
  auto* firstVertex = scratch.take<std::uint32_t>(points.count);
  if (scratch.failed()) return false;
  UnionFind sets(parents, points.count);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    sets.join(corner[0], corner[1]);
    sets.join(corner[0], corner[2]);
  }

  sets.flatten(points.count);

  // Number the components in the order in which the vertices meet them.
  std::fill(results.segments, results.segments + points.count, UINT32_MAX);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t root = parents[points.ofVertex[v]];
    if (results.segments[root] != UINT32_MAX) continue;
    firstVertex[count] = v;
    results.segments[root] = count++;
  }
  for (std::uint32_t i = 0; i < points.count; ++i) results.segments[i] = results.segments[parents[i]];

  if (!stats.reset(count)) return false;
  for (std::uint32_t s = 0; s < count; ++s) {
    stats[s] = {};
    stats[s].copyOf = s;
    if (!groups.empty()) stats[s].group = groups[firstVertex[s]];
  }
  for (std::uint32_t i = 0; i < points.count; ++i) ++stats[results.segments[i]].points;
  scratch.rewind(mark);
  return true;
}

bool addUpAreas(const Points& points, const Voters& voters, const Units& units, const PointResults& results, Scratch& scratch,
                PointAreas& areas, Array<SegmentStats>& stats) noexcept {
  auto* all = scratch.take<std::int64_t>(points.count);
  auto* votes = voters.count > 0 ? scratch.take<std::int64_t>(points.count) : all;
  areas = {all, votes};
  const Scratch::Mark mark = scratch.mark();
  auto* sums = scratch.take<Sums>(stats.size());
  if (scratch.failed()) return false;
  std::fill(sums, sums + stats.size(), Sums{});
  std::fill(all, all + points.count, 0);
  const AreaUnit unit(points.triangleCount, units.diagonal);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    for (int i = 0; i < 3; ++i) all[corner[i]] += third;
  }
  const auto count = [](Sums& sum, std::int64_t area, Zone zone) {
    sum.exposed += zone != Zone::occluded ? area : 0;
    sum.covered += zone == Zone::cosmetic ? area : 0;
  };
  if (voters.count > 0) std::copy(all, all + points.count, votes);
  for (std::uint32_t i = 0; i < voters.count; ++i) {
    const std::uint32_t t = voters.triangles[i];
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const Zone* zones = voters.results.zones + std::size_t{4} * i;
    for (int k = 0; k < 3; ++k) votes[corner[k]] -= unit.third(points.doubleAreas[t]);
    for (int k = 0; k < 4; ++k) count(sums[results.segments[corner[0]]], unit.quarter(points.doubleAreas[t]), zones[k]);
  }
  for (std::uint32_t i = 0; i < points.count; ++i) {
    Sums& sum = sums[results.segments[i]];
    sum.all += all[i];
    count(sum, votes[i], results.zones[i]);
  }
  const double toInput = 1.0 / units.scale / units.scale;
  for (std::size_t s = 0; s < stats.size(); ++s) {
    stats[s].area = unit.area(sums[s].all) * toInput;
    stats[s].exposedArea = unit.area(sums[s].exposed) * toInput;
    stats[s].coveredArea = stats[s].sunkArea = unit.area(sums[s].covered) * toInput;
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
