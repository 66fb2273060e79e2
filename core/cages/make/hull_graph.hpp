#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The neighbours of each vertex: those of v are `list[first[v]]` to `list[first[v + 1] - 1]`.
struct Neighbours {
  std::vector<std::uint32_t> first, list;
};

/// Those along the edges of a closed mesh, each once.
Neighbours neighboursIn(const TriangleMesh& mesh);

/// The vertices with a neighbour that has another mark.
std::vector<std::uint32_t> borderOf(const Neighbours& neighbours, const std::vector<bool>& marks);

/// Whether each vertex is within some edges of one of others.
std::vector<bool> within(const Neighbours& neighbours, std::vector<std::uint32_t> others, int edges);

/// Halves the edges of triangles of which a vertex is chosen; their neighbours are cut to fit. New vertices come after
/// the mesh's own.
/// @param[in,out] parents  A number per triangle, which its parts inherit.
void refine(const std::vector<bool>& isChosen, TriangleMesh& mesh, std::vector<std::uint32_t>& parents);

}  // namespace cagecast::cages
