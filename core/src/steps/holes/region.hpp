#pragma once

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 10: finds the outer borders of the cage, and the points beyond them, whose `data.visibility` becomes `beyond`.
/// @param[out] isOuter  1 per boundary loop: whether it is an outer border.
void markBeyond(const Scene& scene, PointData& data, bool* isOuter) noexcept;

/// The same for interior samples, once the borders are known: each by itself.
void markSamplesBeyond(const Scene& scene, PointData& samples, const bool* isOuter) noexcept;

}  // namespace cagecast
