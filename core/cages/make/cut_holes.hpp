#pragma once

#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The part of a mesh without the holes of a field, which begin at 0.4. Triangles that the border of a hole crosses are
/// cut along it; pieces of less than a hundredth of the area are dropped.
/// @param field  Per vertex: see `HoleMarker::field`.
TriangleMesh cutHoles(const TriangleMesh& mesh, const std::vector<double>& field);

}  // namespace cagecast::cages
