#include "fit/finish.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr int kPushes = 12;
constexpr double kMostPush = 4;      ///< Of a vertex in all, in offsets: beyond it fins grow between legs.
constexpr double kClearance = 0.1;   ///< How far skin should stay inside of the cage, in offsets.
constexpr double kVisible = 1.6;     ///< Skin farther inside of the hull is not pushed for, in offsets.
constexpr double kPushReach = 4;     ///< Skin farther away from the cage is not pushed for, in offsets.
constexpr double kSharpTurn = -0.5;  ///< Cosine of the angle at an edge at which two triangles count as folded.
constexpr int kUntangleRounds = 60;

/// A point of the skin that should be inside, with its normal.
struct SkinPoint {
  Vec3 position, normal;
};

std::vector<SkinPoint> visiblePoints(const TriangleMesh& skin, const TriangleMesh& hull, double offset) {
  std::vector<SkinPoint> points;
  const std::vector<Vec3> normals = vertexNormals(skin);
  const std::vector<SurfacePoint> onHull = Surface(hull).closest(skin.positions);
  for (std::size_t v = 0; v < skin.positions.size(); ++v)
    if (onHull[v].distance < kVisible * offset) points.push_back({skin.positions[v], normals[v]});
  return points;
}

std::vector<bool> borderVertices(const TemplateCage& cage) {
  std::vector<bool> out(cage.mesh.positions.size());
  for (const auto& loop : cage.loops)
    for (const std::uint32_t v : loop) out[v] = true;
  return out;
}

}  // namespace

bool pushOut(const TemplateCage& cage, const TriangleMesh& skin, const TriangleMesh& hull,
             const std::function<bool(double)>& step, std::vector<Vec3>& positions) {
  const std::vector<SkinPoint> points = visiblePoints(skin, hull, cage.offset);
  const std::vector<bool> onBorder = borderVertices(cage);
  std::vector<Vec3> places;
  places.reserve(points.size());
  for (const SkinPoint& point : points) places.push_back(point.position);
  std::vector<double> pushed(positions.size());
  for (int round = 0; round < kPushes; ++round) {
    if (!step(static_cast<double>(round) / kPushes)) return false;
    const TriangleMesh current{positions, cage.mesh.triangles};
    const std::vector<Vec3> normals = vertexNormals(current);
    const std::vector<SurfacePoint> closest = Surface(current).closest(places);
    std::vector<double> wanted(positions.size());
    bool any = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Triangle3& t = current.triangles[closest[i].triangle];
      bool atBorder = true;  // Where the nearest point is on a border, the cage says nothing about the skin.
      double squares = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        squares += closest[i].weights[k] * closest[i].weights[k];
        if (closest[i].weights[k] > 1e-4 && !onBorder[t[k]]) atBorder = false;
      }
      const Vec3 normal = areaNormal(current, t);
      const double missing = closest[i].height + kClearance * cage.offset;
      if (atBorder || missing <= 0 || closest[i].distance > kPushReach * cage.offset) continue;
      if (dot(normal, points[i].normal) < 0.5 * length(normal)) continue;
      any = true;
      for (std::size_t k = 0; k < 3; ++k)
        wanted[t[k]] = std::max(wanted[t[k]], missing * closest[i].weights[k] / squares);
    }
    if (!any) break;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      // Half of what the neighbours need, so that no single vertex sticks out.
      double around = 0;
      for (const std::uint32_t u : cage.neighbours[v])
        around += 0.5 * wanted[u] / static_cast<double>(cage.neighbours[v].size());
      const double push = std::min(std::max(wanted[v], around), kMostPush * cage.offset - pushed[v]);
      pushed[v] += push;
      positions[v] = positions[v] + push * normals[v];
    }
  }
  return true;
}

std::vector<bool> foldedTriangles(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Vec3> normals(count), around(mesh.positions.size(), Vec3{0, 0, 0});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> triangleAt;
  for (std::size_t t = 0; t < count; ++t) {
    normals[t] = areaNormal(mesh, mesh.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      around[mesh.triangles[t][k]] = around[mesh.triangles[t][k]] + normals[t];
      triangleAt[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
    }
  }
  std::vector<bool> folded(count);
  for (std::size_t t = 0; t < count; ++t) {
    Vec3 sum = -3.0 * normals[t];
    for (const std::uint32_t v : mesh.triangles[t]) sum = sum + around[v];
    if (dot(sum, normals[t]) < 0) folded[t] = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto other = triangleAt.find({mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][k]});
      if (other == triangleAt.end()) continue;
      const Vec3& n = normals[other->second];
      if (dot(n, normals[t]) < kSharpTurn * length(n) * length(normals[t])) folded[t] = folded[other->second] = true;
    }
  }
  return folded;
}

void untangle(const TemplateCage& cage, std::vector<Vec3>& positions) {
  const std::vector<bool> before = foldedTriangles(cage.mesh);
  const std::vector<bool> onBorder = borderVertices(cage);
  for (int round = 0; round < kUntangleRounds; ++round) {
    const std::vector<bool> folded = foldedTriangles({positions, cage.mesh.triangles});
    std::vector<bool> moves(positions.size());
    bool any = false;
    for (std::size_t t = 0; t < folded.size(); ++t) {
      if (!folded[t] || before[t]) continue;
      any = true;
      for (const std::uint32_t v : cage.mesh.triangles[t]) moves[v] = true;
    }
    if (!any) return;
    // The displacement from the template is smoothed, not the shape: what is sharp in the template stays so.
    std::vector<Vec3> next = positions;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      if (!moves[v] || cage.neighbours[v].empty()) continue;
      Vec3 mean{0, 0, 0};
      double total = 0;
      for (const std::uint32_t u : cage.neighbours[v]) {
        if (round < kUntangleRounds / 2 && onBorder[v] && !onBorder[u])
          continue;  // A border keeps its course at first.
        const Vec3 target = round < kUntangleRounds / 2
                                ? positions[u] + (cage.mesh.positions[v] - cage.mesh.positions[u])
                                : positions[u];
        mean = mean + target;
        ++total;
      }
      if (total > 0) next[v] = 0.5 * positions[v] + 0.5 / total * mean;
    }
    positions = std::move(next);
  }
}

}  // namespace cagecast::cages
