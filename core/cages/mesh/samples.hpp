#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// A spot of a mesh, which moves with its triangle.
struct SurfaceSample {
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{};  ///< Barycentric, of the triangle's corners.
};

/// About `count` spots spread evenly over the area of a mesh; the same ones every time. Neighbours are close together
/// in the list, so that searches for them in turn are quick.
std::vector<SurfaceSample> spreadSamples(const TriangleMesh& mesh, std::size_t count);

/// Where spots of a mesh are.
std::vector<Vec3> positionsOf(const TriangleMesh& mesh, const std::vector<SurfaceSample>& samples);

inline std::vector<Vec3> spreadPoints(const TriangleMesh& mesh, std::size_t count) {
  return positionsOf(mesh, spreadSamples(mesh, count));
}

}  // namespace cagecast::cages
