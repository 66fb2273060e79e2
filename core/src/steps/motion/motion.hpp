#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/recheck/hiders.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 13: finds the points that are occluded at rest and seen in a pose of the target, and marks them in
/// `data.recovery` and `data.hiddenBy` as points that nothing hides, or only the segments of a record. After step 9,
/// before step 10.
void findMotion(const Scene& scene, PointData& data, const Array<SegmentStats>& stats, HiderRecords& records) noexcept;

}  // namespace cagecast
