#include "base/union_find.hpp"
#include "steps/areas.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// Areas of a segment: of each zone, and what corners have but interiorSamples have not.
struct Sums {
  std::int64_t ofZone[4];
  std::int64_t notVoting;

  void add(Zone zone, std::int64_t area) { ofZone[static_cast<std::size_t>(zone)] += area; }
  [[nodiscard]] std::int64_t of(Zone zone) const { return ofZone[static_cast<std::size_t>(zone)]; }
};

}  // namespace

bool findSegments(const Points& points, std::uint32_t vertexCount, std::span<const std::uint32_t> groups, Arena& arena,
                  PointResults& results, Array<SegmentStats>& stats) noexcept {
  const Arena::Mark mark = arena.mark();
  auto* parents = arena.allocate<std::uint32_t>(points.count);
  auto* firstVertex = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed()) return false;
  UnionFind sets(parents, points.count);
  const std::uint32_t* corner = points.triangles;
  for (std::uint32_t t = 0, end = points.triangleCount; t < end; ++t, corner += 3)
    sets.join({corner[0], corner[1], corner[2]});
  sets.flatten(points.count);

  // Number the components in the order in which the vertices meet them.
  std::uint32_t* segments = results.segments;
  std::fill(segments, segments + points.count, UINT32_MAX);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t root = parents[points.ofVertex[v]];
    if (segments[root] != UINT32_MAX) continue;
    firstVertex[count] = v;
    segments[root] = count++;
  }
  if (!stats.reset(count)) return false;
  for (std::uint32_t s = 0; s < count; ++s) {
    stats[s] = {};
    stats[s].twinOf = s;
    if (!groups.empty()) stats[s].group = groups[firstVertex[s]];
  }
  for (std::uint32_t i = 0, end = points.count; i < end; ++i) {
    segments[i] = segments[parents[i]];
    ++stats[segments[i]].points;
  }
  arena.rewind(mark);
  return true;
}

bool addUpAreas(const Points& points, const InteriorSamples& samples, const Units& units, const PointResults& results,
                Arena& arena, PointAreas& areas, Array<SegmentStats>& stats) noexcept {
  auto* all = arena.allocate<std::int64_t>(points.count);
  auto* interiorSamples = samples.count > 0 ? arena.allocate<std::int64_t>(points.count) : all;
  areas = {all, interiorSamples};
  const Arena::Mark mark = arena.mark();
  auto* sums = arena.allocate<Sums>(stats.size());
  if (arena.failed()) return false;
  std::fill(sums, sums + stats.size(), Sums{});
  std::fill(all, all + points.count, 0);
  const AreaUnit unit(points.triangleCount, units.diagonal);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    for (int i = 0; i < 3; ++i) all[corner[i]] += third;
  }
  if (samples.count > 0) std::copy(all, all + points.count, interiorSamples);
  for (std::uint32_t i = 0; i < samples.count; ++i) {
    const std::uint32_t t = samples.triangles[i];
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const Zone* zones = samples.results.zones + std::size_t{4} * i;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    const std::int64_t quarter = unit.quarter(points.doubleAreas[t]);
    Sums& sum = sums[results.segments[corner[0]]];
    for (int k = 0; k < 3; ++k) interiorSamples[corner[k]] -= third;
    for (int k = 0; k < 4; ++k) sum.add(zones[k], quarter);
    sum.notVoting += 3 * third - 4 * quarter;
  }
  for (std::uint32_t i = 0; i < points.count; ++i) sums[results.segments[i]].add(results.zones[i], interiorSamples[i]);
  const double toInput = 1.0 / units.scale / units.scale;
  for (std::size_t s = 0; s < stats.size(); ++s) {
    const std::int64_t covered = sums[s].of(Zone::cosmetic);
    const std::int64_t exposed = covered + sums[s].of(Zone::uncovered);
    stats[s].area = unit.area(exposed + sums[s].of(Zone::occluded) + sums[s].notVoting) * toInput;
    stats[s].exposedArea = unit.area(exposed) * toInput;
    stats[s].coveredArea = stats[s].depthWeightedArea = unit.area(covered) * toInput;
  }
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
