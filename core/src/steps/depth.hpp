#pragma once

#include "cagecast/array.hpp"
#include "steps/interior_samples.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 5′: finds the depth-weighted area of every segment: its covered area, counted less where it lies deeper under
/// the cage than what else is covered around there.
void weightByDepth(const Scene& scene, const PointData& data, const InteriorSamples& samples,
                   Array<SegmentStats>& stats) noexcept;

}  // namespace cagecast
