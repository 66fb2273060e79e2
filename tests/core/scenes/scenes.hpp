#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/mesh.hpp"

/// Meshes made by code, for tests and benchmarks: the same bits on every platform (nothing but + − × ÷ and square
/// roots), so that a hash of what the library makes of them can be asserted everywhere.
namespace cagecast::scenes {

using Point = std::array<float, 3>;

float distance(Point a, Point b);

/// A mesh that owns its arrays. All of them stay consistent: 2 UVs and 1 group per vertex.
struct Mesh {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  std::vector<float> uvs;
  std::vector<std::uint32_t> groups;
  std::vector<float> poses;  ///< None, unless added in the end: functions of meshes leave them out.

  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups, poses}; }
  [[nodiscard]] std::size_t vertexCount() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t triangleCount() const { return indices.size() / 3; }
  [[nodiscard]] Point vertex(std::size_t v) const {
    return {positions[v * 3], positions[v * 3 + 1], positions[v * 3 + 2]};
  }
  /// The mean of the corners of a triangle.
  [[nodiscard]] Point centroid(std::size_t triangle) const;
  std::uint32_t addVertex(Point p, float u = 0, float v = 0, std::uint32_t group = 0);
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { indices.insert(indices.end(), {a, b, c}); }
};

/// A cage and its target.
struct Scene {
  std::string name;
  Mesh cage, target;
};

/// Random numbers that are the same everywhere (the standard library's distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// A whole number in 0..count-1.
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>((next() >> 32) * count >> 32); }
  /// A float in [low, high).
  float between(float low, float high);

 private:
  std::uint64_t state_;
};

/// An axis-aligned box of cells × cells quads a side, each two triangles, with UVs in an charts of six; split at its
/// edges.
Mesh box(Point centre, Point halfSize, int cells);

/// The same grid blown up to an ellipsoid.
Mesh ellipsoid(Point centre, Point radii, int cells);

/// A parallelogram of cells × cells quads, each two triangles, that faces to u × v; its UVs are 0 to 1 along u and v.
Mesh sheet(Point corner, Point u, Point v, int cells = 1);

/// Adds a mesh to another, as a group of its own.
void append(Mesh& mesh, const Mesh& other);

/// Applies a function Point -> Point to every position.
template <typename Map>
Mesh mapped(Mesh mesh, Map map) {
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = map(mesh.vertex(v));
    for (std::size_t k = 0; k < 3; ++k) mesh.positions[v * 3 + k] = p[k];
  }
  return mesh;
}

/// Takes away the triangles whose centroid a predicate picks; the vertices stay.
template <typename Predicate>
Mesh without(Mesh mesh, Predicate picks) {
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t)
    if (!picks(mesh.centroid(t)))
      kept.insert(kept.end(), {mesh.indices[t * 3], mesh.indices[t * 3 + 1], mesh.indices[t * 3 + 2]});
  mesh.indices = std::move(kept);
  return mesh;
}

/// Rotates by the quaternion (w, x, y, z), which need not be a unit one.
Mesh rotated(const Mesh& mesh, std::array<int, 4> quaternion);

/// The same triangles over vertices in another, random order, themselves in random order.
/// @param vertexOrder  Receives, for each new vertex, the old one.
Mesh shuffled(const Mesh& mesh, Random& random, std::vector<std::uint32_t>& vertexOrder);

/// Triangles strewn at random, some of them sharing corners, in a closed lumpy cage with a hole: nothing about it is
/// regular. Some triangles of both are degenerate.
Scene strewn(std::uint64_t seed, int triangles);

/// Strewn triangles with all corners on a grid, in a box of that grid: many are degenerate, coplanar or equally near,
/// and most rays go through edges and corners.
Scene gridded(std::uint64_t seed, int triangles);

/// A box or a ball, lumpy or not, often of two groups that meet along edges, in a box or a ball of other cells, with up
/// to three holes, all of it turned: islands, loops and edges cross each other anyhow.
Scene patchwork(std::uint64_t seed);

/// A box in a box on one lattice: every nearest point is on a corner or an edge of the cage, and every ray goes exactly
/// through corners or edges.
Scene lattice(int cells);

/// A pile of boxes, each smaller than the one below, on the lattice of its cage: rays run along the walls.
Scene stairs();

/// A head with eyes in its eye holes, teeth and a tongue behind its mouth, in a cage with holes for all of them.
/// @param cells  Triangles of the head: 12·cells².
Scene head(int cells);

/// The same in a cage that is moved aside, with panes of two triangles in front of its holes: every step has something
/// to do.
Scene crowdedHead(int cells, float shift);

/// The scenes whose results are hashed: of the preset `paper`, which are never changed, and of the preset `default`.
std::vector<Scene> golden();
std::vector<Scene> goldenDefault();

/// The scenes whose cut targets are hashed, with both kinds of seams.
std::vector<Scene> goldenBorders();

}  // namespace cagecast::scenes
