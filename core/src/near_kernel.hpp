#pragma once

#include "kd_tree.hpp"

/// How far points are from boxes and triangles, four at a time, in float: enough to tell which triangles are worth a
/// decision in double.
namespace cagecast {

/// What two distances that the kernel below finds may be off together, as a share of the cage's extent e. With u = 2^-24, and d
/// the distance: a coordinate, counted from the middle of the cage, sums up numbers of at most √3/2 · e + d by ten roundings,
/// 9u · e + 6u · d in all, three of them 15u · e + 11u · d. In the plane numbers are at most d and the longest edge, √3 · e: `past`
/// and `beyond` are off by another 18u · e + 12u · d. Twice the sum of both is 4e-6 · e + 3e-6 · d; the latter is at most a
/// thirtieth of the slack s below where `kRelativeSlack` leaves no room for it.
inline constexpr double kRounding = 5e-6;
/// A squared distance of interest is (d + s)² for the nearest distance d and the slack s. It is at most
/// d² · (1 + r) + s² · (1 + 1/r) for any r, which needs no root; this r is good where d is a few thousandths of the diagonal.
inline constexpr double kRelativeSlack = 1e-4;

/// The s of the tie rule.
/// @param diagonal  Of the target, scaled.
inline double slackOf(const CageTree& tree, double diagonal) { return kTieDistance * diagonal + kRounding * tree.extent; }

/// s² · (1 + 1/r).
inline float fixedSlack(double slack, double ratio) { return static_cast<float>(slack * slack * (1 + 1 / ratio)); }

/// Squared distances of points to triangles, each in its own frame.
/// @param x,y,z  Of as many points as there are lanes, or of one in all of them, from the middle of the cage.
/// @param get    Gives the numbers to use for a field of the leaf: four side by side, or one of them in all lanes.
template <typename Floats, int count, typename Get>
Floats squaredDistances(const NearTriangles<count>& leaf, Floats x, Floats y, Floats z, Get get) {
  const auto coordinate = [&](const typename NearTriangles<count>::Axis& axis) {
    const auto& [alongX, alongY, alongZ] = axis.direction;
    return simd::multiplyAdd(z, get(alongZ), simd::multiplyAdd(y, get(alongY), simd::multiplyAdd(x, get(alongX), get(axis.middle))));
  };
  const Floats across = coordinate(leaf.axes[0]);
  const Floats up = coordinate(leaf.axes[1]);
  const Floats height = coordinate(leaf.axes[2]);
  const Floats zero = simd::zeros<Floats>();

  // A perpendicular through C parts the points that can be nearest to the left edge from those that can be to the right
  // one. Mirrored if need be, x counts from the lower end of that edge.
  const auto isLeft = across < get(leaf.foot);
  const auto side = [&](const float (&of)[2][count]) { return simd::choose(isLeft, get(of[0]), get(of[1])); };
  const Floats fromCorner = simd::select(isLeft, across, get(leaf.base) - across);
  const Floats edgeX = side(leaf.edgeX);
  const Floats edgeY = side(leaf.edgeY);
  // Above AB: beyond the edge by `beyond`, and past one of its ends by `past`; or inside, where both are 0.
  const Floats along = simd::multiplyAdd(fromCorner, edgeX, up * edgeY);
  const Floats past = along - simd::clamp(along, zero, side(leaf.edgeLength));
  const Floats beyond = simd::max(simd::subtractProduct(up * edgeX, fromCorner, edgeY), zero);
  const Floats toEdge = simd::multiplyAdd(beyond, beyond, past * past);
  // Below AB: nearest to AB, or to its end. Neither of the two is ever more than the distance, which one of them is.
  const Floats outside = simd::min(fromCorner, zero);
  const Floats below = simd::min(up, zero);
  const Floats toBase = simd::multiplyAdd(outside, outside, below * below);
  return simd::multiplyAdd(height, height, simd::max(toBase, toEdge));
}

}  // namespace cagecast
