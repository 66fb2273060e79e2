#pragma once

#include <cstdint>

#include "geometry/vec3.hpp"

namespace cagecast {

/// A ray's direction, prepared for intersection tests: the axis along which it is longest becomes z, and a shear turns
/// the ray into the z-axis (Woop, Benthin, Wald, "Watertight ray/triangle intersection", JCGT 2013).
struct RayDirection {
  /// The direction in single precision, for tests that only filter.
  struct Rough {
    float inverse[3];      ///< 1 / component, of at most 1e20, never infinite.
    float shearX, shearY;  ///< −x/z and −y/z of the direction.
    float scaleZ;          ///< −1/z.
    std::uint32_t z;       ///< Which axis serves as z. The next two, with x after z, serve as x and y.
  };
  Rough rough;
  Vec3 exact;  ///< Of unit length.

  static RayDirection along(Vec3 unit) noexcept;
};

}  // namespace cagecast
