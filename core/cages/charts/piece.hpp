#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/half_edges.hpp"

namespace cagecast::cages {

/// Part of a mesh with vertices of its own, each of which has one connected fan of triangles.
struct Piece {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertexOf;    ///< The vertex of the whole mesh for each vertex; `kNone` for made ones.
  std::vector<std::uint32_t> triangleOf;  ///< The triangle of the whole mesh for each triangle.
};

/// The whole of a mesh as one piece.
Piece wholeOf(const TriangleMesh& mesh);

/// Cuts a piece open along edges: vertices are doubled where the surface does not go on round them any more.
/// @param cut  Per half-edge; an edge is cut if one of its two is marked.
Piece cutOpen(const Piece& piece, const std::vector<bool>& cut);

/// The connected pieces of each region of a piece, region by region.
/// @param regions  Per triangle, from 0.
std::vector<Piece> splitBy(const Piece& piece, std::span<const std::uint32_t> regions);

/// The connected pieces of one region of a piece.
std::vector<Piece> piecesOf(const Piece& piece, std::span<const std::uint32_t> regions, std::uint32_t region);

/// The connected pieces of a piece, in the order of their first triangles.
std::vector<Piece> componentsOf(const Piece& piece);

/// The boundary of a piece as closed walks of half-edges, the longest first.
std::vector<std::vector<std::uint32_t>> loopsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> twins);

/// The length of a walk of half-edges.
double lengthOf(const TriangleMesh& mesh, std::span<const std::uint32_t> walk);

}  // namespace cagecast::cages
