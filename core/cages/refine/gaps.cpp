#include "refine/steps.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast::cages {

namespace {

/// Cosine of the largest angle between the normals of cage and target at which they count as facing the same way: 73
/// degrees, because a coarse cage cuts corners.
constexpr double kGapFacing = 0.3;
/// Spots closer to the target than this share of the diagonal lie on it: there, the gap grows along the normal.
constexpr double kTouching = 1e-7;
/// How far inside the target a spot counts as sunk, as a share of the diagonal: `pokeThrough` of the transfer.
constexpr double kSunk = 0.0025;
/// The most that one gap adds to the unevenness, as a share of the diagonal. Gaps of spots that do not face the target
/// add all of it.
constexpr double kMaxDifference = 0.03;
/// The robust scale does not shrink below this multiple of the spread of the gaps,
constexpr double kSpreads = 1.5;
/// nor below this share of the diagonal, where the cage's own coarseness begins.
constexpr double kFinestScale = 1e-3;

}  // namespace

Target::Target(const TriangleMesh& mesh) : surface(mesh), diagonal(diagonalOf(mesh)) {
  normals.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) normals.push_back(unit(areaNormal(mesh, t)));
}

std::vector<Gap> measureGaps(const Target& target, const TriangleMesh& cage, const std::vector<SurfaceSample>& spots) {
  const std::vector<Vec3> points = positionsOf(cage, spots);
  const std::vector<SurfacePoint> nearest = target.surface.closest(points);
  std::vector<Gap> gaps(spots.size());
  for (std::size_t i = 0; i < spots.size(); ++i) {
    Gap& gap = gaps[i];
    gap.spot = points[i];
    const Vec3 outward = areaNormal(cage, cage.triangles[spots[i].triangle]);
    const Vec3& normal = target.normals[nearest[i].triangle];
    gap.facing = dot(outward, normal) > kGapFacing * length(outward);
    const Vec3 across = points[i] - nearest[i].position;
    const double distance = length(across);
    const double sign = dot(across, outward) < 0 ? -1 : 1;
    gap.size = sign * distance;
    gap.direction = distance > kTouching * target.diagonal ? sign / distance * across : normal;
  }
  return gaps;
}

Placement placementOf(const Target& target, std::span<const Gap> gaps) {
  Placement result;
  if (gaps.empty()) return result;
  const auto count = static_cast<double>(gaps.size());
  std::vector<double> sizes;
  for (const Gap& gap : gaps) {
    if (!gap.facing) continue;
    sizes.push_back(gap.size);
    if (gap.size < -kSunk * target.diagonal) result.sunk += 1 / count;
  }
  result.facing = static_cast<double>(sizes.size()) / count;
  result.offset = medianOf(sizes);
  const double most = kMaxDifference * target.diagonal;
  result.unevenness = (1 - result.facing) * most;
  for (double& size : sizes) {
    size = std::abs(size - result.offset);
    result.unevenness += std::min(size, most) / count;
  }
  constexpr double kNormal = 1.4826;  // From the median deviation to the standard deviation of a normal distribution.
  result.spread = kNormal * medianOf(std::move(sizes));
  return result;
}

RobustScale::RobustScale(double start, double diagonal) : scale_(start), finest_(kFinestScale * diagonal) {}

void RobustScale::tighten(double spread, double factor) {
  const double wanted = std::max(kSpreads * spread, finest_);
  settled_ = wanted >= factor * scale_;
  scale_ = std::min(scale_, std::max(factor * scale_, wanted));
}

double RobustScale::weight(double residual) const noexcept {
  const double closeness = 1 / (1 + residual * residual / (scale_ * scale_));
  return closeness * closeness;
}

}  // namespace cagecast::cages
