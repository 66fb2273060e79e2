// Tried and left out: trimming at a fixed distance, which lets the long flanks of a car outvote its front and back;
// growth in every case, which around a ball, or for a cage that is bent, trades the offset for size.
#include "refine/steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "linear/dense.hpp"
#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

constexpr int kAlignSteps = 60;
/// Factor by which a step shrinks the robust scale: slowly, so that gaps far from the usual one count at first.
constexpr double kAlignTightening = 0.8;
/// A step that moves the cage by less than this, as a share of the diagonal, may be the last one.
constexpr double kAlignSettled = 2e-5;
/// Resistance to motions that hardly change the gaps, such as turning a ball, as a share of the weight of all spots.
constexpr double kResistance = 5e-4;

Vec3 rotated(const Vec3& p, const Vec3& turn) {
  const double angle = length(turn);
  if (!(angle > 0)) return p;
  const Vec3 axis = 1 / angle * turn;
  return std::cos(angle) * p + std::sin(angle) * cross(axis, p) + (1 - std::cos(angle)) * dot(axis, p) * axis;
}

/// Iterative closest points, point to plane (Chen and Medioni, 1992), with the usual gap as one more unknown.
class Alignment {
 public:
  Alignment(const TriangleMesh& cage, std::span<const Gap> gaps, double offset, Growth growth)
      : growth_(growth), offset_(offset) {
    for (const Gap& gap : gaps) centre_ = centre_ + 1 / static_cast<double>(gaps.size()) * gap.spot;
    double squares = 0;
    for (const Gap& gap : gaps) squares += dot(gap.spot - centre_, gap.spot - centre_);
    radius_ = std::sqrt(squares / static_cast<double>(gaps.size()));
    if (!(radius_ > 0)) radius_ = diagonalOf(cage);
  }

  /// @return The length of the step; infinite if no gap says anything.
  double step(std::span<const Gap> gaps, const RobustScale& scale, TriangleMesh& cage) {
    std::vector<double> matrix(kUnknowns * kUnknowns), right(kUnknowns);
    double weights = 0;
    for (const Gap& gap : gaps) {
      if (!gap.facing) continue;
      const double residual = gap.size - offset_;
      const double weight = scale.weight(residual);
      const Vec3 arm = 1 / radius_ * (gap.spot - centre_);
      const Vec3 lever = cross(arm, gap.direction);
      const double growth = growth_ == Growth::none ? 0 : dot(arm, gap.direction);
      const double row[kUnknowns] = {gap.direction.x, gap.direction.y, gap.direction.z, lever.x,
                                     lever.y,         lever.z,         growth,          -1};
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        for (std::size_t k = 0; k < kUnknowns; ++k) matrix[kUnknowns * i + k] += weight * row[i] * row[k];
        right[i] -= weight * residual * row[i];
      }
      weights += weight;
    }
    if (!(weights > 0)) return INFINITY;
    for (std::size_t i = 0; i < kOffset; ++i) {
      matrix[(kUnknowns + 1) * i] += kResistance * weights;
      right[i] -= kResistance * weights * total_[i];
    }
    const std::vector<double> x = solveDense(std::move(matrix), std::move(right), kUnknowns);
    if (!std::all_of(x.begin(), x.end(), [](double part) { return std::isfinite(part); })) return INFINITY;
    for (std::size_t i = 0; i < kOffset; ++i) total_[i] += x[i];
    offset_ += x[kOffset];
    const Vec3 move{x[0], x[1], x[2]};
    const Vec3 turn = 1 / radius_ * Vec3{x[3], x[4], x[5]};
    const double factor = 1 + x[kGrowth] / radius_;
    for (Vec3& p : cage.positions) p = centre_ + move + factor * rotated(p - centre_, turn);
    centre_ = centre_ + move;
    return std::sqrt(std::inner_product(x.begin(), x.begin() + kOffset, x.begin(), 0.0));
  }

 private:
  /// Move, turn and growth times the radius, and the offset: all are lengths.
  static constexpr std::size_t kGrowth = 6, kOffset = 7, kUnknowns = 8;

  Growth growth_;
  double offset_;
  Vec3 centre_{};
  double radius_ = 0;  ///< Of gyration: turns and growth are measured in the length that they move a spot by.
  std::array<double, kOffset> total_{};  ///< Since the start, but for the offset.
};

}  // namespace

bool alignCage(const Target& target, const std::vector<SurfaceSample>& spots, const AlignLimits& limits,
               const Progress& progress, TriangleMesh& cage) {
  std::vector<Gap> gaps = measureGaps(target, cage, spots);
  Placement placement = placementOf(target, gaps);
  Alignment alignment(cage, gaps, placement.offset, limits.growth);
  RobustScale scale(limits.reach * target.diagonal, target.diagonal);
  for (int step = 0; step < kAlignSteps; ++step) {
    if (!report(progress, step / static_cast<double>(kAlignSteps), "align")) return false;
    scale.tighten(placement.spread, kAlignTightening);
    const double moved = alignment.step(gaps, scale, cage);
    if (std::isinf(moved) || (moved < kAlignSettled * target.diagonal && scale.settled())) break;
    gaps = measureGaps(target, cage, spots);
    placement = placementOf(target, gaps);
  }
  return true;
}

}  // namespace cagecast::cages
