#pragma once

namespace cagecast {

struct CageTriangle;

/// A box around the triangles of a leaf, turned with them: as thin as they are flat, and of four ways to turn it then
/// the one that covers the least. Of the leaves whose upright boxes are as near to a point as the answer, two fifths to
/// two thirds are not by this one.
struct alignas(16) LeafBox {
  float axes[3][4];  ///< axes[x, y, z of space][x, y, z of the box]: unit vectors.
  float low[4];      ///< From the middle of the cage.
  float high[4];
};

/// Makes the box of a leaf.
/// @param triangles  Those of the leaf.
/// @param middle     Of the cage: x, y, z, 0.
/// @param padding    How much larger than they the box is to be, scaled.
LeafBox boxAround(const CageTriangle* const (&triangles)[4], const float* middle, float padding) noexcept;

}  // namespace cagecast
