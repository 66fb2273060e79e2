#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "base/arena.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"

namespace cagecast {

/// The boundary loops of the cage: the connected components of its open edges, which belong to exactly one triangle.
/// Vertices with equal positions are one, so a seam of the texture is no loop.
struct BoundaryLoops {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// A bounding box, scaled.
  struct Box {
    double low[3] = {kFar, kFar, kFar};
    double high[3] = {-kFar, -kFar, -kFar};
    void grow(Vec3 p) noexcept;
    [[nodiscard]] double diagonal() const noexcept;

   private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();
  };

  std::uint32_t count = 0;
  const Box* boxes = nullptr;  ///< 1 per loop.
  /// 6 per cage triangle: the loop that each of its edges ab, bc, ca lies on, and each of its corners a, b, c; or
  /// `kNone`.
  const std::uint32_t* loopOf = nullptr;

  /// The part of a triangle's boundary that lies on a loop and contains a point: an edge 0, 1, 2 or else a corner
  /// 3, 4, 5; `kNone` if the point is on no loop.
  /// @param q         The point, on the triangle: see `positionOf`.
  /// @param diagonal  Of the target, scaled.
  [[nodiscard]] std::uint32_t elementAt(const CageTriangle& triangle, std::uint32_t cageTriangle, Vec3 q,
                                        double diagonal) const noexcept;

  /// The loop that a point on a triangle lies on, or `kNone`.
  [[nodiscard]] std::uint32_t at(const CageTriangle& triangle, std::uint32_t cageTriangle, Vec3 q,
                                 double diagonal) const noexcept {
    const std::uint32_t element = elementAt(triangle, cageTriangle, q, diagonal);
    return element == kNone ? kNone : loopOf[std::size_t{6} * cageTriangle + element];
  }

  /// Whether it is certain that, for no point of a convex hull, the closest point on this triangle lies on a loop.
  [[nodiscard]] bool areSurelyOff(const CageTriangle& triangle, std::uint32_t cageTriangle, std::span<const Vec3> hull,
                                  double diagonal) const noexcept;
  /// Whether it is certain that, for all points of a convex hull, it does.
  [[nodiscard]] bool areSurelyOn(const CageTriangle& triangle, std::uint32_t cageTriangle,
                                 std::span<const Vec3> hull) const noexcept;

  /// Whether any edge or corner of a triangle lies on a loop.
  [[nodiscard]] bool touches(std::uint32_t cageTriangle) const noexcept {
    const std::uint32_t* loops = loopOf + std::size_t{6} * cageTriangle;
    // The ends of an edge on a loop are corners on it.
    return (loops[3] & loops[4] & loops[5]) != kNone;
  }
};

/// @return false if memory ran out.
bool findBoundaryLoops(const Cage& cage, const HalfEdges& halfEdges, Arena& arena, BoundaryLoops& out) noexcept;

}  // namespace cagecast
