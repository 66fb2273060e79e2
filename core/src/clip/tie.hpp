#pragma once

#include "clip/border_classifier.hpp"

namespace cagecast {

/// Whether a triangle of the cage surely loses to another one at all points of a part of the target, by the tie rule of
/// docs/method.md, step 1.
///
/// Points beyond a shared edge or corner are equally far from both triangles, however far away they are, and the planes
/// decide. Distances alone never tell which of the two regions such a part is in.
/// @param diagonal  Of the target, scaled.
bool losesTie(const Cage& cage, std::uint32_t loser, std::uint32_t winner, Hull hull, double diagonal) noexcept;

}  // namespace cagecast
