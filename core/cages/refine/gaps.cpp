#include "refine/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/hilbert.hpp"
#include "mesh/bounds.hpp"

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

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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

std::vector<CageSpot> spreadSpots(const TriangleMesh& cage, std::size_t count) {
  double total = 0;
  for (const Triangle3& t : cage.triangles) total += length(areaNormal(cage, t));
  // Fractions of the plastic number: successive points of a square that never crowd (Roberts, 2018).
  constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;
  std::vector<CageSpot> spots;
  double due = 0, u = 0.5, v = 0.5;
  for (const std::uint32_t t : orderOf(cage)) {
    due += static_cast<double>(count) * length(areaNormal(cage, cage.triangles[t])) / total;
    for (; due >= 0.5; due -= 1) {
      u = std::fmod(u + kStepU, 1.0);
      v = std::fmod(v + kStepV, 1.0);
      const bool upper = u + v > 1;  // The other half of the square is folded onto the triangle.
      const double b = upper ? 1 - u : u, c = upper ? 1 - v : v;
      spots.push_back({t, {1 - b - c, b, c}});
    }
  }
  return spots;
}

Target::Target(const TriangleMesh& mesh) : surface(mesh), diagonal(diagonalOf(mesh)) {
  normals.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) {
    const Vec3 normal = areaNormal(mesh, t);
    normals.push_back(1 / length(normal) * normal);
  }
}

std::vector<Gap> measureGaps(const Target& target, const TriangleMesh& cage, std::span<const CageSpot> spots) {
  std::vector<Vec3> points;
  points.reserve(spots.size());
  for (const CageSpot& spot : spots) {
    const Triangle3& t = cage.triangles[spot.triangle];
    points.push_back(spot.weights[0] * cage.positions[t[0]] + spot.weights[1] * cage.positions[t[1]] +
                     spot.weights[2] * cage.positions[t[2]]);
  }
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
