#include "fit/steps.hpp"

#include <cmath>

#include "mesh/samples.hpp"
#include "mesh/surface.hpp"
#include "mesh/thin_plate.hpp"

namespace cagecast::cages {

namespace {

constexpr int kTightenRounds = 9;
/// Resistance to motion as such.
constexpr double kMinHold = 1e-6;
/// Cosine of the angle between cage and hull beyond which a closest point is not the right one: 60 degrees.
constexpr double kMinAgreement = 0.5;

/// The square of the mean of the neighbours minus the vertex.
std::vector<SparseEntry> bendingOf(const Neighbours& neighbours) {
  std::vector<SparseEntry> laplacian;
  for (std::uint32_t v = 0; v < neighbours.size(); ++v) {
    laplacian.push_back({v, v, -1.0});
    const auto around = neighbours[v];
    for (const std::uint32_t u : around) laplacian.push_back({v, u, 1.0 / static_cast<double>(around.size())});
  }
  return squared(collapsed(std::move(laplacian)), std::vector<double>(neighbours.size(), 1.0));
}

/// The vertices, each as the corner of a triangle, and the centres of the triangles.
std::vector<SurfaceSample> verticesAndCentres(const TriangleMesh& mesh) {
  std::vector<SurfaceSample> samples;
  std::vector<bool> seen(mesh.positions.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = mesh.triangles[t][i];
      if (!seen[v]) samples.push_back({t, {i == 0 ? 1.0 : 0, i == 1 ? 1.0 : 0, i == 2 ? 1.0 : 0}});
      seen[v] = true;
    }
    samples.push_back({t, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
  }
  return samples;
}

}  // namespace

std::vector<Vec3> tighten(const TemplateCage& cage, const std::vector<Vec3>& rest, const TriangleMesh& hull,
                          const TightenOptions& options, const StepCallback& step) {
  if (!step(0)) return {};
  const Surface surface(hull);
  const std::vector<Vec3> hullNormals = vertexNormals(hull);
  const std::vector<SurfaceSample> samples = verticesAndCentres(cage.mesh);
  ThinPlate plate(cage.mesh, bendingOf(cage.neighbours));
  TriangleMesh current{rest, cage.mesh.triangles};
  for (int round = 0; round < kTightenRounds; ++round) {
    const double share = static_cast<double>(round) / (kTightenRounds - 1);
    bool goesOn = true;
    const StepCallback stepOfRound = [&](double done) { return goesOn = step((round + done) / kTightenRounds); };
    if (!stepOfRound(0)) return {};
    const double reach = options.reach * cage.diagonal * std::pow(3.0, -share);
    const std::vector<SurfacePoint> closest = surface.closest(positionsOf(current, samples));
    const std::vector<Vec3> normals = vertexNormals(current);
    std::vector<PlaneTerm> planes(options.holds.begin(), options.holds.end());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (closest[i].distance > reach) continue;
      const Triangle3& corners = cage.mesh.triangles[samples[i].triangle];
      const Vec3 normal = blend(hullNormals, hull.triangles[closest[i].triangle], closest[i].weights);
      const Vec3 own = blend(normals, corners, samples[i].weights);
      const double size = length(normal), ownSize = length(own);
      if (!(dot(normal, own) > kMinAgreement * size * ownSize)) continue;
      planes.push_back({corners, samples[i].weights, closest[i].position, 1 / size * normal, 1});
    }
    const double bending = options.stiffest * std::pow(options.softest / options.stiffest, share);
    current.positions = plate.solve(rest, planes, {bending, options.sliding, kMinHold}, {}, stepOfRound);
    if (!goesOn) return {};
    if (current.positions.empty()) current.positions = rest;
  }
  return current.positions;
}

}  // namespace cagecast::cages
