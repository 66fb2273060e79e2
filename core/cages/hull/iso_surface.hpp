#pragma once

#include <vector>

#include "cagecast/cages.hpp"
#include "hull/grid.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Makes the surface on which a function on a grid is 0, as a closed manifold with its normals away from positive
/// values. The nodes on the border of the grid must be negative. Marching cubes (Lorensen, Cline 1987), with one rule
/// for ambiguous faces: positive corners are kept apart.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool isoSurface(const VoxelGrid& grid, const std::vector<float>& values, const Progress& progress, TriangleMesh& out);

}  // namespace cagecast::cages
