#pragma once

#include "base/arena.hpp"
#include "base/units.hpp"
#include "input/weld.hpp"
#include "search/ray_tree.hpp"

namespace cagecast {

/// Builds the tree over the target's triangles, whose points are in the order of a Hilbert curve: nodes are ranges of
/// that order, cut where the curve leaves a cell.
/// @return false if memory ran out.
bool buildTargetTree(const Points& target, const Units& units, Arena& arena, RayTree& out) noexcept;

}  // namespace cagecast
