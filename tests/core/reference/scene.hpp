#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "reference/geometry.hpp"
#include "reference/reference.hpp"

/// The two meshes as the steps of the reference see them.
namespace cagecast::reference {

/// Numbers the sets of a union-find by their first element.
struct Sets {
  std::vector<std::uint32_t> parents;
  explicit Sets(std::size_t count) : parents(count) { std::iota(parents.begin(), parents.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  }
  // The lower root stays one, so that the root of a set is its first element.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parents[std::max(a, b)] = std::min(a, b);
  }
};

/// The target's vertices, welded.
struct Points {
  std::vector<std::uint32_t> ofVertex;  ///< The point of each vertex.
  std::vector<Vec> positions;           ///< Where each point is: at the least (by x, then y, then z) of its vertices.
  [[nodiscard]] std::size_t count() const { return positions.size(); }
};

/// A connected component of the cage's open edges: the loop of a hole, or of the cage.
struct Loop {
  Box box;
};

/// The open edges of the cage: those of exactly one triangle, where equal positions are one vertex.
struct BoundaryLoops {
  std::vector<Loop> loops;
  /// Per usable triangle: the loop of each edge (edge k goes from corner k to the next) and of each corner; −1 if none.
  std::vector<std::array<std::int32_t, 3>> loopOfEdge, loopOfCorner;
};

struct Scene {
  Surface cage, target;
  /// The vertices of each usable triangle of the cage, where equal positions are one vertex.
  std::vector<std::array<std::uint32_t, 3>> cageCorners;
  Points points;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< The points of each usable triangle of the target.
  BoundaryLoops loops;
  double diag = 0;  ///< Of the target's bounding box: all tolerances are shares of it.
};

Scene makeScene(const MeshView& cage, const MeshView& target, double weldTolerance = 0);

/// A point's place on the cage.
struct ClosestPoint {
  const Triangle* triangle = nullptr;
  Nearest nearest;
  [[nodiscard]] Vec position() const { return blend(*triangle, nearest.weights); }
  [[nodiscard]] bool inside() const {
    return nearest.weights[0] > 0 && nearest.weights[1] > 0 && nearest.weights[2] > 0;
  }
};

/// Step 1. Of triangles that are equally near, the one whose plane is farthest from p; of those that are equally far,
/// the one with the lowest index.
/// @param triangles  In order.
ClosestPoint project(const std::vector<const Triangle*>& triangles, Vec p, double diag);
ClosestPoint project(const Scene& scene, Vec p);

/// The loop whose open edge a place lies on (an end of an open edge is on it); −1 if it lies on none. Within 1e-6 of
/// the diagonal is on it, so that rounding does not decide.
std::int32_t loopAt(const Scene& scene, const ClosestPoint& place);

/// Where a place lies in the texture.
std::array<double, 2> uvAt(const MeshView& cage, const ClosestPoint& place);

/// Step 12: UVs per corner of the target's triangles, 6 per triangle.
/// @param places  1 per point.
/// @param uvs     2 per vertex: what a corner has if its triangle lies across no seam.
/// @param stable  Receives 1 per triangle: 0 where rounding decides which patch serves it.
std::vector<float> cornerUvs(const MeshView& cage, const MeshView& target, const Scene& scene,
                             const std::vector<ClosestPoint>& places, const std::vector<float>& uvs,
                             std::vector<std::uint8_t>& stable);

}  // namespace cagecast::reference
