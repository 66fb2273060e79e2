#pragma once

#include <vector>

#include "hull/grid.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The surface on which a function on a grid is 0, as a closed manifold with its normals away from positive values.
/// The nodes on the border of the grid must be negative.
/// Marching cubes (Lorensen, Cline 1987), with one rule for ambiguous faces: positive corners are kept apart.
TriangleMesh isoSurface(const VoxelGrid& grid, const std::vector<float>& values);

}  // namespace cagecast::cages
