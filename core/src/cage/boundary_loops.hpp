#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "base/arena.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"

namespace cagecast {

/// The loops of the cage: the connected components of its open edges, those of exactly one triangle. Vertices with
/// equal positions are one, so that a seam of the texture is no loop.
struct BoundaryLoops {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// A box around a loop, scaled.
  struct Box {
    double low[3] = {kFar, kFar, kFar};
    double high[3] = {-kFar, -kFar, -kFar};
    void grow(Vec3 p) noexcept;
    [[nodiscard]] double diagonal() const noexcept;

   private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();
  };

  std::uint32_t count = 0;
  const Box* boxes = nullptr;
  /// 6 per triangle of the cage: the loop that its edges ab, bc, ca lie on, and the one that its corners a, b, c do.
  const std::uint32_t* ofSides = nullptr;

  /// The side of its triangle that a place on a loop lies on, or `kNone`: an edge 0, 1, 2 or else a corner 3, 4, 5.
  /// @param slot  The triangle of the place.
  /// @param q     Where it is: see `positionOf`.
  [[nodiscard]] std::uint32_t sideAt(const CageTriangle& triangle, std::uint32_t slot, Vec3 q,
                                     double diagonal) const noexcept;

  /// The loop that a place lies on, or `kNone`.
  [[nodiscard]] std::uint32_t at(const CageTriangle& triangle, std::uint32_t slot, Vec3 q,
                                 double diagonal) const noexcept {
    const std::uint32_t side = sideAt(triangle, slot, q, diagonal);
    return side == kNone ? kNone : ofSides[std::size_t{6} * slot + side];
  }

  /// Whether, for sure, no place between some corners of which this triangle is the nearest is nearest to a loop of it.
  [[nodiscard]] bool areOff(const CageTriangle& triangle, std::uint32_t slot, std::span<const Vec3> corners,
                            double diagonal) const noexcept;
  /// Whether, for sure, all of them are. Not all that are are known.
  [[nodiscard]] bool areOn(const CageTriangle& triangle, std::uint32_t slot,
                           std::span<const Vec3> corners) const noexcept;

  /// Whether a triangle of the cage comes to a loop at all.
  [[nodiscard]] bool touches(std::uint32_t slot) const noexcept {
    const std::uint32_t* sides = ofSides + std::size_t{6} * slot;
    // A loop at an edge is one at its corners.
    return (sides[3] & sides[4] & sides[5]) != kNone;
  }
};

/// Where a place is.
inline Vec3 positionOf(const CageTriangle& t, const ClosestPoint& place) {
  const Vec3 a = Vec3::from(t.a);
  return a + place.v * (Vec3::from(t.b) - a) + place.w * (Vec3::from(t.c) - a);
}

/// @return false if memory ran out.
bool findBoundaryLoops(const Cage& cage, const HalfEdges& edges, Arena& arena, BoundaryLoops& out) noexcept;

}  // namespace cagecast
