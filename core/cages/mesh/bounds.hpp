#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// A box along the axes; empty until a point is added.
struct Bounds {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};

  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  [[nodiscard]] bool empty() const { return low.x > high.x; }
  [[nodiscard]] Vec3 size() const { return empty() ? Vec3{0, 0, 0} : high - low; }
  [[nodiscard]] Vec3 middle() const { return 0.5 * (low + high); }
  [[nodiscard]] double diagonal() const { return length(size()); }
  /// How far another box is from this one; 0 if they meet.
  [[nodiscard]] double distance(const Bounds& other) const {
    const Vec3 below = low - other.high, above = other.low - high;
    return length(
        Vec3{std::max({below.x, above.x, 0.0}), std::max({below.y, above.y, 0.0}), std::max({below.z, above.z, 0.0})});
  }
  /// How far a point is from the box; 0 inside.
  [[nodiscard]] double distance(const Vec3& p) const { return distance(Bounds{p, p}); }
};

/// How far numbers reach; empty until one is added.
struct Range {
  double low = Bounds::kFar, high = -Bounds::kFar;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// How far points reach along a direction.
inline Range rangeOf(std::span<const Vec3> points, const Vec3& direction) {
  Range out;
  for (const Vec3& p : points) out.add(dot(p, direction));
  return out;
}

/// The box of some of a mesh's vertices.
inline Bounds boundsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices) {
  Bounds out;
  for (const std::uint32_t v : vertices) out.add(mesh.positions[v]);
  return out;
}

/// The box of the triangles of a mesh. Vertices that no triangle uses do not count.
inline Bounds boundsOf(const TriangleMesh& mesh) {
  Bounds out;
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) out.add(mesh.positions[v]);
  return out;
}

/// The same for a mesh as it is given, which has a triangle and whose indices were checked.
inline Bounds boundsOf(const MeshView& mesh) {
  Bounds out;
  for (const std::uint32_t v : mesh.indices) out.add(Vec3::from(&mesh.positions[std::size_t{3} * v]));
  return out;
}

}  // namespace cagecast::cages
