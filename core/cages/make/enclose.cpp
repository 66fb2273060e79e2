#include "make/enclose.hpp"

#include <algorithm>

#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr int kRounds = 16;
/// Of the angle between a point's normal and the cage's: 70 degrees.
constexpr double kLeastCosine = 0.34;
/// Barycentric weights below this are on an edge.
constexpr double kOnEdge = 1e-6;

/// Whether each edge of each triangle is open; edge i runs from corner i.
std::vector<std::array<bool, 3>> openEdges(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::size_t>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
      edges.emplace_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), 3 * t + i);
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::array<bool, 3>> open(mesh.triangles.size(), {false, false, false});
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool hasTwin = (i > 0 && edges[i - 1].first == edges[i].first) ||
                         (i + 1 < edges.size() && edges[i + 1].first == edges[i].first);
    if (!hasTwin) open[edges[i].second / 3][edges[i].second % 3] = true;
  }
  return open;
}

bool isOnOpenEdge(const SurfacePoint& point, const std::array<bool, 3>& open, const Triangle3& corners,
                  const std::vector<bool>& isBorder) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (open[i] && point.weights[(i + 2) % 3] < kOnEdge) return true;
    if (point.weights[i] > 1 - kOnEdge && isBorder[corners[i]]) return true;
  }
  return false;
}

}  // namespace

bool enclose(const std::vector<OuterPoint>& points, double limit, const Progress& progress, TriangleMesh& mesh) {
  std::vector<Vec3> positions;
  positions.reserve(points.size());
  for (const OuterPoint& point : points) positions.push_back(point.position);
  std::vector<double> left(mesh.positions.size(), limit);
  const auto open = openEdges(mesh);
  std::vector<bool> isBorder(mesh.positions.size(), false);
  for (std::size_t t = 0; t < open.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (open[t][i]) isBorder[mesh.triangles[t][i]] = isBorder[mesh.triangles[t][(i + 1) % 3]] = true;
  for (int round = 0; round < kRounds; ++round) {
    if (progress && !progress(static_cast<float>(round) / kRounds, "enclose")) return false;
    const std::vector<Vec3> normals = vertexNormals(mesh);
    std::vector<double> push(mesh.positions.size(), 0);
    const std::vector<SurfacePoint> closest = Surface(mesh).closest(positions);
    bool isDone = true;
    for (std::size_t i = 0; i < closest.size(); ++i) {
      const SurfacePoint& point = closest[i];
      const Triangle3& corners = mesh.triangles[point.triangle];
      if (!(point.height > 0) || isOnOpenEdge(point, open[point.triangle], corners, isBorder)) continue;
      const Vec3 normal = areaNormal(mesh, corners);
      if (dot(normal, points[i].normal) < kLeastCosine * length(normal)) continue;
      isDone = false;
      // The least movement of the three corners that takes the plane past the point.
      double squares = 0;
      for (const double w : point.weights) squares += w * w;
      for (std::size_t k = 0; k < 3; ++k)
        push[corners[k]] = std::max(push[corners[k]], point.height * point.weights[k] / squares);
    }
    if (isDone) break;
    for (std::size_t v = 0; v < push.size(); ++v) {
      const double by = std::min(push[v], left[v]);
      left[v] -= by;
      mesh.positions[v] = mesh.positions[v] + by * normals[v];
    }
  }
  return !progress || progress(1, "enclose");
}

}  // namespace cagecast::cages
