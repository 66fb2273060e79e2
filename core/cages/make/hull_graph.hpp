#pragma once

#include <cstdint>
#include <vector>

#include "mesh/neighbours.hpp"

namespace cagecast::cages {

/// The vertices with a neighbour that has another mark.
std::vector<std::uint32_t> borderOf(const Neighbours& neighbours, const std::vector<bool>& marks);

/// Whether each vertex is at most so many edges away from some vertices.
/// @param front  Those vertices.
std::vector<bool> within(const Neighbours& neighbours, std::vector<std::uint32_t> front, int edges);

/// Halves the edges of triangles of which a vertex is chosen; their neighbours are cut to fit. New vertices come after
/// the mesh's own.
/// @param[in,out] parents  A number per triangle, which its parts inherit.
void refine(const std::vector<bool>& isChosen, TriangleMesh& mesh, std::vector<std::uint32_t>& parents);

}  // namespace cagecast::cages
