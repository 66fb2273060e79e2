#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// A mesh of about as many triangles as asked for, of vertices of the given one. Each of its boundary loops keeps 5 to
/// 12 vertices in place: small holes would vanish otherwise.
/// Surface simplification by quadric error metrics (Garland, Heckbert 1997), by meshoptimizer.
TriangleMesh simplify(const TriangleMesh& mesh, std::uint32_t triangles);

}  // namespace cagecast::cages
