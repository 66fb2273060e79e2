#include "refine/bend.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cagecast::cages {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

constexpr int kBendSteps = 12;
/// Factor by which a step shrinks the robust scale: faster, as the cage lies about right already.
constexpr double kBendTightening = 0.6;
/// A step that moves no vertex by more than this share of the diagonal is the last one.
constexpr double kBendSettled = 1e-4;
/// The cage may be bent in waves of this length, as a share of the diagonal: a limb, but not a nose.
constexpr double kWave = 0.3;
/// Resistance to motion as such, as a share of the weight of the gaps: holds what no gap says anything about.
constexpr double kHold = 1e-4;
/// Resistance to the motion of a single step: without it, steps along the surface feed each other.
constexpr double kDamping = 1e-2;
/// Cotangents beyond this belong to slivers, whose stiffness would spoil that of their neighbours.
constexpr double kMaxCotangent = 5;
/// Cells around vertices count as at least this share of the mean one, for the same reason.
constexpr double kMinCell = 0.1;

/// The first of a vertex's three rows. Eigen's sparse matrices count by int.
int row(std::uint32_t vertex) { return 3 * static_cast<int>(vertex); }

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle3& t : mesh.triangles) area += 0.5 * length(areaNormal(mesh, t));
  return area;
}

/// Bending energy per coordinate: the square of the Laplacian by cotangents, integrated over the mesh.
SparseMatrix bendingOf(const TriangleMesh& mesh) {
  const auto count = static_cast<Eigen::Index>(mesh.positions.size());
  std::vector<Triplet> entries;
  Eigen::VectorXd cells = Eigen::VectorXd::Zero(count);
  for (const Triangle3& t : mesh.triangles) {
    const double twiceArea = length(areaNormal(mesh, t));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t apex = t[i], from = t[(i + 1) % 3], to = t[(i + 2) % 3];
      const double cotangent =
          dot(mesh.positions[from] - mesh.positions[apex], mesh.positions[to] - mesh.positions[apex]) / twiceArea;
      const double weight = 0.5 * std::clamp(cotangent, -kMaxCotangent, kMaxCotangent);
      const auto a = static_cast<int>(from), b = static_cast<int>(to);
      entries.insert(entries.end(), {{a, b, -weight}, {b, a, -weight}, {a, a, weight}, {b, b, weight}});
      cells(static_cast<Eigen::Index>(apex)) += twiceArea / 6;
    }
  }
  SparseMatrix laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const double least = kMinCell * cells.sum() / static_cast<double>(count);
  const Eigen::VectorXd inverse = cells.cwiseMax(least).cwiseInverse();
  return laplacian.transpose() * inverse.asDiagonal() * laplacian;
}

/// What holds against the gaps: three rows per vertex.
SparseMatrix stiffnessOf(const TriangleMesh& cage, double diagonal) {
  const auto count = static_cast<Eigen::Index>(cage.positions.size());
  const SparseMatrix bending = bendingOf(cage);
  const double length = kWave * diagonal / (2 * std::numbers::pi);  // For waves of this length, both sides are equal.
  const double stiffness = std::pow(length, 4);
  const double hold = kHold * areaOf(cage) / static_cast<double>(count);
  std::vector<Triplet> entries;
  for (int column = 0; column < count; ++column) {
    for (int k = 0; k < 3; ++k) entries.emplace_back(3 * column + k, 3 * column + k, hold);
    for (SparseMatrix::InnerIterator it(bending, column); it; ++it)
      for (int k = 0; k < 3; ++k)
        entries.emplace_back(3 * static_cast<int>(it.row()) + k, 3 * column + k, stiffness * it.value());
  }
  SparseMatrix matrix(3 * count, 3 * count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

class Bending {
 public:
  Bending(const Target& target, std::span<const CageSpot> spots, const TriangleMesh& cage)
      : spots_(spots),
        start_(cage.positions),
        stiffness_(stiffnessOf(cage, target.diagonal)),
        area_(areaOf(cage)),
        share_(area_ / static_cast<double>(spots.size())),
        moved_(Eigen::VectorXd::Zero(stiffness_.rows())) {}

  /// @return The most that a coordinate moved; 0 if there is no solution.
  double step(std::span<const Gap> gaps, const RobustScale& scale, double offset, TriangleMesh& cage) {
    std::vector<Triplet> entries;
    entries.reserve(81 * gaps.size());
    Eigen::VectorXd right = Eigen::VectorXd::Zero(stiffness_.rows());
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const double weight = gaps[i].facing ? share_ * scale.weight(gaps[i].size - offset) : 0;
      const Vec3& direction = gaps[i].direction;
      const double along[3] = {direction.x, direction.y, direction.z};
      double factors[9];
      int rows[9];
      double wanted = offset - gaps[i].size;
      for (std::size_t j = 0; j < 9; ++j) {
        factors[j] = spots_[i].weights[j / 3] * along[j % 3];
        rows[j] = row(cage.triangles[spots_[i].triangle][j / 3]) + static_cast<int>(j % 3);
        wanted += factors[j] * moved_(rows[j]);
      }
      for (std::size_t j = 0; j < 9; ++j) {
        right(rows[j]) += weight * factors[j] * wanted;
        for (std::size_t k = 0; k < 9; ++k) entries.emplace_back(rows[j], rows[k], weight * factors[j] * factors[k]);
      }
    }
    SparseMatrix matrix(stiffness_.rows(), stiffness_.cols());
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix += stiffness_;
    const double damping = kDamping * area_ / static_cast<double>(start_.size());
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += damping;
    right += damping * moved_;
    if (!analysed_) solver_.analyzePattern(matrix);  // It stays: gaps without weight are entered, too.
    analysed_ = true;
    solver_.factorize(matrix);
    if (solver_.info() != Eigen::Success) return 0;
    const Eigen::VectorXd moved = solver_.solve(right);
    if (!moved.allFinite()) return 0;
    const double change = (moved - moved_).cwiseAbs().maxCoeff();
    moved_ = moved;
    for (std::uint32_t v = 0; v < start_.size(); ++v)
      cage.positions[v] = start_[v] + Vec3{moved(row(v)), moved(row(v) + 1), moved(row(v) + 2)};
    return change;
  }

  /// Moves the corners of triangles that were turned over, which are slivers, all the same way.
  void unfold(TriangleMesh& cage) const {
    constexpr int kUnfoldRounds = 30;
    const TriangleMesh before{start_, cage.triangles};
    bool isFolded = true;
    for (int round = 0; round < kUnfoldRounds && isFolded; ++round) {
      isFolded = false;
      for (const Triangle3& t : cage.triangles) {
        if (dot(areaNormal(cage, t), areaNormal(before, t)) > 0) continue;
        isFolded = true;
        Vec3 way{0, 0, 0};
        for (const std::uint32_t v : t) way = way + 1.0 / 3 * (cage.positions[v] - start_[v]);
        for (const std::uint32_t v : t) cage.positions[v] = start_[v] + way;
      }
    }
  }

 private:
  std::span<const CageSpot> spots_;
  std::vector<Vec3> start_;
  SparseMatrix stiffness_;
  double area_;
  double share_;  ///< Of the cage's area that a spot stands for.
  Eigen::VectorXd moved_;
  Eigen::SimplicialLDLT<SparseMatrix> solver_;
  bool analysed_ = false;
};

}  // namespace

bool bendCage(const Target& target, std::span<const CageSpot> spots, double reach, const Progress& progress,
              TriangleMesh& cage) {
  Bending bending(target, spots, cage);
  RobustScale scale(reach * target.diagonal, target.diagonal);
  double least = INFINITY;
  std::vector<Vec3> best = cage.positions;
  for (int step = 0; step < kBendSteps; ++step) {
    if (progress && !progress(static_cast<float>(step) / kBendSteps, "bend")) return false;
    const std::vector<Gap> gaps = measureGaps(target, cage, spots);
    const Placement placement = placementOf(target, gaps);
    scale.tighten(placement.spread, kBendTightening);
    if (placement.unevenness < least) {
      least = placement.unevenness;
      best = cage.positions;
    } else if (scale.settled()) {
      break;
    }
    if (bending.step(gaps, scale, placement.offset, cage) < kBendSettled * target.diagonal) break;
  }
  cage.positions = best;
  bending.unfold(cage);
  return true;
}

}  // namespace cagecast::cages
