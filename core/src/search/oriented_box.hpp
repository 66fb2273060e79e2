#pragma once

#include "geometry/triangle.hpp"

namespace cagecast {

/// A box in any orientation around the triangles of a leaf: thin across the plane that fits them best, and of four
/// orientations in that plane the one with the smallest area. It rejects two fifths to two thirds of the leaves that
/// the axis-aligned boxes leave.
struct alignas(16) OrientedBox {
  float axes[3][4];  ///< axes[x, y, z of space][x, y, z of the box]: unit vectors.
  float low[4];      ///< Along the box's axes, relative to the centre of the cage.
  float high[4];
};

/// Makes the box of a leaf.
/// @param centre   Of the cage: x, y, z, 0.
/// @param padding  How much larger than the triangles the box is made, scaled.
OrientedBox orientedBoxAround(const Triangle* const (&triangles)[4], const float* centre, float padding) noexcept;

}  // namespace cagecast
