#include "make/steps.hpp"

#include <algorithm>

#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

constexpr int kEncloseRounds = 16;
constexpr OuterRules kEnclosed{.minCosine = 0.34};  ///< 70 degrees.

}  // namespace

bool enclose(const OuterPoints& points, double limit, const Progress& progress, TriangleMesh& mesh) {
  std::vector<double> left(mesh.positions.size(), limit);
  const OpenBorder border(mesh);
  for (int round = 0; round < kEncloseRounds; ++round) {
    if (!report(progress, round / static_cast<double>(kEncloseRounds), "enclose")) return false;
    const std::vector<double> moves = missingMoves(mesh, border, points, kEnclosed);
    if (moves.empty()) break;
    const std::vector<Vec3> normals = vertexNormals(mesh);
    for (std::size_t v = 0; v < moves.size(); ++v) {
      const double by = std::min(moves[v], left[v]);
      left[v] -= by;
      mesh.positions[v] = mesh.positions[v] + by * normals[v];
    }
  }
  return report(progress, 1, "enclose");
}

}  // namespace cagecast::cages
