#pragma once

#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// A point that a cage must not fall behind.
struct OuterPoint {
  Vec3 position{};
  Vec3 normal{};  ///< Of the hull there: the cage's is about the same where it belongs to the point.
};

/// Moves the vertices of a mesh outwards until points are behind it. Points next to a hole are let out.
/// @param limit  How far a vertex may go at most; farther would be a fin.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool enclose(const std::vector<OuterPoint>& points, double limit, const Progress& progress, TriangleMesh& mesh);

}  // namespace cagecast::cages
