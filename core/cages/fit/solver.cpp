#include "fit/solver.hpp"

#include <Eigen/SparseCholesky>

namespace cagecast::cages {

using Matrix = Eigen::SparseMatrix<double>;
using Entry = Eigen::Triplet<double>;

struct Solver::System {
  const TemplateCage* cage = nullptr;
  Matrix bending;  ///< L^T L for three coordinates, with entries for all that a triangle couples.
  Eigen::SimplicialLDLT<Matrix> factors;
  bool analysed = false;
};

namespace {

/// So that the system is never singular, whatever the planes.
constexpr double kMinHold = 1e-6;

int row(std::uint32_t vertex, int axis) { return 3 * static_cast<int>(vertex) + axis; }

}  // namespace

Solver::Solver(const TemplateCage& cage) : system_(std::make_unique<System>()) {
  system_->cage = &cage;
  const int count = 3 * static_cast<int>(cage.mesh.positions.size());
  std::vector<Entry> entries;
  for (std::uint32_t v = 0; v < cage.neighbours.size(); ++v) {
    const auto& around = cage.neighbours[v];
    for (int axis = 0; axis < 3; ++axis) {
      entries.emplace_back(row(v, axis), row(v, axis), -1.0);
      for (const std::uint32_t u : around)
        entries.emplace_back(row(v, axis), row(u, axis), 1.0 / static_cast<double>(around.size()));
    }
  }
  Matrix laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  system_->bending = Matrix(laplacian.transpose()) * laplacian;
}

Solver::~Solver() = default;

std::vector<Vec3> Solver::solve(const std::vector<Vec3>& rest, const std::vector<PlaneTerm>& planes,
                                const Weights& weights) {
  const TemplateCage& cage = *system_->cage;
  TriangleMesh shape{rest, cage.mesh.triangles};
  const std::vector<Vec3> normals = vertexNormals(shape);
  const int count = 3 * static_cast<int>(rest.size());
  std::vector<Entry> entries;
  entries.reserve(9 * rest.size() + 81 * (planes.size() + cage.mesh.triangles.size()));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    const double n[3] = {normals[v].x, normals[v].y, normals[v].z};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        entries.emplace_back(row(v, a), row(v, b),
                             (a == b ? weights.sliding + kMinHold : 0.0) - weights.sliding * n[a] * n[b]);
  }
  // One block for each pair of corners, empty or not, so that the pattern of the matrix never changes.
  for (const Triangle3& t : cage.mesh.triangles)
    for (const std::uint32_t u : t)
      for (const std::uint32_t v : t)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) entries.emplace_back(row(u, a), row(v, b), 0.0);
  for (const PlaneTerm& plane : planes) {
    const double n[3] = {plane.normal.x, plane.normal.y, plane.normal.z};
    Vec3 at{0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i) at = at + plane.weights[i] * rest[plane.corners[i]];
    const double height = dot(plane.normal, plane.point - at);
    for (std::size_t i = 0; i < 3; ++i) {
      if (plane.weights[i] == 0) continue;
      const double share = plane.strength * plane.weights[i];
      for (int a = 0; a < 3; ++a) right[row(plane.corners[i], a)] += share * n[a] * height;
      for (std::size_t j = 0; j < 3; ++j)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            entries.emplace_back(row(plane.corners[i], a), row(plane.corners[j], b),
                                 share * plane.weights[j] * n[a] * n[b]);
    }
  }
  Matrix matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix += weights.bending * system_->bending;
  if (!system_->analysed) system_->factors.analyzePattern(matrix);
  system_->analysed = true;
  system_->factors.factorize(matrix);
  if (system_->factors.info() != Eigen::Success) return rest;
  const Eigen::VectorXd moved = system_->factors.solve(right);
  std::vector<Vec3> out = rest;
  for (std::uint32_t v = 0; v < rest.size(); ++v)
    out[v] = out[v] + Vec3{moved[row(v, 0)], moved[row(v, 1)], moved[row(v, 2)]};
  return out;
}

}  // namespace cagecast::cages
