#pragma once

#include <cstdint>
#include <vector>

#include "mesh/surface.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The model, and which of its triangles must not be painted.
struct MarkedMesh {
  const TriangleMesh* mesh = nullptr;
  const Surface* surface = nullptr;  ///< Of `mesh`.
  std::vector<bool> isMarked;        ///< Per triangle of `mesh`.
};

/// How much a hull around a model is to have a hole at each of its vertices: 0 not at all, 1 wholly, the border is at
/// ½. A vertex is marked if what lies straight below it is, or what is nearest to it where nothing lies below; or if
/// what is marked and just below the hull is nearest to it. The marks are then smoothed; those that vanish by it come
/// back.
/// @param refinements  How often the hull's edges are halved near the borders first.
/// @param depth  How far below the hull a part may lie and still be seen through it.
std::vector<double> holeField(const MarkedMesh& model, double depth, int refinements, TriangleMesh& hull);

}  // namespace cagecast::cages
