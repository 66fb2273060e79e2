#include "steps/recheck/occluded_points.hpp"

#include <algorithm>
#include <utility>

#include "steps/typical_depth.hpp"

namespace cagecast {

// The conditions here are unpredictable, so they are computed without branches: & and |, and counters that grow by 0
// or 1.

OccludedPoints::OccludedPoints(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats,
                               bool hiddenByOwn) noexcept
    : points_(data.points),
      isOccluded_(scene.arena.allocate<bool>(points_.count)),
      isQueued_(scene.arena.allocate<bool>(points_.count)),
      ends_(scene.arena.allocate<std::uint32_t>(points_.count)) {
  if (scene.arena.failed()) return;
  const double deepest = scene.length(TypicalDepth(stats).most());
  for (std::uint32_t p = 0; p < points_.count; ++p) {
    isOccluded_[p] = (data.visibility[p] == Visibility::occluded) & (stats[data.segments[p]].coveredArea > 0);
    if (hiddenByOwn) {
      isOccluded_[p] = isOccluded_[p] & (data.hiddenBy[p] == 0) & (data.recovery[p] == Recovery::never) &
                       (static_cast<double>(data.distances[p]) <= deepest);
    }
  }
  listTriangles(scene.arena);
}

void OccludedPoints::listTriangles(Arena& arena) noexcept {
  const std::uint32_t triangleCount = points_.triangleCount;
  auto* listed = arena.allocate<std::uint32_t>(triangleCount);
  if (arena.failed()) return;
  std::fill(isQueued_, isQueued_ + points_.count, false);
  std::fill(ends_, ends_ + points_.count, 0u);
  const auto cornersOf = [&](std::uint32_t t) { return points_.triangles + std::size_t{3} * t; };
  const auto occludedCorners = [&](const std::uint32_t* corner) {
    return unsigned{isOccluded_[corner[0]]} + unsigned{isOccluded_[corner[1]]} + unsigned{isOccluded_[corner[2]]};
  };
  // First the triangles with any occluded corner, which are few; then, in place, those with two or three.
  std::uint32_t anyCount = 0;
  for (std::uint32_t t = 0; t < triangleCount; ++t) {
    listed[anyCount] = t;
    anyCount += occludedCorners(cornersOf(t)) > 0;
  }
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < anyCount; ++i) {
    const std::uint32_t* corner = cornersOf(listed[i]);
    const unsigned occluded = occludedCorners(corner);
    for (int k = 0; k < 3; ++k) {
      isQueued_[corner[k]] = isQueued_[corner[k]] | ((occluded < 3) & isOccluded_[corner[k]]);
      ends_[corner[k]] += occluded > 1;
    }
    listed[count] = listed[i];
    count += occluded > 1;
  }
  // Each entry of `ends_` is first the start of its point's triangles, and moves to their end.
  std::uint32_t total = 0;
  for (std::uint32_t p = 0; p < points_.count; ++p) total += std::exchange(ends_[p], total);
  triangles_ = arena.allocate<std::uint32_t>(total);
  if (arena.failed()) return;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t* corner = cornersOf(listed[i]);
    for (int k = 0; k < 3; ++k) triangles_[ends_[corner[k]]++] = listed[i];
  }
}

std::uint32_t OccludedPoints::queueBorder(std::uint32_t* queue) const noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < points_.count; ++p) {
    queue[count] = p;
    count += isQueued_[p];
  }
  return count;
}

std::uint32_t OccludedPoints::queueNeighbours(std::uint32_t point, std::uint32_t* queue, std::uint32_t count) noexcept {
  for (std::uint32_t i = point == 0 ? 0 : ends_[point - 1]; i < ends_[point]; ++i) {
    const std::uint32_t* corner = points_.triangles + std::size_t{3} * triangles_[i];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = corner[k];
      if (isQueued_[p] || !isOccluded_[p]) continue;
      isQueued_[p] = true;
      queue[count++] = p;
    }
  }
  return count;
}

}  // namespace cagecast
