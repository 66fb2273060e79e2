#pragma once

#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The part of a mesh in which a field is less than ½. Triangles that the border crosses are cut along it; pieces of
/// less than a hundredth of the area are dropped.
/// @param field  Per vertex; see `holeField`.
TriangleMesh cutHoles(const TriangleMesh& mesh, const std::vector<double>& field);

}  // namespace cagecast::cages
