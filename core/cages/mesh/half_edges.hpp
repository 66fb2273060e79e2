#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Half-edge 3t + i runs from corner i of triangle t to the next one.
constexpr std::size_t nextInTriangle(std::size_t halfEdge) { return halfEdge % 3 == 2 ? halfEdge - 2 : halfEdge + 1; }
inline std::uint32_t originOf(const TriangleMesh& mesh, std::size_t halfEdge) {
  return mesh.triangles[halfEdge / 3][halfEdge % 3];
}
inline std::uint32_t endOf(const TriangleMesh& mesh, std::size_t halfEdge) {
  return originOf(mesh, nextInTriangle(halfEdge));
}

/// The half-edge on the other side of each; `kNone` where the edge is open, is shared by more than two triangles, or
/// joins triangles that face opposite ways.
std::vector<std::uint32_t> halfEdgeTwins(const TriangleMesh& mesh);

}  // namespace cagecast::cages
