#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "charts/piece.hpp"

namespace cagecast::cages {

/// What a seam along an edge costs, per unit of length; above 0.
using SeamCost = std::function<double(const TriangleMesh& mesh, std::uint32_t from, std::uint32_t to)>;

/// Distances along edges from some vertices, with the way back.
struct EdgeDistances {
  std::vector<double> distance;
  std::vector<std::uint32_t> cameBy;  ///< The half-edge by which each vertex was reached; `kNone` at a start.
};

/// @param cost  If empty, edges count their length.
EdgeDistances edgeDistances(const TriangleMesh& mesh, std::span<const std::uint32_t> starts, const SeamCost& cost);

/// Cuts a piece along the cheapest way between two sets of vertices.
Piece cutBetween(const Piece& piece, std::span<const std::uint32_t> starts, std::span<const std::uint32_t> ends,
                 const SeamCost& cost);

/// Cuts a connected piece until it is a disk with small holes: opens closed surfaces, cuts handles, and joins larger
/// holes with the longest boundary loop.
Piece cutToDisk(Piece piece, const SeamCost& cost);

}  // namespace cagecast::cages
