#pragma once

#include "clip/target_triangle.hpp"

namespace cagecast {

/// Cuts the triangles of the target along the borders that a classifier knows.
/// @return false if memory ran out or the classifier is over its limit; `out` is of no use then.
/// Cost: about twenty searches for a nearest point for each edge that is cut.
bool cutTriangles(const ClipInput& input, BorderClassifier& classifier, Arena& arena, ClippedTriangles& out) noexcept;

}  // namespace cagecast
