#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// A mesh of about as many triangles as asked for, of vertices of the given one. Each of its boundary loops keeps 5 to
/// 24 vertices in place: small holes would vanish otherwise.
/// @param tolerance  How far loops may be off; small ones are held to less.
/// Surface simplification by quadric error metrics (Garland, Heckbert 1997), by meshoptimizer.
TriangleMesh simplify(const TriangleMesh& mesh, std::uint32_t triangles, double tolerance);

}  // namespace cagecast::cages
