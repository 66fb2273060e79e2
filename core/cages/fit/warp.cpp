#include "fit/warp.hpp"

#include <cmath>

#include "linear/dense.hpp"
#include "mesh/triangle_mesh.hpp"

/// Tried for the spline, mean of the median errors of six heads with 23 landmarks: r 1.06, sqrt(r^2 + .03^2) 1.01,
/// r^1.5 1.03, r^2 log r 1.03, r^3 1.14; a stiff spline that does not reach its points 1.1 to 1.3. Similarities at
/// each place below it: 0.02 less; with weights that fall faster the worst get worse.
namespace cagecast::cages {

namespace {

/// Resistance of the affine part to everything but a translation: few landmarks say little about it.
constexpr double kAffineRidge = 0.05;
/// Distance, as a share of the size, within which the spline has no kink at a point.
constexpr double kKernelRounding = 0.025;
/// Distance, as a share of the size, below which points count alike in the similarity of a place.
constexpr double kNear = 0.03;

/// A multiquadric, negated: conditionally positive definite, so that the system has one solution.
double kernel(double distance) { return -std::sqrt(distance * distance + kKernelRounding * kKernelRounding); }

/// The rotation of a quaternion, of any length above 0: a number, and x, y, z.
Similarity rotationOf(double w, const Vec3& v) {
  const double s = 2 / (w * w + dot(v, v));
  const double xx = s * v.x * v.x, yy = s * v.y * v.y, zz = s * v.z * v.z;
  const double xy = s * v.x * v.y, xz = s * v.x * v.z, yz = s * v.y * v.z;
  const double wx = s * w * v.x, wy = s * w * v.y, wz = s * w * v.z;
  return {{{1 - yy - zz, xy + wz, xz - wy}, {xy - wz, 1 - xx - zz, yz + wx}, {xz + wy, yz - wx, 1 - xx - yy}}};
}

Vec3 weightedMean(std::span<const Vec3> points, std::span<const double> weights) {
  if (weights.empty()) return meanOf(points);
  Vec3 sum{0, 0, 0};
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum = sum + weights[i] * points[i];
    total += weights[i];
  }
  return 1 / total * sum;
}

}  // namespace

Similarity fitSimilarity(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  const Vec3 fromMean = weightedMean(from, weights), toMean = weightedMean(to, weights);
  SquareMatrix<3> sums{};  // Of products of coordinates: before by after.
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 a = from[i] - fromMean, b = to[i] - toMean;
    const double weight = weights.empty() ? 1 : weights[i];
    const double before[] = {a.x, a.y, a.z}, after[] = {b.x, b.y, b.z};
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) sums[j][k] += weight * before[j] * after[k];
    spread += weight * dot(a, a);
  }
  const auto& [x, y, z] = sums;
  const auto best = eigenpairsOf<4>({{{x[0] + y[1] + z[2], y[2] - z[1], z[0] - x[2], x[1] - y[0]},
                                      {y[2] - z[1], x[0] - y[1] - z[2], x[1] + y[0], z[0] + x[2]},
                                      {z[0] - x[2], x[1] + y[0], y[1] - x[0] - z[2], y[2] + z[1]},
                                      {x[1] - y[0], z[0] + x[2], y[2] + z[1], z[2] - x[0] - y[1]}}})[3];
  const auto& [w, i, j, k] = best.vector;
  Similarity out = rotationOf(w, {i, j, k});
  const double scale = spread > 0 ? best.value / spread : 1;
  out.scale = scale > 0 ? scale : 1;
  for (Vec3* axis : {&out.x, &out.y, &out.z}) *axis = out.scale * *axis;
  out.translation = toMean - out.turned(fromMean);
  return out;
}

Similarity shortestRotation(const Vec3& from, const Vec3& to) {
  constexpr double kOpposite = 1e-10;
  const double cosine = dot(from, to);
  if (cosine > -1 + kOpposite) return rotationOf(1 + cosine, cross(from, to));
  return rotationOf(0, cross(from, std::abs(from.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));  // Half a turn.
}

Warp::Warp(std::span<const Anchor> anchors, double size) : size_(size) {
  for (const Anchor& anchor : anchors) {
    from_.push_back(anchor.from);
    to_.push_back(anchor.to);
  }
  for (const Vec3& p : from_) centres_.push_back(locally(p));
  middle_ = meanOf(centres_);
  const std::size_t n = anchors.size(), rows = n + 4;
  std::vector<double> matrix(rows * rows), right(3 * rows);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = centres_[i], q = 1 / size * (p - middle_), move = to_[i] - p;
    for (std::size_t j = 0; j < n; ++j) matrix[i * rows + j] = kernel(length(p - centres_[j]) / size);
    matrix[i * rows + i] += anchors[i].slack;
    const double affine[4] = {1, q.x, q.y, q.z};
    for (std::size_t k = 0; k < 4; ++k) matrix[i * rows + n + k] = matrix[(n + k) * rows + i] = affine[k];
    std::copy_n(std::begin({move.x, move.y, move.z}), 3, &right[3 * i]);
  }
  for (std::size_t k = 1; k < 4; ++k) matrix[(n + k) * rows + n + k] = -kAffineRidge * static_cast<double>(n);
  const std::vector<double> solution = solveDense(std::move(matrix), std::move(right), rows);
  const auto row = [&](std::size_t i) { return Vec3{solution[3 * i], solution[3 * i + 1], solution[3 * i + 2]}; };
  for (std::size_t i = 0; i < n; ++i) weights_.push_back(row(i));
  translation_ = row(n);
  x_ = 1 / size * row(n + 1);
  y_ = 1 / size * row(n + 2);
  z_ = 1 / size * row(n + 3);
}

Vec3 Warp::locally(const Vec3& p) const {
  std::vector<double> weights;
  for (const Vec3& q : from_) {
    const double distance = length(p - q) / size_;
    weights.push_back(1 / std::sqrt(distance * distance + kNear * kNear));
  }
  return fitSimilarity(from_, to_, weights)(p);
}

Vec3 Warp::operator()(const Vec3& point) const {
  const Vec3 p = locally(point);
  const Vec3 q = p - middle_;
  Vec3 moved = p + translation_ + q.x * x_ + q.y * y_ + q.z * z_;
  for (std::size_t i = 0; i < centres_.size(); ++i)
    moved = moved + kernel(length(p - centres_[i]) / size_) * weights_[i];
  return moved;
}

}  // namespace cagecast::cages
