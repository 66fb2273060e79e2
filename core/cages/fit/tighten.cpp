#include "fit/tighten.hpp"

#include <algorithm>
#include <cmath>

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

struct Sample {
  Triangle3 corners;
  std::array<double, 3> weights;
};

/// The vertices, each as the corner of a triangle, and the centres of the triangles.
std::vector<Sample> samplesOf(const TriangleMesh& mesh) {
  std::vector<Sample> samples;
  std::vector<bool> seen(mesh.positions.size());
  for (const Triangle3& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (seen[t[i]]) continue;
      seen[t[i]] = true;
      samples.push_back({{t[i], t[(i + 1) % 3], t[(i + 2) % 3]}, {1, 0, 0}});
    }
    samples.push_back({t, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
  }
  return samples;
}

Vec3 blend(const std::vector<Vec3>& values, const Sample& sample) {
  Vec3 sum{0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) sum = sum + sample.weights[i] * values[sample.corners[i]];
  return sum;
}

}  // namespace

std::vector<Vec3> tighten(const TemplateCage& cage, const std::vector<Vec3>& rest, const TriangleMesh& hull,
                          const TightenOptions& options, const std::function<bool(double)>& step) {
  const Surface surface(hull);
  const std::vector<Vec3> hullNormals = vertexNormals(hull);
  const std::vector<Sample> samples = samplesOf(cage.mesh);
  ThinPlate plate(cage.mesh, bendingOf(cage.neighbours));
  TriangleMesh current{rest, cage.mesh.triangles};
  std::vector<Vec3> points(samples.size());
  for (int round = 0; round < kTightenRounds; ++round) {
    const double share = static_cast<double>(round) / (kTightenRounds - 1);
    if (!step(share)) return {};
    const double reach = options.reach * cage.diagonal * std::pow(3.0, -share);
    for (std::size_t i = 0; i < samples.size(); ++i) points[i] = blend(current.positions, samples[i]);
    const std::vector<SurfacePoint> closest = surface.closest(points);
    const std::vector<Vec3> normals = vertexNormals(current);
    std::vector<PlaneTerm> planes;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (closest[i].distance > reach) continue;
      const Triangle3& t = hull.triangles[closest[i].triangle];
      Vec3 normal{0, 0, 0};
      for (std::size_t k = 0; k < 3; ++k) normal = normal + closest[i].weights[k] * hullNormals[t[k]];
      const Vec3 own = blend(normals, samples[i]);
      const double size = length(normal), ownSize = length(own);
      if (!(dot(normal, own) > kMinAgreement * size * ownSize)) continue;
      planes.push_back({samples[i].corners, samples[i].weights, closest[i].position, 1 / size * normal, 1});
    }
    const double bending = options.stiffest * std::pow(options.softest / options.stiffest, share);
    current.positions = plate.solve(rest, planes, {bending, options.sliding, kMinHold});
    if (current.positions.empty()) current.positions = rest;
  }
  return current.positions;
}

}  // namespace cagecast::cages
