#pragma once

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 2: marks the points over which the target itself lies. Step 6: only up to `occlusionReach` beyond the cage.
void markOccluded(const Scene& scene, PointData& data) noexcept;

}  // namespace cagecast
