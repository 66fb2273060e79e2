#pragma once

#include <span>
#include <vector>

#include "geometry/vec3.hpp"

namespace cagecast::cages {

struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< Images of the axes.
  Vec3 translation{0, 0, 0};

  /// The image of a direction.
  [[nodiscard]] Vec3 turned(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turned(p) + translation; }
};

/// A rotation, a scale and a translation.
struct Similarity : Affine {
  double scale = 1;  ///< The length of the images of the axes.

  [[nodiscard]] Vec3 inverse(const Vec3& p) const {
    const Vec3 d = 1 / (scale * scale) * (p - translation);
    return {dot(d, x), dot(d, y), dot(d, z)};
  }
};

/// The similarity that carries `from` closest to `to` in the mean square by unit quaternions (Horn 1987);
/// never a mirror image.
/// @param weights  One per point, or none.
Similarity fitSimilarity(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights = {});

/// The rotation by the smallest angle that turns one direction into another; both of unit length.
Similarity shortestRotation(const Vec3& from, const Vec3& to);

/// A pair of points that a map should carry onto each other, and how far it may stay off.
struct Anchor {
  Vec3 from, to;
  double slack = 0;  ///< 0 is reached exactly.
};

/// A smooth map of space that carries points onto others. At each place it is a similarity of the points around
/// (moving least squares: Schaefer, McPhail, Warren 2006), so that what is narrower is lower, too; what that leaves is
/// interpolated by an affine map and a spline.
class Warp {
 public:
  /// @param anchors  At least one; no two equal ones in `from`.
  /// @param size  The size of the model.
  Warp(std::span<const Anchor> anchors, double size);

  [[nodiscard]] Vec3 operator()(const Vec3& p) const;

 private:
  [[nodiscard]] Vec3 locally(const Vec3& p) const;

  std::vector<Vec3> from_, to_;
  std::vector<Vec3> centres_, weights_;  ///< Of the spline.
  Vec3 middle_{}, translation_{};
  Vec3 x_{}, y_{}, z_{};
  double size_ = 1;
};

}  // namespace cagecast::cages
