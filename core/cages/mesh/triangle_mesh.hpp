#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "cagecast/mesh.hpp"
#include "geometry/vec3.hpp"

namespace cagecast::cages {

using Triangle3 = std::array<std::uint32_t, 3>;

/// No vertex, no triangle, no half-edge.
inline constexpr std::uint32_t kNone = UINT32_MAX;

/// A number for the edge between two vertices, in either direction.
inline std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

/// A vector at unit length; zero stays zero.
inline Vec3 unit(const Vec3& v) {
  const double size = length(v);
  return size > 0 ? 1 / size * v : Vec3{0, 0, 0};
}

inline bool isFinite(const Vec3& v) { return std::isfinite(v.x + v.y + v.z); }

/// Adds a position to an array of floats.
inline void append(std::vector<float>& floats, const Vec3& p) {
  for (const double x : {p.x, p.y, p.z}) floats.push_back(static_cast<float>(x));
}

/// A mesh that is being worked on, in double precision and in the space of the model.
struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle3> triangles;

  [[nodiscard]] bool empty() const noexcept { return triangles.empty(); }
};

/// A copy of a mesh in which equal positions are one vertex and degenerate triangles are left out. So are vertices that
/// no triangle uses, unless `vertexOf` is asked for.
/// @param[out] vertexOf  If not null: the vertex of the copy for each vertex of `mesh`.
/// @param[out] triangleOf  If not null: the triangle of `mesh` for each triangle of the copy.
TriangleMesh weldExactly(const MeshView& mesh, std::vector<std::uint32_t>* vertexOf = nullptr,
                         std::vector<std::uint32_t>* triangleOf = nullptr);

/// The part of a mesh made of some of its triangles; vertices that none of them uses are dropped.
TriangleMesh subset(const TriangleMesh& mesh, const std::vector<bool>& keepTriangle);

/// The connected piece, over shared vertices, of each triangle. Pieces are numbered in the order of their first
/// triangles.
std::vector<std::uint32_t> connectedPieces(const TriangleMesh& mesh, std::uint32_t& count);

/// Connected pieces as meshes of their own.
/// @param pieces  Per triangle, as of `connectedPieces`; `kNone` for those that are left out.
std::vector<TriangleMesh> split(const TriangleMesh& mesh, const std::vector<std::uint32_t>& pieces,
                                std::uint32_t count);

/// The length of the diagonal of the bounding box of the triangles.
double diagonalOf(const TriangleMesh& mesh);

/// Twice the area times the unit normal.
inline Vec3 areaNormal(const TriangleMesh& mesh, const Triangle3& t) {
  const Vec3& a = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

inline double areaOf(const TriangleMesh& mesh, const Triangle3& t) { return 0.5 * length(areaNormal(mesh, t)); }

/// The area of all triangles.
double areaOf(const TriangleMesh& mesh);

inline Vec3 centroid(const TriangleMesh& mesh, const Triangle3& t) {
  return 1.0 / 3 * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
}

/// The mean of what the corners of a triangle have, with barycentric weights.
inline Vec3 blend(const std::vector<Vec3>& values, const Triangle3& t, const std::array<double, 3>& weights) {
  return weights[0] * values[t[0]] + weights[1] * values[t[1]] + weights[2] * values[t[2]];
}

/// How far a point is from the line segment between two others.
double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b);

/// The middle one of some numbers by size; 0 if there are none.
double medianOf(std::vector<double> values);

/// The mean of points.
Vec3 meanOf(std::span<const Vec3> points);
/// The mean of the positions of some vertices, such as those of a loop.
Vec3 middleOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& vertices);

/// A unit normal per vertex, weighted by area; zero where it is not defined.
std::vector<Vec3> vertexNormals(const TriangleMesh& mesh);

/// The open edges as closed walks of vertices, each with the mesh on its left.
std::vector<std::vector<std::uint32_t>> boundaryLoops(const TriangleMesh& mesh);

}  // namespace cagecast::cages
