#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "cagecast/mesh.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/triangle.hpp"
#include "input/validate.hpp"

namespace cagecast {

/// A triangle of the cage that has an area, scaled. Its normal points outward, and is the direction of the rays of the
/// points that project onto it.
struct alignas(16) CageTriangle : Triangle {
  float uvs[6];         ///< u, v of each corner.
  std::uint32_t index;  ///< In the caller's mesh.
};

/// Blends the UVs of a triangle's corners at a point on it.
inline Uv uvAt(const CageTriangle& t, const ClosestPoint& closest) {
  const auto blend = [&](int axis) {
    const auto a = static_cast<double>(t.uvs[axis]);
    const double ab = static_cast<double>(t.uvs[2 + axis]) - a;
    const double ac = static_cast<double>(t.uvs[4 + axis]) - a;
    return a + closest.v * ab + closest.w * ac;
  };
  return {blend(0), blend(1)};
}

/// The cage without its degenerate triangles, in the caller's order.
struct Cage {
  std::uint32_t count = 0;
  const CageTriangle* triangles = nullptr;
};

/// Collects the triangles of the cage that have an area.
/// @return false if memory ran out. `out.count` is 0 if there is none.
bool gatherCage(const MeshView& cage, const Units& units, Arena& arena, Cage& out) noexcept;

}  // namespace cagecast
