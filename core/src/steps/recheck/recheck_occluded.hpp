#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/recheck/hiders.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 9: finds the occluded points that can be seen from the cage in other directions than along their rays, and sets
/// their `data.recovery` to `Recovery::always`. Segments with no covered area are left out: they are
/// culled unless locked to keep, or the threshold is 0 and there is no floor. Then finds those that can be seen past
/// other segments, for whom these are added to `data.hiddenBy`.
/// @pre `findHiders` was called.
void recheckOccluded(const Scene& scene, PointData& data, const Array<SegmentStats>& stats,
                     HiderRecords& records) noexcept;

}  // namespace cagecast
