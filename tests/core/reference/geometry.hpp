#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "cagecast/mesh.hpp"

/// What the reference knows of triangles, nearest points and rays, in double precision.
namespace cagecast::reference {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Vec {
  double x = 0, y = 0, z = 0;
  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};
inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Vec a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec a) { return std::sqrt(dot(a, a)); }
inline Vec unit(Vec a) { return a * (1.0 / length(a)); }

/// Where a vertex of a mesh is.
Vec vertex(const MeshView& mesh, std::uint32_t index);

/// An axis-aligned box; empty until something is put in.
struct Box {
  Vec low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  void add(Vec p);
  [[nodiscard]] bool contains(Vec p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
  }
  [[nodiscard]] double diagonal() const { return length(high - low); }
  /// Whether the two share a point when this one is grown by `margin` on every side.
  [[nodiscard]] bool meets(const Box& other, double margin) const;
};

/// The box of all vertices of a mesh.
Box boxOf(const MeshView& mesh);

/// A triangle that is not degenerate.
struct Triangle {
  std::uint32_t index = 0;  ///< Its place in the mesh.
  std::array<Vec, 3> corners{};
  Vec normal;  ///< Unit.
  double area = 0;
  Vec centre;  ///< Of a sphere around it.
  double radius = 0;
};

struct Ray {
  Vec origin, direction;
};

/// How far a ray is turned to see whether its answer is firm, in radians.
inline constexpr double kRayNudge = 1e-4;

/// Triangles, in a tree of spheres: without it ten thousand points against ten thousand triangles would take minutes.
class Surface {
 public:
  Surface() = default;
  explicit Surface(std::vector<Triangle> triangles);

  /// In the order of the mesh, without the degenerate ones.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

  /// The triangles that a ray, turned by up to `kRayNudge`, can possibly hit, in order.
  /// @param ray     With a unit direction.
  /// @param behind  How far behind its origin it begins, at most.
  [[nodiscard]] std::vector<const Triangle*> along(const Ray& ray, double behind) const;

  /// The triangles that can possibly be within `slack` of the nearest to p, in order.
  [[nodiscard]] std::vector<const Triangle*> near(Vec p, double slack) const;

 private:
  struct Node {
    Vec centre;
    double radius = 0;
    std::uint32_t first = 0, count = 0;  // Of `order_`; a leaf has no children.
    std::int32_t left = -1, right = -1;
  };
  std::int32_t build(std::uint32_t first, std::uint32_t count);

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// The triangles with an area; others take no part.
/// @param positions  Where each vertex of the mesh is.
Surface usableTriangles(const MeshView& mesh, const std::vector<Vec>& positions);

/// The point of a triangle nearest to another point.
struct Nearest {
  double distance = kInfinity;
  std::array<double, 3> weights{};  ///< Barycentrics; one is exactly zero where the point lies on an edge.
};

Nearest nearestOn(const Triangle& triangle, Vec p);

/// The point with given barycentrics.
Vec blend(const Triangle& triangle, const std::array<double, 3>& weights);

/// How far p lies before (+) or behind (−) the plane of a triangle.
double planeDistance(const Triangle& triangle, Vec p);

/// Where a ray meets the plane of a triangle that it hits, as a multiple of its direction; NaN if it does not hit.
///
/// Seen along the ray, the origin must not be outside any of the three edges. The sign of an edge comes out opposite,
/// bit by bit, for the two triangles that share it, and zero counts as inside: no ray slips between them.
double hit(const Ray& ray, const Triangle& triangle);

}  // namespace cagecast::reference
