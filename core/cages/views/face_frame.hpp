#pragma once

#include <cmath>

#include "geometry/vec3.hpp"

namespace cagecast::cages {

/// The place and the axes of a face. Its own space has the middle between the eyes as origin, x to its left, y up, z to
/// its front, and the distance of the eyes as unit.
struct FaceFrame {
  Vec3 middle{};
  Vec3 left{1, 0, 0}, up{0, 1, 0}, front{0, 0, 1};
  double size = 1;

  [[nodiscard]] Vec3 toLocal(const Vec3& p) const {
    const Vec3 d = 1 / size * (p - middle);
    return {dot(d, left), dot(d, up), dot(d, front)};
  }
  /// Whether a point may be of the face: about as far to the sides as ears, from the hairline down below the chin.
  /// @param beyond  How much farther in all directions, in distances of the eyes.
  [[nodiscard]] bool reaches(const Vec3& p, double beyond = 0) const {
    constexpr double kEar = 1.3, kHairline = 0.9, kThroat = 1.7, kBack = 0.9;
    const Vec3 d = toLocal(p);
    return std::abs(d.x) < kEar + beyond && d.y < kHairline + beyond && d.y > -kThroat - beyond &&
           d.z > -kBack - beyond;
  }
};

}  // namespace cagecast::cages
