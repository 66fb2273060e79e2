#pragma once

#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// Restores the template's shape at triangles that are folded over or thin, but are not so in the template.
/// @param tracks  Per vertex: the only direction in which it moves, unless a triangle at it cannot be unfolded
///   otherwise; zero if it is free.
void relax(const TemplateCage& cage, const std::vector<Vec3>& tracks, std::vector<Vec3>& positions);

/// Whether each triangle faces away from those around it, or turns by more than 120 degrees at an edge.
std::vector<bool> foldedTriangles(const TriangleMesh& mesh);

}  // namespace cagecast::cages
