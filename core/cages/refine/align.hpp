#pragma once

#include "cagecast/cages.hpp"
#include "refine/gaps.hpp"

namespace cagecast::cages {

enum class Growth : std::uint8_t { free, none };

/// Moves, turns and, if it may, enlarges or shrinks a cage so that its gaps become as even as possible.
/// @param reach  How far off the cage may be, as a share of the diagonal.
/// @return false if `progress` cancelled it; it is told shares from 0 to 1.
bool alignCage(const Target& target, std::span<const CageSpot> spots, Growth growth, double reach,
               const Progress& progress, TriangleMesh& cage);

}  // namespace cagecast::cages
