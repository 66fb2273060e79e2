#include "mesh/samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/hilbert.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

/// Triangles in the order of a Hilbert curve through their centres.
std::vector<std::uint32_t> orderOf(const TriangleMesh& mesh) {
  const Bounds bounds = boundsOf(mesh);
  constexpr int kLevels = 8;
  const double size = std::max({bounds.size().x, bounds.size().y, bounds.size().z});
  const double cells = size > 0 ? ((1 << kLevels) - 1) / size : 0;
  const HilbertCurve curve(kLevels);
  std::vector<std::uint32_t> keys;
  for (const Triangle3& t : mesh.triangles) {
    const Vec3 p = centroid(mesh, t) - bounds.low;
    const auto cell = [&](double x) { return static_cast<std::uint32_t>(cells * x); };
    keys.push_back(curve.key(cell(p.x), cell(p.y), cell(p.z)));
  }
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  return order;
}

}  // namespace

std::vector<SurfaceSample> spreadSamples(const TriangleMesh& mesh, std::size_t count) {
  const double total = areaOf(mesh);
  // Fractions of the plastic number: successive points of a square that never crowd (Roberts 2018).
  constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;
  std::vector<SurfaceSample> samples;
  double due = 0, u = 0.5, v = 0.5;
  for (const std::uint32_t t : orderOf(mesh)) {
    due += static_cast<double>(count) * areaOf(mesh, mesh.triangles[t]) / total;
    for (; due >= 0.5; due -= 1) {
      u = std::fmod(u + kStepU, 1.0);
      v = std::fmod(v + kStepV, 1.0);
      const bool upper = u + v > 1;  // The other half of the square is folded onto the triangle.
      const double b = upper ? 1 - u : u, c = upper ? 1 - v : v;
      samples.push_back({t, {1 - b - c, b, c}});
    }
  }
  return samples;
}

std::vector<Vec3> positionsOf(const TriangleMesh& mesh, const std::vector<SurfaceSample>& samples) {
  std::vector<Vec3> points;
  points.reserve(samples.size());
  for (const auto& [triangle, weights] : samples)
    points.push_back(blend(mesh.positions, mesh.triangles[triangle], weights));
  return points;
}

}  // namespace cagecast::cages
