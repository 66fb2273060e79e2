#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Halves the edges of triangles of which a vertex is chosen; their neighbours are cut to fit. New vertices come after
/// the mesh's own.
/// @param[in,out] parents  A number per triangle, which its parts inherit.
void subdivide(const std::vector<bool>& isChosen, TriangleMesh& mesh, std::vector<std::uint32_t>& parents);

}  // namespace cagecast::cages
