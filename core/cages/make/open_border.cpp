#include "make/open_border.hpp"

#include "mesh/half_edges.hpp"

namespace cagecast::cages {

namespace {

/// Barycentric weights below this are on an edge.
constexpr double kOnEdge = 1e-6;

}  // namespace

OpenBorder::OpenBorder(const TriangleMesh& mesh)
    : triangles_(mesh.triangles), isOpen_(mesh.triangles.size()), isBorder_(mesh.positions.size(), false) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  for (std::size_t h = 0; h < twins.size(); ++h) {
    if (twins[h] != kNone) continue;
    isOpen_[h / 3][h % 3] = isBorder_[originOf(mesh, h)] = isBorder_[endOf(mesh, h)] = true;
  }
}

bool OpenBorder::has(const SurfacePoint& point) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (isOpen_[point.triangle][i] && point.weights[(i + 2) % 3] < kOnEdge) return true;
    if (point.weights[i] > 1 - kOnEdge && isBorder_[triangles_[point.triangle][i]]) return true;
  }
  return false;
}

}  // namespace cagecast::cages
