#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 10: finds for every uncovered point whether it is recovered, and which hole that depends on (`data.recovery`).
/// Also adds up, for each hole, the areas of the segments there.
/// @param[out] shares  Ordered by hole.
void assignHoles(const Scene& scene, PointData& data, const Array<SegmentStats>& stats,
                 Array<HoleShare>& shares) noexcept;

}  // namespace cagecast
