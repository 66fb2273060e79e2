#include "fit/finish.hpp"

#include <algorithm>
#include <cmath>

#include "fit/relax.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr int kPushes = 12;
constexpr double kMaxPush = 4;      ///< Of a vertex in all, in offsets: beyond it fins grow between legs.
constexpr double kClearance = 0.1;  ///< How far skin should stay inside of the cage, in offsets.
constexpr double kVisible = 1.6;    ///< Skin deeper inside the hull than this does not count, in offsets.
constexpr double kPushReach = 4;    ///< Skin farther away from the cage than this does not count, in offsets.

/// The skin that should be inside a cage.
struct Skin {
  std::vector<Vec3> positions, normals;
};

Skin visibleSkin(const Enclosed& inside, double offset) {
  Skin out;
  const std::vector<Vec3> normals = vertexNormals(inside.skin);
  const std::vector<SurfacePoint> onHull = Surface(inside.hull).closest(inside.skin.positions);
  for (std::size_t v = 0; v < inside.skin.positions.size(); ++v) {
    if (!(onHull[v].distance < kVisible * offset)) continue;
    out.positions.push_back(inside.skin.positions[v]);
    out.normals.push_back(normals[v]);
  }
  return out;
}

std::vector<bool> borderVertices(const TemplateCage& cage) {
  std::vector<bool> out(cage.mesh.positions.size());
  for (const auto& loop : cage.loops)
    for (const std::uint32_t v : loop) out[v] = true;
  return out;
}

/// How far each vertex of a cage would have to move for the skin to be inside; empty if all of it is.
/// @param onBorder  Per vertex. Where the closest point is on a border, the cage says nothing about the skin.
std::vector<double> neededMoves(const TriangleMesh& cage, const std::vector<bool>& onBorder, const Skin& skin,
                                double offset) {
  std::vector<double> needed(cage.positions.size());
  bool any = false;
  const std::vector<SurfacePoint> closest = Surface(cage).closest(skin.positions);
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const auto& [triangle, position, weights, distance, height] = closest[i];
    const Triangle3& t = cage.triangles[triangle];
    bool atBorder = true;
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      squares += weights[k] * weights[k];
      if (weights[k] > 1e-4 && !onBorder[t[k]]) atBorder = false;
    }
    const double missing = height + kClearance * offset;
    if (atBorder || missing <= 0 || distance > kPushReach * offset) continue;
    const Vec3 normal = areaNormal(cage, t);
    if (dot(normal, skin.normals[i]) < 0.5 * length(normal)) continue;
    any = true;
    for (std::size_t k = 0; k < 3; ++k) needed[t[k]] = std::max(needed[t[k]], missing * weights[k] / squares);
  }
  return any ? needed : std::vector<double>{};
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
    if (ring > 0) grow(cage.neighbours, stays);
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
  const Skin skin = visibleSkin(inside, cage.offset);
  const std::vector<bool> onBorder = borderVertices(cage);
  const std::vector<bool> foldedBefore = foldedTriangles(cage.mesh);
  std::vector<double> pushed(positions.size());
  for (int round = 0; round < kPushes; ++round) {
    if (!step(static_cast<double>(round) / kPushes)) return false;
    const TriangleMesh current{positions, cage.mesh.triangles};
    const std::vector<double> needed = neededMoves(current, onBorder, skin, cage.offset);
    if (needed.empty()) break;
    const std::vector<Vec3> normals = vertexNormals(current);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      // Half of what the neighbours need, so that no single vertex sticks out.
      double around = 0;
      for (const std::uint32_t u : cage.neighbours[v])
        around += 0.5 * needed[u] / static_cast<double>(cage.neighbours[v].size());
      const double push = std::min(std::max(needed[v], around), kMaxPush * cage.offset - pushed[v]);
      pushed[v] += push;
      const bool isFree = !(length(tracks[v]) > 0);
      positions[v] = positions[v] + push * (isFree ? normals[v] : dot(normals[v], tracks[v]) * tracks[v]);
    }
    undoFolds(cage, current.positions, foldedBefore, positions);
  }
  return true;
}

}  // namespace cagecast::cages
