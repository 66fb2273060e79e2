#pragma once

#include <cstdint>

#include "base/area_unit.hpp"
#include "base/arena.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/status.hpp"
#include "geometry/vec3.hpp"
#include "input/validate.hpp"

namespace cagecast {

/// The target, welded: what every later step works on.
struct Points {
  static constexpr std::size_t kStride = 4;  ///< Floats per position: one SIMD load.

  std::uint32_t count = 0;
  const float* positions = nullptr;          ///< x, y, z, 0 per point, scaled, in the order of a space-filling curve.
  const std::uint32_t* cells = nullptr;      ///< 1 per point: its cell, numbered along that curve; ascending.
  const std::uint32_t* ofVertex = nullptr;   ///< The point of each vertex.
  std::uint32_t triangleCount = 0;           ///< Triangles with an area; the others take no part in anything.
  const std::uint32_t* triangles = nullptr;  ///< 3 points per triangle with an area.
  const double* doubleAreas = nullptr;       ///< Twice the area of each of them, scaled.
  const float* positionLow = nullptr;        ///< 3 per point, or none: the exact position minus `positions`.
  int sizeBits = 0;                          ///< The diagonal of their box is less than 2^(1 + sizeBits), scaled.

  /// The unit of areas of these triangles.
  [[nodiscard]] AreaUnit areaUnit() const { return AreaUnit(triangleCount, sizeBits); }

  /// Splits a position into floats and the remainder.
  static void split(Vec3 p, float* position, float* positionLow) noexcept;

  [[nodiscard]] const float* at(std::uint32_t point) const { return positions + kStride * point; }
  [[nodiscard]] Vec3 exactly(std::uint32_t point) const {
    const Vec3 p = Vec3::from(at(point));
    return positionLow == nullptr ? p : p + Vec3::from(positionLow + std::size_t{3} * point);
  }
};

/// Welds the vertices that have equal positions (−0 is 0) and equal groups into points, and drops triangles without
/// area. With `tolerance` > 0 (a share of the diagonal), points of a group that are nearer than it become one as well,
/// chains of them too, at the position that is smallest in x, then y, then z.
/// @return ok, weldToleranceTooLarge, or outOfMemory.
Code weld(const MeshView& target, const Units& units, float tolerance, Arena& arena, Points& out) noexcept;

}  // namespace cagecast
