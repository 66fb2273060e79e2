#include "mesh/outer_points.hpp"

#include <algorithm>

#include "mesh/half_edges.hpp"

namespace cagecast::cages {

namespace {

/// Barycentric weights below this are on an edge.
constexpr double kOnEdge = 1e-6;

}  // namespace

OpenBorder::OpenBorder(const TriangleMesh& mesh)
    : isOpen_(mesh.triangles.size()), isBorder_(mesh.positions.size(), false) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  for (std::size_t h = 0; h < twins.size(); ++h) {
    if (twins[h] != kNone) continue;
    isOpen_[h / 3][h % 3] = isBorder_[originOf(mesh, h)] = isBorder_[endOf(mesh, h)] = true;
  }
}

bool OpenBorder::has(const Triangle3& corners, const SurfacePoint& point) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (isOpen_[point.triangle][i] && point.weights[(i + 2) % 3] < kOnEdge) return true;
    if (point.weights[i] > 1 - kOnEdge && isBorder_[corners[i]]) return true;
  }
  return false;
}

std::vector<double> missingMoves(const TriangleMesh& cage, const OpenBorder& border, const OuterPoints& points,
                                 const OuterRules& rules) {
  std::vector<double> moves(cage.positions.size());
  bool any = false;
  const std::vector<SurfacePoint> closest = Surface(cage).closest(points.positions);
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const SurfacePoint& point = closest[i];
    const Triangle3& corners = cage.triangles[point.triangle];
    const double missing = point.height + rules.clearance;
    if (!(missing > 0) || point.distance > rules.reach || border.has(corners, point)) continue;
    const Vec3 normal = areaNormal(cage, corners);
    if (dot(normal, points.normals[i]) < rules.minCosine * length(normal)) continue;
    any = true;
    // The least movement of the three corners that takes the plane past the point.
    double squares = 0;
    for (const double w : point.weights) squares += w * w;
    for (std::size_t k = 0; k < 3; ++k)
      moves[corners[k]] = std::max(moves[corners[k]], missing * point.weights[k] / squares);
  }
  return any ? moves : std::vector<double>{};
}

}  // namespace cagecast::cages
