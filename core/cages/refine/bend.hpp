#pragma once

#include "cagecast/cages.hpp"
#include "refine/gaps.hpp"

namespace cagecast::cages {

/// Bends a cage that lies about where it belongs so that its gaps become even: by a smooth motion of its vertices.
/// @param reach  How far off the cage may be, as a share of the diagonal.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool bendCage(const Target& target, const std::vector<SurfaceSample>& spots, double reach, const Progress& progress,
              TriangleMesh& cage);

}  // namespace cagecast::cages
