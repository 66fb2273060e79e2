#include "mesh/thin_plate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cagecast::cages {

namespace {

/// Calls `visit(a, b)` for each pair of coordinates.
template <typename Visit>
void forEachPair(Visit visit) {
  for (std::uint32_t a = 0; a < 3; ++a)
    for (std::uint32_t b = 0; b < 3; ++b) visit(a, b);
}

/// The coordinates that bending and planes couple.
std::vector<SparseEntry> couplingOf(const TriangleMesh& mesh, const std::vector<SparseEntry>& bending) {
  std::vector<SparseEntry> entries;
  for (const SparseEntry& entry : bending)
    for (std::uint32_t a = 0; a < 3; ++a) entries.push_back({3 * entry.row + a, 3 * entry.column + a});
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t u : t)
      for (const std::uint32_t v : t)
        forEachPair([&](std::uint32_t a, std::uint32_t b) { entries.push_back({3 * u + a, 3 * v + b}); });
  return entries;
}

}  // namespace

ThinPlate::ThinPlate(const TriangleMesh& mesh, std::vector<SparseEntry> bending)
    : triangles_(mesh.triangles),
      bending_(std::move(bending)),
      system_(3 * mesh.positions.size(), couplingOf(mesh, bending_)) {}

std::vector<Vec3> ThinPlate::solve(const std::vector<Vec3>& rest, std::span<const PlaneTerm> planes,
                                   const Weights& weights, std::span<const Vec3> before, const StepCallback& step) {
  const std::vector<Vec3> normals = vertexNormals({rest, triangles_});
  std::vector<double> right(3 * rest.size());
  system_.clear();
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    const double n[3] = {normals[v].x, normals[v].y, normals[v].z};
    const double each = weights.sliding + weights.hold + weights.damping;
    forEachPair([&](std::uint32_t a, std::uint32_t b) {
      system_.add(3 * v + a, 3 * v + b, (a == b ? each : 0.0) - weights.sliding * n[a] * n[b]);
    });
    const Vec3 pull = before.empty() ? Vec3{0, 0, 0} : weights.damping * (before[v] - rest[v]);
    right[3 * v] = pull.x;
    right[3 * v + 1] = pull.y;
    right[3 * v + 2] = pull.z;
  }
  for (const PlaneTerm& plane : planes) {
    const double n[3] = {plane.normal.x, plane.normal.y, plane.normal.z};
    const double height = dot(plane.normal, plane.point - blend(rest, plane.corners, plane.weights));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t row = 3 * plane.corners[i];
      const double share = plane.strength * plane.weights[i];
      for (std::uint32_t a = 0; a < 3; ++a) right[row + a] += share * n[a] * height;
      for (std::size_t j = 0; j < 3; ++j)
        forEachPair([&](std::uint32_t a, std::uint32_t b) {
          system_.add(row + a, 3 * plane.corners[j] + b, share * plane.weights[j] * n[a] * n[b]);
        });
    }
  }
  for (const SparseEntry& entry : bending_)
    for (std::uint32_t a = 0; a < 3; ++a)
      system_.add(3 * entry.row + a, 3 * entry.column + a, weights.bending * entry.value);
  if (!system_.factorize(step)) return {};
  const std::vector<double> moved = system_.solve(right);
  if (!std::all_of(moved.begin(), moved.end(), [](double x) { return std::isfinite(x); })) return {};
  std::vector<Vec3> out = rest;
  for (std::size_t v = 0; v < rest.size(); ++v)
    out[v] = out[v] + Vec3{moved[3 * v], moved[3 * v + 1], moved[3 * v + 2]};
  return out;
}

}  // namespace cagecast::cages
