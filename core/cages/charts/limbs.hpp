#pragma once

#include <cstdint>
#include <vector>

#include "charts/piece.hpp"

namespace cagecast::cages {

/// Parts of a body that stick out: arms, legs, a head, a tail, ears.
struct Limbs {
  std::vector<std::uint32_t> labels;  ///< Per triangle: 0 for the trunk, i + 1 for limb i.
  std::vector<std::uint32_t> tips;    ///< The outermost vertex of each limb.
};

/// Finds the limbs of a connected piece by the mean distance of each vertex to all others along the surface: limbs are
/// where it rises to a peak, and end where that region runs into another (the join tree). They are cut off along the
/// shortest loop thereabouts.
/// @param most  How many at most; the longest are kept.
Limbs limbsOf(const TriangleMesh& mesh, std::size_t most);

}  // namespace cagecast::cages
