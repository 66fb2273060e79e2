#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 6: finds the occluded points that can be seen from the cage in other directions than along their rays, and sets
/// their `data.recovery` to `Recovery::always`. Segments nothing of which is covered are left out: they are culled, but
/// for a threshold of 0 without a floor, or a lock.
void recheckOccluded(const Scene& scene, PointData& data, const Array<SegmentStats>& stats) noexcept;

}  // namespace cagecast
