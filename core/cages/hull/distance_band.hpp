#pragma once

#include <cstdint>
#include <vector>

#include "cagecast/cages.hpp"
#include "hull/grid.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The unsigned distance to something at each node of a grid; `reach` where it is not closer.
struct DistanceBand {
  double reach = 0;
  std::vector<float> distance;
};

/// The distance to a mesh. Exact next to it; farther out the closest triangles are passed from node to node, which is
/// off by a few hundredths of the spacing where they meet.
/// Cost: proportional to the nodes within reach and to the triangles.
/// @return false if `progress` cancelled it.
bool distanceToMesh(const TriangleMesh& mesh, const VoxelGrid& grid, double reach, const Progress& progress,
                    DistanceBand& out);

/// A point, and the node of the grid that is next to it.
struct GridPoint {
  Vec3 position{};
  std::uint32_t x = 0, y = 0, z = 0;
};

/// The distance to the closest of some points.
/// @return false if `progress` cancelled it.
bool distanceToPoints(const std::vector<GridPoint>& points, const VoxelGrid& grid, double reach,
                      const Progress& progress, DistanceBand& out);

}  // namespace cagecast::cages
