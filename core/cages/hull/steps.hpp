#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"
#include "mesh/triangle_mesh.hpp"

/// The steps of making a hull, each in a file of its own.
namespace cagecast::cages {

/// A regular grid of nodes, x running fastest.
struct VoxelGrid {
  Vec3 origin{};       ///< Position of the first node.
  double spacing = 0;  ///< Between nodes, in the space of the model.
  std::uint32_t nx = 0, ny = 0, nz = 0;

  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{nx} * ny * nz; }
  [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
    return (std::size_t{z} * ny + y) * nx + x;
  }
  [[nodiscard]] Vec3 position(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
    return origin + spacing * Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
};

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

/// Makes the surface on which a function on a grid is 0, as a closed manifold with its normals away from positive
/// values. The nodes on the border of the grid must be negative. Marching cubes (Lorensen, Cline 1987), with one rule
/// for ambiguous faces: positive corners are kept apart.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool isoSurface(const VoxelGrid& grid, const std::vector<float>& values, const Progress& progress, TriangleMesh& out);

}  // namespace cagecast::cages
