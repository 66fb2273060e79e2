#pragma once

#include "cagecast/array.hpp"
#include "steps/interior_samples.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 4: finds the connected components of the target, numbered by their first vertex. Of `stats` it fills in the
/// points and groups.
void findSegments(const Scene& scene, PointData& data, Array<SegmentStats>& stats) noexcept;

/// Steps 4 and 7: adds up the areas of the points and of the segments.
void sumAreas(const Scene& scene, const InteriorSamples& samples, PointData& data, Array<SegmentStats>& stats) noexcept;

}  // namespace cagecast
