#pragma once

#include <cstdint>
#include <limits>

#include "geometry/ray_direction.hpp"

namespace cagecast {

/// A ray: origin + t · direction, for t up to `end`. The origin is `position` + `rest`.
struct Ray {
  float position[3];
  float rest[3];  ///< What the exact origin has beyond its rounding to floats.
  const RayDirection* direction;
  double end = std::numeric_limits<double>::infinity();  ///< Hits beyond it do not count.

  void startAt(const float* from, const float* restOfIt) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] = from[axis];
      rest[axis] = restOfIt[axis];
    }
  }
  /// Whether the origin needs no `rest`.
  [[nodiscard]] bool isAtPosition() const noexcept { return rest[0] == 0 && rest[1] == 0 && rest[2] == 0; }
  [[nodiscard]] double origin(std::uint32_t axis) const noexcept {
    return static_cast<double>(position[axis]) + static_cast<double>(rest[axis]);
  }
};

}  // namespace cagecast
