#include <algorithm>

#include "base/area_unit.hpp"
#include "steps/segments.hpp"

namespace cagecast {
namespace {

/// Areas of a segment, in an `AreaUnit`.
struct Sums {
  std::int64_t ofVisibility[4];
  std::int64_t depth;     ///< Of covered area: area times depth, as a share of the diagonal.
  std::int64_t rounding;  ///< Area that rounding takes from its interior samples, against the corners they replace.

  void add(Visibility there, std::int64_t area, double depthThere) {
    ofVisibility[static_cast<std::size_t>(there)] += area;
    depth += static_cast<std::int64_t>(static_cast<double>(area) * depthThere) * (there == Visibility::covered);
  }
  [[nodiscard]] std::int64_t of(Visibility there) const { return ofVisibility[static_cast<std::size_t>(there)]; }
};

}  // namespace

void sumAreas(const Scene& scene, const InteriorSamples& samples, PointData& data,
              Array<SegmentStats>& stats) noexcept {
  Arena& arena = scene.arena;
  const Points points = data.points;
  auto* const all = data.areas = arena.allocate<std::int64_t>(points.count);
  auto* const own = data.unsampledAreas = samples.triangleCount > 0 ? arena.allocate<std::int64_t>(points.count) : all;
  const Arena::Scope scope(arena);
  auto* sums = arena.allocate<Sums>(stats.size());
  if (arena.failed()) return;
  std::fill(sums, sums + stats.size(), Sums{});
  std::fill(all, all + points.count, 0);
  const AreaUnit unit(points.triangleCount);
  // Depths of at most 1 keep the sums within 63 bits.
  const bool hasDepth = scene.options.steps.projection == ProjectionMode::nearestPoint && scene.units.diagonal > 0;
  const double perDistance = hasDepth ? 1 / scene.units.diagonal : 0;
  const auto depthOf = [=](const PointData& at, std::size_t i) {
    return std::min(static_cast<double>(at.distances[i]) * perDistance, 1.0);
  };
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    for (int i = 0; i < 3; ++i) all[corner[i]] += third;
  }
  if (samples.triangleCount > 0) std::copy(all, all + points.count, own);
  for (std::uint32_t i = 0; i < samples.triangleCount; ++i) {
    const std::uint32_t t = samples.triangles[i];
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const Visibility* visibility = samples.data.visibility + std::size_t{4} * i;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    const std::int64_t quarter = unit.quarter(points.doubleAreas[t]);
    Sums& sum = sums[data.segments[corner[0]]];
    for (int k = 0; k < 3; ++k) own[corner[k]] -= third;
    for (std::size_t k = 0; k < 4; ++k) sum.add(visibility[k], quarter, depthOf(samples.data, std::size_t{4} * i + k));
    sum.rounding += 3 * third - 4 * quarter;
  }
  for (std::uint32_t i = 0; i < points.count; ++i)
    sums[data.segments[i]].add(data.visibility[i], own[i], depthOf(data, i));

  const double toInput = scene.units.areaToInput();
  for (std::size_t s = 0; s < stats.size(); ++s) {
    const std::int64_t covered = sums[s].of(Visibility::covered);
    const std::int64_t exposed = covered + sums[s].of(Visibility::uncovered);
    const std::int64_t beyond = sums[s].of(Visibility::beyond);
    stats[s].area = unit.area(exposed + sums[s].of(Visibility::occluded) + beyond + sums[s].rounding) * toInput;
    stats[s].beyondArea = unit.area(beyond) * toInput;
    stats[s].exposedArea = unit.area(exposed) * toInput;
    stats[s].coveredArea = unit.area(covered) * toInput;
    // Rounding may take it beyond the whole.
    stats[s].depth = covered > 0 ? std::min(1.0, static_cast<double>(sums[s].depth) / static_cast<double>(covered)) : 0;
  }
}

}  // namespace cagecast
