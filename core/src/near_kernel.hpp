#pragma once

#include "kd_tree.hpp"

/// How far points are from boxes and triangles, four at a time, in float: enough to tell which triangles are worth a
/// decision in double.
namespace cagecast {

/// What the kernels below may be off, as a share of the distance and of the cage's extent: they round a dozen times, each
/// time by 2^-24 of one of them.
inline constexpr double kRounding = 1e-6;
/// A squared distance of interest is (d + s)² for the nearest distance d and the slack s. It is at most
/// d² · (1 + r) + s² · (1 + 1/r) for any r, which needs no root; this r is good where d is a few thousandths of the diagonal.
inline constexpr double kRelativeSlack = 1e-4;

/// The s of the tie rule.
/// @param diagonal  Of the target, scaled.
inline double slackOf(const CageTree& tree, double diagonal) { return kTieDistance * diagonal + kRounding * tree.extent; }

/// s² · (1 + 1/r).
inline float fixedSlack(double slack, double ratio) { return static_cast<float>(slack * slack * (1 + 1 / ratio)); }

/// Squared distances of points to triangles, each in its own frame.
/// @param x,y,z  Of four points, or of one four times.
/// @param get    Gives the four numbers to use for a field of the leaf: `simd::load`, or one of them four times.
template <typename Get>
simd::f32x4 squaredDistances(const NearLeaf& leaf, simd::f32x4 x, simd::f32x4 y, simd::f32x4 z, Get get) {
  const simd::f32x4 dx = x - get(leaf.origin[0]);
  const simd::f32x4 dy = y - get(leaf.origin[1]);
  const simd::f32x4 dz = z - get(leaf.origin[2]);
  const auto coordinate = [&](const float (&axis)[3][4]) { return simd::multiplyAdd(dz, get(axis[2]), simd::multiplyAdd(dy, get(axis[1]), dx * get(axis[0]))); };
  const simd::f32x4 across = coordinate(leaf.axes[0]);
  const simd::f32x4 up = coordinate(leaf.axes[1]);
  const simd::f32x4 height = coordinate(leaf.axes[2]);
  const simd::f32x4 zero = simd::splat(0);

  // A perpendicular through C parts the points that can be nearest to the left edge from those that can be to the right
  // one. Mirrored if need be, x counts from the lower end of that edge.
  const simd::mask4 isLeft = across < get(leaf.foot);
  const auto side = [&](const float (&left)[4], const float (&right)[4]) { return simd::select(isLeft, get(left), get(right)); };
  const simd::f32x4 fromCorner = simd::select(isLeft, across, get(leaf.base) - across);
  const simd::f32x4 edgeX = side(leaf.left.x, leaf.right.x);
  const simd::f32x4 edgeY = side(leaf.left.y, leaf.right.y);
  // Above AB: beyond the edge by `beyond`, and past one of its ends by `past`; or inside.
  const simd::f32x4 along = simd::multiplyAdd(fromCorner, edgeX, up * edgeY);
  const simd::f32x4 past = along - simd::clamp(along, zero, side(leaf.left.length, leaf.right.length));
  const simd::f32x4 beyond = simd::subtractProduct(up * edgeX, fromCorner, edgeY);
  const simd::f32x4 toEdge = simd::keep(zero < beyond, simd::multiplyAdd(beyond, beyond, past * past));
  // Below AB: nearest to AB, or to its end.
  const simd::f32x4 outside = simd::min(fromCorner, zero);
  const simd::f32x4 toBase = simd::multiplyAdd(outside, outside, up * up);
  return simd::multiplyAdd(height, height, simd::select(up < zero, toBase, toEdge));
}

}  // namespace cagecast
