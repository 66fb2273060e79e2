#pragma once

#include <cstdint>

#include "cage.hpp"
#include "scratch.hpp"

namespace cagecast {

/// How the cage's triangles hang together in the texture: over edges with equal position and UV at both ends.
/// Side 3 · t + k goes from corner k of triangle t to the next one.
struct Atlas {
  std::uint32_t* nextSide;  ///< 1 per side: another side on the same edge; all sides of an edge form a ring.
  std::uint32_t* islands;   ///< 1 per triangle: equal for those that hang together.
  double* stretch;          ///< 1 per triangle: the most of its edges' UV length / length.
  float mostUv;             ///< The largest UV, without its sign.
};

/// @param mesh  The cage as it was given: vertices are compared as they are there, not scaled.
/// @return false if memory ran out.
bool findAtlas(const MeshView& mesh, const Cage& cage, Scratch& scratch, Atlas& out) noexcept;

}  // namespace cagecast
