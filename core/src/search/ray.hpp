#pragma once

#include <cstdint>
#include <limits>

#include "geometry/ray_direction.hpp"

namespace cagecast {

/// A ray: origin + t · direction, for t up to `end`. The origin is `position` + `positionLow`.
struct Ray {
  float position[3];
  float positionLow[3];  ///< What the exact origin has beyond its rounding to floats.
  const RayDirection* direction;
  double end = std::numeric_limits<double>::infinity();  ///< Hits beyond it do not count.

  void startAt(const float* from, const float* low) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] = from[axis];
      positionLow[axis] = low[axis];
    }
  }
  /// Whether the origin needs no `positionLow`.
  [[nodiscard]] bool isAtPosition() const noexcept {
    return positionLow[0] == 0 && positionLow[1] == 0 && positionLow[2] == 0;
  }
  [[nodiscard]] double origin(std::uint32_t axis) const noexcept {
    return static_cast<double>(position[axis]) + static_cast<double>(positionLow[axis]);
  }
};

}  // namespace cagecast
