#include "fit/warp.hpp"

#include <cmath>

#include <Eigen/Dense>

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

Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// A multiquadric, negated: conditionally positive definite, so that the system has one solution.
double kernel(double distance) { return -std::sqrt(distance * distance + kKernelRounding * kKernelRounding); }

Vec3 meanOf(std::span<const Vec3> points, std::span<const double> weights = {}) {
  Vec3 sum{0, 0, 0};
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = weights.empty() ? 1 : weights[i];
    sum = sum + weight * points[i];
    total += weight;
  }
  return 1 / total * sum;
}

}  // namespace

Similarity fitSimilarity(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  const Vec3 fromMean = meanOf(from, weights), toMean = meanOf(to, weights);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d a = eigen(from[i] - fromMean), b = eigen(to[i] - toMean);
    const double weight = weights.empty() ? 1 : weights[i];
    covariance += weight * b * a.transpose();
    spread += weight * a.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool mirrored = svd.matrixU().determinant() * svd.matrixV().determinant() < 0;
  const Eigen::Vector3d signs(1, 1, mirrored ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  Similarity out;
  const double scale = spread > 0 ? svd.singularValues().dot(signs) / spread : 1;
  out.scale = scale > 0 ? scale : 1;
  out.x = vec3(out.scale * rotation.col(0));
  out.y = vec3(out.scale * rotation.col(1));
  out.z = vec3(out.scale * rotation.col(2));
  out.translation = toMean - out.turned(fromMean);
  return out;
}

Similarity shortestRotation(const Vec3& from, const Vec3& to) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(eigen(from), eigen(to));
  const Eigen::Matrix3d rotation = turn.toRotationMatrix();
  Similarity out;
  out.x = vec3(rotation.col(0));
  out.y = vec3(rotation.col(1));
  out.z = vec3(rotation.col(2));
  return out;
}

Warp::Warp(std::span<const Anchor> anchors, double size) : size_(size) {
  for (const Anchor& anchor : anchors) {
    from_.push_back(anchor.from);
    to_.push_back(anchor.to);
  }
  for (const Vec3& p : from_) centres_.push_back(locally(p));
  middle_ = meanOf(centres_);
  const auto n = static_cast<Eigen::Index>(anchors.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + 4, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = centres_[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n; ++j)
      system(i, j) = kernel(length(p - centres_[static_cast<std::size_t>(j)]) / size);
    system(i, i) += anchors[static_cast<std::size_t>(i)].slack;
    const Vec3 q = 1 / size * (p - middle_);
    const double row[4] = {1, q.x, q.y, q.z};
    for (Eigen::Index k = 0; k < 4; ++k) system(i, n + k) = system(n + k, i) = row[k];
    right.row(i) = eigen(to_[static_cast<std::size_t>(i)] - p).transpose();
  }
  for (Eigen::Index k = 1; k < 4; ++k) system(n + k, n + k) = -kAffineRidge * static_cast<double>(n);
  const Eigen::MatrixXd solution = system.fullPivLu().solve(right);
  for (Eigen::Index i = 0; i < n; ++i) weights_.push_back(vec3(solution.row(i).transpose()));
  translation_ = vec3(solution.row(n).transpose());
  x_ = 1 / size * vec3(solution.row(n + 1).transpose());
  y_ = 1 / size * vec3(solution.row(n + 2).transpose());
  z_ = 1 / size * vec3(solution.row(n + 3).transpose());
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
