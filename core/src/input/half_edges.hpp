#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "input/cage.hpp"

namespace cagecast {

/// Which triangles of the cage share an edge. Vertices with equal positions are one.
/// Half-edge 3 · t + k goes from corner k of triangle t to the next corner.
struct HalfEdges {
  std::uint32_t vertexCount = 0;  ///< Of the mesh.
  /// 1 per half-edge: its origin, as the first vertex of the mesh with that position.
  const std::uint32_t* origins = nullptr;
  /// 1 per half-edge: the next one of the same edge. Those of an edge form a ring; alone it points to itself.
  const std::uint32_t* nextOfEdge = nullptr;

  /// The half-edge that begins where this one ends.
  static std::uint32_t after(std::uint32_t halfEdge) noexcept {
    return halfEdge % 3 == 2 ? halfEdge - 2 : halfEdge + 1;
  }
};

/// @param mesh  The cage as it was given: positions are compared as they are there, not scaled.
/// @return false if memory ran out.
bool findHalfEdges(const MeshView& mesh, const Cage& cage, Arena& arena, HalfEdges& out) noexcept;

}  // namespace cagecast
