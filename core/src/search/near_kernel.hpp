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

/// Squared distances in a triangle's own frame.
/// @param fromCorner  From the lower end of the upper edge that may be nearest, along the base and towards the other.
/// @param up,height   Above the base, and above the plane.
/// @param edgeX,edgeY,edgeLength  Of that edge.
template <typename Floats>
Floats squaredDistances(Floats fromCorner, Floats up, Floats height, Floats edgeX, Floats edgeY, Floats edgeLength) {
  const Floats zero = simd::zeros<Floats>();
  // In an order in which little waits for what comes last, which is `past`.
  const Floats toPlane = height * height;
  // Above AB: beyond the edge by `beyond`, and past one of its ends by `past`; or inside, where both are 0.
  const Floats along = simd::multiplyAdd(fromCorner, edgeX, up * edgeY);
  const Floats past = simd::max(along - edgeLength, simd::min(along, zero));
  const Floats beyond = simd::max(simd::subtractProduct(up * edgeX, fromCorner, edgeY), zero);
  const Floats toEdge = simd::multiplyAdd(past, past, simd::multiplyAdd(beyond, beyond, toPlane));
  // Below AB: nearest to AB, or to its end. Neither of the two is ever more than the distance, which one of them is.
  const Floats outside = simd::min(fromCorner, zero);
  const Floats below = simd::min(up, zero);
  const Floats toBase = simd::multiplyAdd(outside, outside, simd::multiplyAdd(below, below, toPlane));
  return simd::max(toBase, toEdge);
}

/// Squared distances of points to the triangles of a leaf.
/// @param x,y,z  Of as many points as there are lanes, or of one in all of them, from the middle of the cage.
/// @param get    Gives the numbers to use for a field of the leaf: four side by side, or one of them in all lanes.
template <typename Floats, typename Get>
Floats squaredDistances(const NearLeaf& leaf, Floats x, Floats y, Floats z, Get get) {
  const auto coordinate = [&](const NearLeaf::Axis& axis) {
    const auto& [alongX, alongY, alongZ] = axis.direction;
    return simd::multiplyAdd(z, get(alongZ),
                             simd::multiplyAdd(y, get(alongY), simd::multiplyAdd(x, get(alongX), get(axis.middle))));
  };
  const Floats across = coordinate(leaf.axes[0]);
  // A perpendicular through C parts the points that can be nearest to the left edge from those that can be to the right
  // one. Mirrored if need be, x counts from the lower end of that edge.
  const auto isLeft = across < get(leaf.foot);
  const auto side = [&](const float(&left)[4], const float(&right)[4]) {
    return simd::choose(isLeft, get(left), get(right));
  };
  const Floats fromCorner = simd::select(isLeft, across, get(leaf.base) - across);
  return squaredDistances(fromCorner, coordinate(leaf.axes[1]), coordinate(leaf.axes[2]), side(leaf.leftX, leaf.rightX),
                          side(leaf.leftY, leaf.rightY), side(leaf.leftLength, leaf.rightLength));
}

/// A triangle of a leaf by itself, to look at many points at once. Here x counts from the foot of C.
struct alignas(16) NearTriangle {
  float axes[3][4];  ///< `NearLeaf::axes`.
  float edges[4];    ///< Of the upper edges: the right one's x and y, the left one's y and x.
  float ends[4];     ///< The right one's length, how far B and A are from the foot of C, the left one's length.

  /// Takes a leaf apart.
  static void of(const NearLeaf& leaf, NearTriangle (&out)[4]) {
    // Four fields of the leaf after the other make a row of each.
    constexpr std::size_t kRows = sizeof(NearTriangle) / (4 * sizeof(float));
    static_assert(offsetof(NearLeaf, slot) == 4 * sizeof(NearTriangle));
    const simd::f32x4 foot = simd::load(leaf.foot);
    const auto* fields = reinterpret_cast<const float*>(&leaf);
    auto* rows = reinterpret_cast<float*>(out);
    for (std::size_t row = 0; row < kRows; ++row) {
      simd::f32x4 of[4];
      for (std::size_t i = 0; i < 4; ++i) of[i] = simd::load(fields + 16 * row + 4 * i);
      if (row == 0) of[0] = of[0] - foot;
      if (row == kRows - 1) {
        of[1] = of[1] - foot;
        of[2] = simd::toChoose(foot, of[1]);
      }
      simd::transpose(of[0], of[1], of[2], of[3]);
      for (std::size_t i = 0; i < 4; ++i) simd::store(rows + 4 * (kRows * i + row), of[i]);
    }
  }
};

/// Squared distances of as many points as there are lanes to a triangle.
/// @param x,y,z  From the middle of the cage.
inline simd::wide squaredDistances(const NearTriangle& triangle, simd::wide x, simd::wide y, simd::wide z) {
  const auto coordinate = [&](const float(&axis)[4]) {
    const simd::wide ofX = simd::multiplyAdd(x, simd::splatWideAt<1>(axis), simd::splatWideAt<0>(axis));
    return simd::multiplyAdd(z, simd::splatWideAt<3>(axis), simd::multiplyAdd(y, simd::splatWideAt<2>(axis), ofX));
  };
  const simd::wide across = coordinate(triangle.axes[0]);
  const simd::wideMask isLeft = across < simd::splatWide(0);
  const simd::wide fromCorner = simd::inner(isLeft, triangle.ends) - simd::abs(across);
  return squaredDistances(fromCorner, coordinate(triangle.axes[1]), coordinate(triangle.axes[2]),
                          simd::outer(isLeft, triangle.edges), simd::inner(isLeft, triangle.edges),
                          simd::outer(isLeft, triangle.ends));
}

}  // namespace cagecast
