#pragma once

#include "base/list.hpp"
#include "clip/target_triangle.hpp"

namespace cagecast {

/// Follows a border through a triangle, from one edge at the triangle's first corner to the other.
class BorderTracer {
 public:
  explicit BorderTracer(TargetTriangle& triangle) noexcept : triangle_(triangle) {}

  /// Finds the vertices of a polyline along the border between the first corner and the other two.
  /// @param from,to  Where the border meets the two edges; they are not listed.
  /// @return Valid until the next call.
  const List<TrianglePoint>& trace(const TrianglePoint (&corners)[3], const TrianglePoint& from,
                                   const TrianglePoint& to) noexcept;

  [[nodiscard]] bool failed() const noexcept { return line_.failed(); }

 private:
  /// A point of the triangle in coordinates around its first corner.
  struct Polar {
    double s;  ///< Which ray: the share of the opposite edge at which it ends.
    double r;  ///< How far along the ray, as a share of its length.
    [[nodiscard]] double x() const { return (1 - s) * r; }
    [[nodiscard]] double y() const { return s * r; }
  };
  /// The triangle.
  struct Wedge {
    TrianglePoint a, b, c;
    [[nodiscard]] Vec3 endOfRay(double s) const { return between(b.p, c.p, s); }
    [[nodiscard]] Vec3 at(Polar polar) const { return between(a.p, endOfRay(polar.s), polar.r); }
    [[nodiscard]] double lengthOfRay(double s) const { return length(endOfRay(s) - a.p); }
  };

  void follow(const Wedge& wedge, NearbyTriangles nearby, Polar from, Polar to, int depth) noexcept;
  Polar farthestBend(const Wedge& wedge, NearbyTriangles nearby, Polar from, Polar to, double& distance) noexcept;
  double borderOnRay(const Wedge& wedge, NearbyTriangles nearby, double s) noexcept;
  [[nodiscard]] bool isOnFirstSide(const Wedge& wedge, const BorderSample& sample) const noexcept;

  TargetTriangle& triangle_;
  List<TrianglePoint> line_;
};

}  // namespace cagecast
