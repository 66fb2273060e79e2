#pragma once

#include <cstdint>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Lengths are in the space of the model.
struct HullOptions {
  double closing = 0;        ///< Gaps narrower than twice this are bridged.
  double offset = 0;         ///< Distance of the hull from the model.
  std::uint32_t voxels = 0;  ///< Along the longest side of the grid.
};

/// A closed surface around a mesh, at a distance, that bridges gaps and mouths: one component, the outermost.
/// @return false if `progress` cancelled it; it is told shares from 0 to 1.
bool makeHull(const TriangleMesh& mesh, const HullOptions& options, const Progress& progress, TriangleMesh& out);

}  // namespace cagecast::cages
