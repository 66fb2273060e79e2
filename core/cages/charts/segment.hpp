#pragma once

#include <cstdint>
#include <vector>

#include "charts/piece.hpp"
#include "charts/ticker.hpp"
#include "charts/unwrap.hpp"

namespace cagecast::cages {

/// Labels the triangles of a piece by the side of a box that they face, in few connected regions.
/// @return a label per triangle; regions of one label are connected.
std::vector<std::uint32_t> sidesOf(const Piece& piece, const UnwrapOptions& options, Ticker& ticker);

/// Labels what faces front and what faces back, with a short border between.
std::vector<std::uint32_t> frontAndBackOf(const TriangleMesh& mesh, const Vec3& front, Ticker& ticker);

/// Labels two connected halves of a connected piece of at least two triangles.
std::vector<std::uint32_t> halvesOf(const TriangleMesh& mesh);

/// Numbers the connected regions of equal labels: 0, 1, … in the order of their first triangles.
std::vector<std::uint32_t> regionsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& labels);

/// Joins regions smaller than `least` of the whole area, and the smallest ones while there are more than `most`, with
/// the neighbour that they have the longest border with.
/// @param[in,out] regions  Numbered as by `regionsOf`, afterwards with gaps.
void joinSmallRegions(const TriangleMesh& mesh, double least, std::size_t most, Ticker& ticker,
                      std::vector<std::uint32_t>& regions);

}  // namespace cagecast::cages
