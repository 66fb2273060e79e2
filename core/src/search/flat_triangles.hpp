#pragma once

#include <cstdint>

#include "geometry/triangle.hpp"
#include "simd/simd.hpp"

/// Squared distances from points to triangles in single precision, four at a time: they select the triangles whose
/// distance is then computed in double precision.
namespace cagecast {

/// Triangles, each in a frame of its own: the origin A is one end of the longest edge, x runs along that edge to B, z
/// along the normal. So C is above the edge AB, and x of C is between A and B.
/// @tparam n  The number of triangles side by side: 4 for a leaf, or 1.
template <int n>
struct alignas(16) FlatTriangles {
  /// Transforms a point to one coordinate of the frame. Points are relative to the centre of the cage.
  struct Axis {
    float offset[n];        ///< The coordinate of the centre of the cage.
    float direction[3][n];  ///< A unit vector.
  };
  Axis axes[3];
  /// The upper edges, AC on the left and BC on the right: unit vectors from AB to C, with x counted towards the foot of
  /// C, and lengths.
  float leftX[n], leftY[n], leftLength[n];
  float rightX[n], rightY[n], rightLength[n];
  float base[n];  ///< x of B.
  float foot[n];  ///< x of C.
};

/// The triangles of a leaf. Unused lanes are far away.
struct FlatLeaf : FlatTriangles<4> {
  std::uint32_t cageTriangles[4];
};

/// Sets one lane of a leaf.
/// @param centre  Of the cage.
void setTriangle(FlatLeaf& leaf, std::uint32_t lane, const Triangle& triangle, const float* centre) noexcept;

/// Sets an unused lane.
void clearTriangle(FlatLeaf& leaf, std::uint32_t lane) noexcept;

/// One triangle of a leaf, whose distances to many points are then found at once.
FlatTriangles<1> triangleOf(const FlatLeaf& leaf, std::uint32_t lane) noexcept;

/// A bound on the rounding errors of two distances by `squaredDistances` together, as a share of the cage's extent e.
///
/// With u = 2^-24 and d the distance, a coordinate is a sum of numbers of at most √3/2 · e + d with ten roundings, off
/// by 9u · e + 6u · d, three of them together by 15u · e + 11u · d. In the plane numbers are at most d and the longest
/// edge, √3 · e: `past` and `beyond` are off by another 18u · e + 12u · d, and by 3u · e where x counts from the foot
/// of C. Twice the sum is 4.4e-6 · e + 3e-6 · d. Where `kRelativeSlack` does not cover the second term, it is at most a
/// thirtieth of the slack s.
inline constexpr double kRounding = 5e-6;

/// A triangle may be the closest one if its distance is at most d + s, for the least distance d and a slack s. (d + s)²
/// is at most d² · (1 + r) + s² · (1 + 1/r) for any r > 0: a limit of squared distances without a root. This r is good
/// where d is a few thousandths of the diagonal.
inline constexpr double kRelativeSlack = 1e-4;

/// s² · (1 + 1/r).
inline float fixedSlack(double slack, double ratio) { return static_cast<float>(slack * slack * (1 + 1 / ratio)); }

/// Squared distances, of four points to a triangle or of one point to four triangles.
/// @param x,y,z  Of the points, relative to the centre of the cage.
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
  // Points left of C can be closest to the edge AC, points right of it to BC. `fromCorner` is the distance from the end
  // of that edge on AB, towards the other end of AB.
  const simd::mask4 isLeft = across < get(of.foot);
  const f32x4 edgeX = select(isLeft, get(of.leftX), get(of.rightX));
  const f32x4 edgeY = select(isLeft, get(of.leftY), get(of.rightY));
  const f32x4 edgeLength = select(isLeft, get(of.leftLength), get(of.rightLength));
  const f32x4 fromCorner = select(isLeft, across, get(of.base) - across);
  const f32x4 toPlane = height * height;
  // Points above AB: how far outside the edge they are, and how far past one of its ends. Inside, both are 0.
  const f32x4 along = multiplyAdd(fromCorner, edgeX, up * edgeY);
  const f32x4 past = max(along - edgeLength, min(along, zero));
  const f32x4 beyond = max(up * edgeX - fromCorner * edgeY, zero);
  const f32x4 toEdge = multiplyAdd(past, past, multiplyAdd(beyond, beyond, toPlane));
  // Points below AB: closest to AB, or to its end. Of `toBase` and `toEdge` neither exceeds the true distance, and one
  // of them equals it.
  const f32x4 outside = min(fromCorner, zero);
  const f32x4 below = min(up, zero);
  const f32x4 toBase = multiplyAdd(outside, outside, multiplyAdd(below, below, toPlane));
  return max(toBase, toEdge);
}

}  // namespace cagecast
