#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "charts/piece.hpp"
#include "charts/ticker.hpp"
#include "charts/unwrap.hpp"

namespace cagecast::cages {

/// Twice the signed area.
inline double doubledArea(const Uv& a, const Uv& b, const Uv& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// A box in the plane of UVs; empty until a point is added.
struct UvBox {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Uv low{kFar, kFar}, high{-kFar, -kFar};

  void add(const Uv& uv) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], uv[k]);
      high[k] = std::max(high[k], uv[k]);
    }
  }
  [[nodiscard]] double side(std::size_t k) const { return high[k] - low[k]; }
  [[nodiscard]] bool meets(const UvBox& other) const {
    return low[0] < other.high[0] && other.low[0] < high[0] && low[1] < other.high[1] && other.low[1] < high[1];
  }
};

/// A chart: part of a mesh, laid flat at its true size.
struct Chart {
  Piece piece;
  std::vector<Uv> uvs;
  double energy = 0;   ///< Symmetric Dirichlet, mean by area: 4 without stretch.
  bool valid = false;  ///< No flipped triangle, no overlap.

  [[nodiscard]] UvBox box() const {
    UvBox out;
    for (const Uv& uv : uvs) out.add(uv);
    return out;
  }
  /// The area in the plane of UVs.
  [[nodiscard]] double area() const {
    double out = 0;
    for (const Triangle3& t : piece.mesh.triangles) out += doubledArea(uvs[t[0]], uvs[t[1]], uvs[t[2]]) / 2;
    return out;
  }
};

/// Lays a piece flat: from a convex map (Tutte) by SLIM, stopping short of overlap.
/// @param piece  With a boundary and of genus 0. Its longest boundary loop becomes the rim, others stay holes.
/// @return an invalid chart if `ticker` is cancelled.
Chart flatten(Piece piece, Ticker& ticker);

/// Pairs of triangles whose insides meet, up to `most`. Exact if the coordinates are 32-bit floats.
std::uint32_t countOverlaps(const std::vector<Uv>& uvs, const std::vector<Triangle3>& triangles, std::uint32_t most);

}  // namespace cagecast::cages
