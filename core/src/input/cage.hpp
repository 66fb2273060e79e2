#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "cagecast/mesh.hpp"
#include "geometry/vec3.hpp"
#include "input/validate.hpp"

namespace cagecast {

/// A direction, prepared for intersection: the axis it points along most becomes z, and a shear makes it the z-axis
/// (Woop, Benthin, Wald, "Watertight ray/triangle intersection", JCGT 2013). No reciprocal is infinite.
struct RayDirection {
  /// For filters.
  struct Rough {
    float inverse[3];      ///< 1 / component, of at most 1e20.
    float shearX, shearY;  ///< −x/z and −y/z of the direction.
    float scaleZ;          ///< −1/z.
    std::uint32_t z;       ///< Which axis serves as z; the next two, with x after z, as x and y.
  };
  Rough rough;
  Vec3 exact;  ///< Unit length.

  static RayDirection along(Vec3 unit) noexcept;
};

/// A triangle of the cage that has an area.
struct alignas(16) CageTriangle {
  float a[4], b[4], c[4];  ///< Corners (x, y, z, 0), scaled.
  float uvs[6];            ///< Of the corners.
  std::uint32_t index;     ///< In the caller's mesh.
  /// Of the barycentrics of b and c: times p − a, they are those of the foot of p.
  Vec3 gradientB, gradientC;
  RayDirection normal;  ///< Outward; the direction of the rays of the points that project here.
};

/// The cage without its degenerate triangles, in the caller's order.
struct Cage {
  std::uint32_t count = 0;
  const CageTriangle* triangles = nullptr;
};

/// Collects the triangles of the cage that have an area.
/// @return false if memory ran out. `out.count` is 0 if there is none.
bool gatherCage(const MeshView& cage, const Units& units, Arena& arena, Cage& out) noexcept;

}  // namespace cagecast
