#pragma once

#include <vector>

#include "cagecast/cages.hpp"
#include "hull/hull.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

struct WrapOptions {
  HullOptions hull;
  bool mayWiden = false;  ///< Whether wider gaps may be bridged if pieces are left out.
};

/// A hull, as by `makeHull`, around all that is to be painted.
/// @param isMarked  Per triangle of the mesh: need not be in the hull.
/// @return aborted, noVolume, or inPieces if these lie too far apart.
Status wrap(const TriangleMesh& mesh, const std::vector<bool>& isMarked, const WrapOptions& options,
            const Progress& progress, TriangleMesh& out);

}  // namespace cagecast::cages
