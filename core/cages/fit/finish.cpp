#include "fit/finish.hpp"

#include <algorithm>
#include <cmath>

#include "fit/relax.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr int kPushes = 12;
constexpr double kMostPush = 4;     ///< Of a vertex in all, in offsets: beyond it fins grow between legs.
constexpr double kClearance = 0.1;  ///< How far skin should stay inside of the cage, in offsets.
constexpr double kVisible = 1.6;    ///< Skin deeper inside the hull than this does not count, in offsets.
constexpr double kPushReach = 4;    ///< Skin farther away from the cage than this does not count, in offsets.

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

/// Takes back the moves that fold triangles which are not folded in the template.
void undoFolds(const TemplateCage& cage, const std::vector<Vec3>& old, const std::vector<bool>& foldedBefore,
               std::vector<Vec3>& positions) {
  // The corners first, then their neighbours as well.
  for (int ring = 0; ring < 2;) {
    const std::vector<bool> folded = foldedTriangles({positions, cage.mesh.triangles});
    std::vector<bool> stays(positions.size());
    for (std::size_t t = 0; t < folded.size(); ++t)
      if (folded[t] && !foldedBefore[t])
        for (const std::uint32_t v : cage.mesh.triangles[t]) stays[v] = true;
    if (ring > 0) grow(cage, stays);
    bool any = false;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      if (!stays[v] || !(length(positions[v] - old[v]) > 0)) continue;
      positions[v] = old[v];
      any = true;
    }
    if (!any) ++ring;
  }
}

}  // namespace

bool pushOut(const TemplateCage& cage, const Enclosed& inside, const std::vector<Vec3>& tracks,
             const std::function<bool(double)>& step, std::vector<Vec3>& positions) {
  const std::vector<SkinPoint> points = visiblePoints(inside.skin, inside.hull, cage.offset);
  const std::vector<bool> onBorder = borderVertices(cage);
  std::vector<Vec3> places;
  places.reserve(points.size());
  for (const SkinPoint& point : points) places.push_back(point.position);
  const std::vector<bool> foldedBefore = foldedTriangles(cage.mesh);
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
    const std::vector<Vec3> old = positions;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      // Half of what the neighbours need, so that no single vertex sticks out.
      double around = 0;
      for (const std::uint32_t u : cage.neighbours[v])
        around += 0.5 * wanted[u] / static_cast<double>(cage.neighbours[v].size());
      const double push = std::min(std::max(wanted[v], around), kMostPush * cage.offset - pushed[v]);
      pushed[v] += push;
      const bool isFree = !(length(tracks[v]) > 0);
      positions[v] = positions[v] + push * (isFree ? normals[v] : dot(normals[v], tracks[v]) * tracks[v]);
    }
    undoFolds(cage, old, foldedBefore, positions);
  }
  return true;
}

}  // namespace cagecast::cages
