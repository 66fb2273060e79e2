#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"

namespace cagecast {

/// docs/method.md, step 9: an edge is smeared if it is so many times longer in UV than the cage explains, and so much
/// in UV besides.
inline constexpr double kSmear = 4;
inline constexpr double kSmearSlack = 0.005;

/// Where a place of the target falls in the texture.
struct Landing {
  std::uint32_t slot;  ///< The cage triangle that it is nearest to.
  double distance;     ///< To it.
  Uv uv;
};

/// What a triangle of the cage shares its edges with, in the texture.
struct Beside {
  std::uint32_t triangles[3];  ///< One per edge: itself if no other triangle has the edge, or more than one.
  std::uint32_t isOnFan;       ///< Whether more than one other has any of them.
};

/// How the cage's triangles hang together in the texture: over edges with equal position and UV at both ends.
struct UvCharts {
  Beside* beside;  ///< 1 per triangle.
  std::uint32_t*
      nextSide;  ///< 1 per side, as in `HalfEdges`: another side on the same edge; all sides of an edge form a ring.
  std::uint32_t* islands;  ///< 1 per triangle: equal for those that hang together.
  double* stretch;         ///< 1 per triangle: the most of its edges' UV length / length.
  float mostUv;            ///< The largest UV, without its sign.

  /// Whether the texture is torn or smeared between two places of the target, so far apart.
  [[nodiscard]] bool tears(const Landing& a, const Landing& b, double apart) const noexcept {
    if (islands[a.slot] != islands[b.slot]) return true;
    const double du = b.uv.u - a.uv.u;
    const double dv = b.uv.v - a.uv.v;
    const double path = apart + std::abs(b.distance - a.distance);
    const double explained = std::max(stretch[a.slot], stretch[b.slot]) * path;
    return std::sqrt(du * du + dv * dv) > kSmear * explained + kSmearSlack;
  }
};

/// @return false if memory ran out.
bool findUvCharts(const Cage& cage, const HalfEdges& edges, Arena& arena, UvCharts& out) noexcept;

}  // namespace cagecast
