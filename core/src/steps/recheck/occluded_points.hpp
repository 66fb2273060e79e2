#pragma once

#include <cstdint>

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Occluded points that step 9 tests, and the edges between them. A point is tested if it has a neighbour that is not
/// one of them, or that step 9 recovers: what is seen grows from what is already visible.
class OccludedPoints {
 public:
  /// Those in segments of which anything is covered. Allocates from the scene's arena.
  /// @param hiddenByOwn  Only points under their own segment, and not recovered.
  OccludedPoints(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats,
                 bool hiddenByOwn = false) noexcept;

  /// 1 per point: whether it is one of these points.
  [[nodiscard]] const bool* flags() const noexcept { return isOccluded_; }

  /// Queues the points with a neighbour that is not one of them, in ascending order.
  /// @param[out] queue  Room for all points.
  /// @return How many there are.
  std::uint32_t queueBorder(std::uint32_t* queue) const noexcept;

  /// Queues the neighbours of a point among them that were never queued.
  /// @param count  How many there are in the queue.
  /// @return How many there are now.
  std::uint32_t queueNeighbours(std::uint32_t point, std::uint32_t* queue, std::uint32_t count) noexcept;

 private:
  void listTriangles(Arena& arena) noexcept;

  Points points_;
  bool* isOccluded_;
  bool* isQueued_;
  std::uint32_t* ends_;  ///< 1 per point: the end of its triangles. They begin at the end of the point before.
  std::uint32_t* triangles_ = nullptr;  ///< The triangles with two or three occluded corners, point by point.
};

}  // namespace cagecast
