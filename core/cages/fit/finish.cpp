#include "fit/steps.hpp"

#include <algorithm>

#include "mesh/outer_points.hpp"

namespace cagecast::cages {

namespace {

constexpr int kPushes = 12;
constexpr double kMaxPush = 4;      ///< Of a vertex in all, in offsets: beyond it fins grow between legs.
constexpr double kClearance = 0.1;  ///< How far skin should stay inside of the cage, in offsets.
constexpr double kVisible = 1.6;    ///< Skin deeper inside the hull than this does not count, in offsets.
constexpr double kPushReach = 4;    ///< Skin farther away from the cage than this does not count, in offsets.

/// The skin that should be inside a cage.
OuterPoints visibleSkin(const Enclosed& inside, double offset) {
  OuterPoints out;
  const std::vector<Vec3> normals = vertexNormals(inside.skin);
  const std::vector<SurfacePoint> onHull = Surface(inside.hull).closest(inside.skin.positions);
  for (std::size_t v = 0; v < inside.skin.positions.size(); ++v) {
    if (!(onHull[v].distance < kVisible * offset)) continue;
    out.positions.push_back(inside.skin.positions[v]);
    out.normals.push_back(normals[v]);
  }
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
             const StepCallback& step, std::vector<Vec3>& positions) {
  const OuterPoints skin = visibleSkin(inside, cage.offset);
  const OuterRules rules{0.5, kClearance * cage.offset, kPushReach * cage.offset};
  const OpenBorder border(cage.mesh);
  const std::vector<bool> foldedBefore = foldedTriangles(cage.mesh);
  std::vector<double> pushed(positions.size());
  for (int round = 0; round < kPushes; ++round) {
    if (!step(static_cast<double>(round) / kPushes)) return false;
    const TriangleMesh current{positions, cage.mesh.triangles};
    const std::vector<double> needed = missingMoves(current, border, skin, rules);
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
