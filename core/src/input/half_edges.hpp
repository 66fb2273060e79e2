#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "input/cage.hpp"

namespace cagecast {

/// Which triangles of the cage share an edge. Vertices with equal positions are one.
/// Side 3 · t + k goes from corner k of triangle t to the next one.
struct HalfEdges {
  std::uint32_t vertexCount = 0;  ///< Of the mesh.
  const std::uint32_t* starts =
      nullptr;  ///< 1 per side: the vertex that it begins at, by the first in the mesh with its position.
  const std::uint32_t* next =
      nullptr;  ///< 1 per side: another side on the same edge; all sides of an edge form a ring.

  /// The side that begins where this one ends.
  static std::uint32_t after(std::uint32_t side) noexcept { return side % 3 == 2 ? side - 2 : side + 1; }
};

/// @param mesh  The cage as it was given: positions are compared as they are there, not scaled.
/// @return false if memory ran out.
bool findHalfEdges(const MeshView& mesh, const Cage& cage, Arena& arena, HalfEdges& out) noexcept;

}  // namespace cagecast
