#pragma once

#include "search/kd_tree.hpp"

/// How far points are from boxes and triangles, four at a time, in float: enough to tell which triangles are worth a
/// decision in double.
namespace cagecast {

/// What two distances that the kernel below finds may be off together, as a share of the cage's extent e. With u =
/// 2^-24, and d the distance: a coordinate, counted from the middle of the cage, sums up numbers of at most √3/2 · e +
/// d by ten roundings, 9u · e + 6u · d in all, three of them 15u · e + 11u · d. In the plane numbers are at most d and
/// the longest edge, √3 · e: `past` and `beyond` are off by another 18u · e + 12u · d, and by 3u · e where x counts
/// from the foot of C. Twice the sum of all is 4.4e-6 · e + 3e-6 · d; the latter is at most a thirtieth of the slack s
/// below where `kRelativeSlack` leaves no room for it.
inline constexpr double kRounding = 5e-6;
/// A squared distance of interest is (d + s)² for the nearest distance d and the slack s. It is at most
/// d² · (1 + r) + s² · (1 + 1/r) for any r, which needs no root; this r is good where d is a few thousandths of the
/// diagonal.
inline constexpr double kRelativeSlack = 1e-4;

/// The s of the tie rule.
/// @param diagonal  Of the target, scaled.
inline double slackOf(const CageTree& tree, double diagonal) {
  return kTieDistance * diagonal + kRounding * tree.extent;
}

/// s² · (1 + 1/r).
inline float fixedSlack(double slack, double ratio) { return static_cast<float>(slack * slack * (1 + 1 / ratio)); }

/// One triangle of a leaf, to look at many points at once.
inline FlatTriangles<1> triangleOf(const NearLeaf& leaf, std::uint32_t lane) {
  FlatTriangles<1> one;
  for (int i = 0; i < 3; ++i) {
    one.axes[i].offset[0] = leaf.axes[i].offset[lane];
    for (int k = 0; k < 3; ++k) one.axes[i].direction[k][0] = leaf.axes[i].direction[k][lane];
  }
  one.leftX[0] = leaf.leftX[lane];
  one.leftY[0] = leaf.leftY[lane];
  one.leftLength[0] = leaf.leftLength[lane];
  one.rightX[0] = leaf.rightX[lane];
  one.rightY[0] = leaf.rightY[lane];
  one.rightLength[0] = leaf.rightLength[lane];
  one.base[0] = leaf.base[lane];
  one.foot[0] = leaf.foot[lane];
  return one;
}

/// Squared distances, of four points to a triangle or of one point to four triangles.
/// @param x,y,z  Of the points, from the middle of the cage.
template <int n>
simd::f32x4 squaredDistances(const FlatTriangles<n>& of, simd::f32x4 x, simd::f32x4 y, simd::f32x4 z) {
  using simd::f32x4;
  using simd::multiplyAdd;
  const auto get = [](const float(&field)[n]) {
    if constexpr (n == 1) {
      return simd::splat(field[0]);
    } else {
      return simd::load(field);
    }
  };
  const auto coordinate = [&](const typename FlatTriangles<n>::Axis& axis) {
    const auto& [alongX, alongY, alongZ] = axis.direction;
    return multiplyAdd(z, get(alongZ), multiplyAdd(y, get(alongY), multiplyAdd(x, get(alongX), get(axis.offset))));
  };
  const f32x4 zero = simd::splat(0);
  const f32x4 across = coordinate(of.axes[0]);
  const f32x4 up = coordinate(of.axes[1]);
  const f32x4 height = coordinate(of.axes[2]);
  // A perpendicular through C parts the points that can be nearest to the left edge AC from those that can be to the
  // right edge BC. Mirrored if need be, `fromCorner` counts from the lower end of that edge towards the other corner.
  const simd::mask4 isLeft = across < get(of.foot);
  const f32x4 edgeX = select(isLeft, get(of.leftX), get(of.rightX));
  const f32x4 edgeY = select(isLeft, get(of.leftY), get(of.rightY));
  const f32x4 edgeLength = select(isLeft, get(of.leftLength), get(of.rightLength));
  const f32x4 fromCorner = select(isLeft, across, get(of.base) - across);
  const f32x4 toPlane = height * height;
  // Above AB: beyond the edge by `beyond`, and past one of its ends by `past`; or inside, where both are 0.
  const f32x4 along = multiplyAdd(fromCorner, edgeX, up * edgeY);
  const f32x4 past = max(along - edgeLength, min(along, zero));
  const f32x4 beyond = max(up * edgeX - fromCorner * edgeY, zero);
  const f32x4 toEdge = multiplyAdd(past, past, multiplyAdd(beyond, beyond, toPlane));
  // Below AB: nearest to AB, or to its end. Neither of the two is ever more than the distance, which one of them is.
  const f32x4 outside = min(fromCorner, zero);
  const f32x4 below = min(up, zero);
  const f32x4 toBase = multiplyAdd(outside, outside, multiplyAdd(below, below, toPlane));
  return max(toBase, toEdge);
}

}  // namespace cagecast
