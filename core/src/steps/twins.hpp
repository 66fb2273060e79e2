#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 5″: finds the segments that are copies of others, such as the two eyes of a face.
void findTwins(const Scene& scene, const PointData& data, Array<SegmentStats>& stats) noexcept;

}  // namespace cagecast
