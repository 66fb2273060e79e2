#include "make/enclose.hpp"

#include <algorithm>

#include "make/open_border.hpp"
#include "mesh/progress.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr int kEncloseRounds = 16;
/// Of the angle between a point's normal and the cage's: 70 degrees.
constexpr double kMinCosine = 0.34;

}  // namespace

bool enclose(const std::vector<OuterPoint>& points, double limit, const Progress& progress, TriangleMesh& mesh) {
  std::vector<Vec3> positions;
  positions.reserve(points.size());
  for (const OuterPoint& point : points) positions.push_back(point.position);
  std::vector<double> left(mesh.positions.size(), limit);
  const OpenBorder border(mesh);
  for (int round = 0; round < kEncloseRounds; ++round) {
    if (!report(progress, round / static_cast<double>(kEncloseRounds), "enclose")) return false;
    const std::vector<Vec3> normals = vertexNormals(mesh);
    std::vector<double> push(mesh.positions.size(), 0);
    const std::vector<SurfacePoint> closest = Surface(mesh).closest(positions);
    bool isDone = true;
    for (std::size_t i = 0; i < closest.size(); ++i) {
      const SurfacePoint& point = closest[i];
      const Triangle3& corners = mesh.triangles[point.triangle];
      if (!(point.height > 0) || border.has(point)) continue;
      const Vec3 normal = areaNormal(mesh, corners);
      if (dot(normal, points[i].normal) < kMinCosine * length(normal)) continue;
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
  return report(progress, 1, "enclose");
}

}  // namespace cagecast::cages
