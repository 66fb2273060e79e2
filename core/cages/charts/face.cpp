#include <algorithm>

#include "charts/min_cut.hpp"
#include "charts/steps.hpp"

namespace cagecast::cages {

namespace {

/// The middle of a face, without a seam if that can be: from brows to chin; in distances of the eyes.
constexpr double kFaceAside = 0.85, kFaceUp = 0.35, kFaceDown = 1.5;
/// The least cosine between a normal and the front in the middle of a face.
constexpr double kFaceFront = 0.3;
/// A border costs as much as facing wrong by 1 on a strip this wide, in distances of the eyes.
constexpr double kFaceBorder = 0.3;

bool isMiddleOf(const TriangleMesh& mesh, const Triangle3& t, const FaceFrame& face) {
  const Vec3 d = face.toLocal(centroid(mesh, t)), n = areaNormal(mesh, t);
  return std::abs(d.x) < kFaceAside && d.y < kFaceUp && d.y > -kFaceDown && d.z > 0 &&
         dot(n, face.front) > kFaceFront * length(n);
}

}  // namespace

std::vector<bool> faceTriangles(const TriangleMesh& mesh, const FaceFrame& face) {
  const double border = kFaceBorder * face.size;
  MinCut cut(mesh.triangles.size(), 1e-6 * border * border);
  std::vector<double> area(mesh.triangles.size()), middle(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle3& triangle = mesh.triangles[t];
    const Vec3 n = areaNormal(mesh, triangle);
    const double ahead = dot(n, face.front);
    area[t] = length(n);
    if (isMiddleOf(mesh, triangle, face)) {
      middle[t] = area[t];
      cut.addNode(t, MinCut::kForbidden, 0);
    } else if (!face.reaches(centroid(mesh, triangle))) {
      cut.addNode(t, 0, MinCut::kForbidden);
    } else {
      cut.addNode(t, area[t] + ahead, area[t] - ahead);
    }
  }
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && twins[h] > h)
      cut.addEdge(h / 3, twins[h] / 3,
                  border * length(mesh.positions[endOf(mesh, h)] - mesh.positions[originOf(mesh, h)]));
  std::vector<bool> isFace = cut.solve();
  // One connected region, without islands in it.
  const std::vector<std::uint32_t> regions = regionsOf(mesh, {isFace.begin(), isFace.end()});
  std::vector<double> areas(regions.size() + 1, 0), middles(regions.size() + 1, 0);
  for (std::size_t t = 0; t < regions.size(); ++t) {
    areas[regions[t]] += area[t];
    middles[regions[t]] += middle[t];
  }
  const auto chosen = std::max_element(middles.begin(), middles.end());
  const auto own = static_cast<std::uint32_t>(chosen - middles.begin());
  for (std::size_t t = 0; t < regions.size(); ++t) {
    const bool isIsland =
        !isFace[t] && areas[regions[t]] < areas[own] && face.reaches(centroid(mesh, mesh.triangles[t]));
    isFace[t] = *chosen > 0 && (regions[t] == own || isIsland);
  }
  return isFace;
}

double seamsOnFace(const TriangleMesh& mesh, const FaceFrame& face, const std::vector<Chart>& charts) {
  std::uint32_t first = 0;
  std::vector<Triangle3> copies(mesh.triangles.size());
  for (const Chart& chart : charts) {
    for (std::size_t t = 0; t < chart.piece.triangleOf.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        copies[chart.piece.triangleOf[t]][k] = first + chart.piece.mesh.triangles[t][k];
    first += static_cast<std::uint32_t>(chart.piece.mesh.positions.size());
  }
  const auto copyOf = [&](std::uint32_t h) { return copies[h / 3][h % 3]; };
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  double sum = 0;
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    const std::uint32_t twin = twins[h];
    if (twin == kNone || twin < h) continue;
    if (!isMiddleOf(mesh, mesh.triangles[h / 3], face) || !isMiddleOf(mesh, mesh.triangles[twin / 3], face)) continue;
    const auto next = static_cast<std::uint32_t>(nextInTriangle(h)),
               nextTwin = static_cast<std::uint32_t>(nextInTriangle(twin));
    if (copyOf(h) == copyOf(nextTwin) && copyOf(next) == copyOf(twin)) continue;
    sum += length(mesh.positions[endOf(mesh, h)] - mesh.positions[originOf(mesh, h)]);
  }
  return sum / face.size;
}

}  // namespace cagecast::cages
