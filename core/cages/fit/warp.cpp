#include "fit/warp.hpp"

#include <cmath>

#include <Eigen/Dense>

/// Tried for the spline, mean of the median errors of six heads with 23 landmarks: r 1.06, sqrt(r^2 + .03^2) 1.01,
/// r^1.5 1.03, r^2 log r 1.03, r^3 1.14; a stiff spline that does not reach its points 1.1 to 1.3.
namespace cagecast::cages {

namespace {

/// Resistance of the affine part to everything but a translation: few landmarks say little about it.
constexpr double kAffineRidge = 0.05;
/// Distance, as a share of the size, within which the spline has no kink at a point.
constexpr double kRounding = 0.025;

Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// A multiquadric: conditionally negative definite, so that the system has one solution.
double kernel(double distance) { return -std::sqrt(distance * distance + kRounding * kRounding); }

Vec3 meanOf(std::span<const Vec3> points) {
  Vec3 sum{0, 0, 0};
  for (const Vec3& p : points) sum = sum + p;
  return 1 / static_cast<double>(points.size()) * sum;
}

}  // namespace

Similarity fitSimilarity(std::span<const Vec3> from, std::span<const Vec3> to) {
  const Vec3 fromMean = meanOf(from), toMean = meanOf(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d a = eigen(from[i] - fromMean), b = eigen(to[i] - toMean);
    covariance += b * a.transpose();
    spread += a.squaredNorm();
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

Warp::Warp(std::span<const Vec3> from, std::span<const Vec3> to, double size)
    : centres_(from.begin(), from.end()), weights_(from.size()), middle_(meanOf(from)), size_(size) {
  const auto n = static_cast<Eigen::Index>(from.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + 4, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = from[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) = kernel(length(p - from[static_cast<std::size_t>(j)]) / size);
    const Vec3 q = 1 / size * (p - middle_);
    const double row[4] = {1, q.x, q.y, q.z};
    for (Eigen::Index k = 0; k < 4; ++k) system(i, n + k) = system(n + k, i) = row[k];
    right.row(i) = eigen(to[static_cast<std::size_t>(i)] - p).transpose();
  }
  for (Eigen::Index k = 1; k < 4; ++k) system(n + k, n + k) = -kAffineRidge * static_cast<double>(n);
  const Eigen::MatrixXd solution = system.fullPivLu().solve(right);
  for (Eigen::Index i = 0; i < n; ++i) weights_[static_cast<std::size_t>(i)] = vec3(solution.row(i).transpose());
  translation_ = vec3(solution.row(n).transpose());
  x_ = 1 / size * vec3(solution.row(n + 1).transpose());
  y_ = 1 / size * vec3(solution.row(n + 2).transpose());
  z_ = 1 / size * vec3(solution.row(n + 3).transpose());
}

Vec3 Warp::operator()(const Vec3& p) const {
  const Vec3 q = p - middle_;
  Vec3 moved = p + translation_ + q.x * x_ + q.y * y_ + q.z * z_;
  for (std::size_t i = 0; i < centres_.size(); ++i)
    moved = moved + kernel(length(p - centres_[i]) / size_) * weights_[i];
  return moved;
}

}  // namespace cagecast::cages
