#pragma once

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 12: gives every triangle corner of the target a UV. Those of a triangle across a seam of the cage's texture are
/// its own, so that it does not stretch over several charts: its three corners are projected onto a part of the cage
/// that is connected in UV, around the closest point of one of them. All other corners have the UVs of their vertices.
/// Cost: O(N + M) for N triangles of the target and M of the cage. A triangle across a seam also costs as
/// much as there are cage triangles around it, within 1.5 times its longest edge and 0.01 diagonals.
/// @param[out] cornerUvs  2 per index of the target.
void projectCorners(const Scene& scene, const PointData& data, Array<float>& cornerUvs) noexcept;

}  // namespace cagecast
