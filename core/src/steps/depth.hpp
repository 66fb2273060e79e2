#pragma once

#include "cagecast/array.hpp"
#include "steps/interior_samples.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 5′: finds the depth-weighted area of every segment: its covered area, where each sample counts as
/// area · min(1, typical depth / depth)². The typical depth is the mean depth of the covered samples around it.
void weightByDepth(const Scene& scene, const PointData& data, const InteriorSamples& samples,
                   Array<SegmentStats>& stats) noexcept;

}  // namespace cagecast
