#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "base/tolerances.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"

namespace cagecast {

/// What step 12 compares of the closest points of two target vertices.
struct UvSample {
  std::uint32_t cageTriangle;
  double distance;  ///< From the vertex to the cage, scaled.
  Uv uv;
};

/// The triangles that share the edges of a cage triangle in UV.
struct ChartNeighbours {
  std::uint32_t triangles[3];  ///< Per edge. The triangle itself at an edge that no other or several others share.
  std::uint32_t hasFan;        ///< 1 if several others share one of the edges.
};

/// The UV charts of the cage: its triangles connected over edges that have equal positions and equal UVs at both ends.
struct UvCharts {
  ChartNeighbours* neighbours;  ///< 1 per triangle.
  std::uint32_t* nextHalfEdge;  ///< 1 per half-edge: the next one of the same edge in UV. Those of an edge form a ring.
  std::uint32_t* charts;        ///< 1 per triangle: the number of its chart.
  double* stretch;              ///< 1 per triangle: the greatest ratio of UV length to length among its edges.
  float maxUv;                  ///< The greatest absolute UV coordinate.

  /// Whether the texture is smeared between two points: their UVs differ more than their cage triangles explain.
  /// @param a,b   Each with a `cageTriangle` and a `uv`.
  /// @param path  The length of a path between the points, scaled.
  template <typename Sample>
  [[nodiscard]] bool isSmeared(const Sample& a, const Sample& b, double path) const noexcept {
    const double du = b.uv.u - a.uv.u;
    const double dv = b.uv.v - a.uv.v;
    const double explained = std::max(stretch[a.cageTriangle], stretch[b.cageTriangle]) * path;
    return std::sqrt(du * du + dv * dv) > kSmear * explained + kSmearSlack;
  }

  /// Whether a seam separates two target vertices in the texture: their charts differ, or the edge is smeared.
  /// @param length  Of the edge between the vertices, scaled.
  [[nodiscard]] bool separates(const UvSample& a, const UvSample& b, double length) const noexcept {
    return charts[a.cageTriangle] != charts[b.cageTriangle] ||
           isSmeared(a, b, length + std::abs(b.distance - a.distance));
  }
};

/// @return false if memory ran out.
bool findUvCharts(const Cage& cage, const HalfEdges& halfEdges, Arena& arena, UvCharts& out) noexcept;

}  // namespace cagecast
