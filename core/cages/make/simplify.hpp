#pragma once

#include <cstdint>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

struct SimplifyOptions {
  std::uint32_t triangles = 0;  ///< Of the result, about.
  double tolerance = 0;         ///< How far boundary loops may be off; small ones are held to less.
};

/// Makes a mesh of fewer triangles, of vertices of the given one. Each of its boundary loops keeps 5 to 24 vertices in
/// place: small holes would vanish otherwise.
/// Surface simplification by quadric error metrics (Garland, Heckbert 1997), by meshoptimizer.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool simplify(const TriangleMesh& mesh, const SimplifyOptions& options, const Progress& progress, TriangleMesh& out);

}  // namespace cagecast::cages
