#pragma once

#include "cagecast/cages.hpp"
#include "refine/gaps.hpp"

namespace cagecast::cages {

enum class Growth : std::uint8_t { free, none };

/// How far a cage may be moved.
struct AlignLimits {
  Growth growth;  ///< Whether it may be enlarged or shrunk.
  double reach;   ///< How far off it may be, as a share of the diagonal.
};

/// Moves, turns and, if it may, enlarges or shrinks a cage so that its gaps become as even as possible.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool alignCage(const Target& target, const std::vector<SurfaceSample>& spots, const AlignLimits& limits,
               const Progress& progress, TriangleMesh& cage);

}  // namespace cagecast::cages
