#pragma once

#include "cagecast/cages.hpp"
#include "mesh/outer_points.hpp"

namespace cagecast::cages {

/// Moves the vertices of a mesh outwards until points are behind it. Points next to a hole are let out.
/// @param limit  How far a vertex may go at most; farther would be a fin.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool enclose(const OuterPoints& points, double limit, const Progress& progress, TriangleMesh& mesh);

}  // namespace cagecast::cages
