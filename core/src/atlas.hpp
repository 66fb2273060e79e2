#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cage.hpp"
#include "place.hpp"
#include "scratch.hpp"

namespace cagecast {

/// docs/method.md, step 9: an edge is smeared if it is so many times longer in UV than the cage explains, and so much in UV besides.
inline constexpr double kSmear = 4;
inline constexpr double kSmearSlack = 0.005;

/// Where a place of the target falls in the texture.
struct Landing {
  std::uint32_t slot;  ///< The cage triangle that it is nearest to.
  double distance;     ///< To it.
  Uv uv;
};

/// How the cage's triangles hang together in the texture: over edges with equal position and UV at both ends.
/// Side 3 · t + k goes from corner k of triangle t to the next one.
struct Atlas {
  std::uint32_t* nextSide;  ///< 1 per side: another side on the same edge; all sides of an edge form a ring.
  std::uint32_t* islands;   ///< 1 per triangle: equal for those that hang together.
  double* stretch;          ///< 1 per triangle: the most of its edges' UV length / length.
  float mostUv;             ///< The largest UV, without its sign.

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

/// @param mesh  The cage as it was given: vertices are compared as they are there, not scaled.
/// @return false if memory ran out.
bool findAtlas(const MeshView& mesh, const Cage& cage, Scratch& scratch, Atlas& out) noexcept;

}  // namespace cagecast
