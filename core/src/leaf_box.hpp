#pragma once

namespace cagecast {

struct CageTriangle;
struct NearLeaf;

/// A box around the triangles of a leaf, turned with them. It is thin where they are flat: of the leaves whose upright boxes are
/// as near to a point as the answer, a third to two thirds are not by this one.
struct alignas(16) LeafBox {
  float axes[3][4];  ///< axes[x, y, z of space][x, y, z of the box]: unit vectors.
  float origin[4];   ///< A point of the leaf, where the box's coordinates are 0.
  float low[4];
  float high[4];
};

/// Makes the box of a leaf.
/// @param triangles  Those of the leaf.
/// @param padding    How much larger than they the box is to be, scaled.
LeafBox boxAround(const NearLeaf& leaf, const CageTriangle* const (&triangles)[4], float padding) noexcept;

}  // namespace cagecast
