#pragma once

#include <cstdint>
#include <vector>

#include "charts/piece.hpp"
#include "charts/ticker.hpp"
#include "charts/unwrap.hpp"

namespace cagecast::cages {

/// A chart: part of a mesh, laid flat at its true size.
struct Chart {
  Piece piece;
  std::vector<Uv> uvs;
  double energy = 0;   ///< Symmetric Dirichlet, mean by area: 4 without stretch.
  bool valid = false;  ///< No flipped triangle, no overlap.
};

/// Lays a piece flat: from a convex map (Tutte) by SLIM, stopping short of overlap.
/// @param piece  With a boundary and of genus 0. Its longest boundary loop becomes the rim, others stay holes.
/// @return an invalid chart if `ticker` is cancelled.
Chart flatten(Piece piece, Ticker& ticker);

/// Pairs of triangles whose insides meet, up to `most`. Exact if the coordinates are 32-bit floats.
std::uint32_t countOverlaps(const std::vector<Uv>& uvs, const std::vector<Triangle3>& triangles, std::uint32_t most);

/// Twice the signed area.
inline double doubledArea(const Uv& a, const Uv& b, const Uv& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace cagecast::cages
