#include "make/open_border.hpp"

#include <algorithm>
#include <utility>

namespace cagecast::cages {

namespace {

/// Barycentric weights below this are on an edge.
constexpr double kOnEdge = 1e-6;

}  // namespace

OpenBorder::OpenBorder(const TriangleMesh& mesh)
    : triangles_(mesh.triangles),
      isOpen_(mesh.triangles.size(), {false, false, false}),
      isBorder_(mesh.positions.size(), false) {
  std::vector<std::pair<std::uint64_t, std::size_t>> edges;
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangles_[t][i], b = triangles_[t][(i + 1) % 3];
      edges.emplace_back(edgeKey(a, b), 3 * t + i);
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const bool hasTwin = (e > 0 && edges[e - 1].first == edges[e].first) ||
                         (e + 1 < edges.size() && edges[e + 1].first == edges[e].first);
    if (hasTwin) continue;
    const std::size_t t = edges[e].second / 3, i = edges[e].second % 3;
    isOpen_[t][i] = true;
    isBorder_[triangles_[t][i]] = isBorder_[triangles_[t][(i + 1) % 3]] = true;
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
