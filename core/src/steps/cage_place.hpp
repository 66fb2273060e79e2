#pragma once

#include "geometry/closest_point.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Where the closest point q of a point lies on the cage.
struct CagePlace {
  ClosestPoint closest;
  std::uint32_t loop;  ///< The boundary loop that q is on, or `BoundaryLoops::kNone`.
  double overhang;     ///< How far the point lies sideways from the cage.

  CagePlace(const Scene& scene, const PointData& data, std::uint32_t point) noexcept;

  /// docs/method.md, step 10: whether the point is hardly beside its loop: by at most the lesser of a share of the
  /// target's diagonal, and a share of the diagonal of the loop's box.
  [[nodiscard]] bool isSlight(const Scene& scene) const noexcept;
};

}  // namespace cagecast
