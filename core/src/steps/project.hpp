#pragma once

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 1: finds the closest point of the cage to every point, and blends its UVs. All points become covered.
void projectPoints(const Scene& scene, PointData& data) noexcept;

/// Instead of step 1, for comparison: takes the UVs of the nearest cage vertex.
void projectToVertices(const Scene& scene, PointData& data) noexcept;

}  // namespace cagecast
