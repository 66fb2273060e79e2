#pragma once

#include "steps/steps.hpp"

namespace cagecast {

/// Step 9: gives the triangles that lie across a seam of the cage's texture UVs of their own, so that none of them
/// stretches over the charts: all three corners are projected onto the part of the cage around one of them that hangs
/// together in the texture.
/// @param[out] cornerUvs  2 per index of the target. Where no seam is, and of triangles without an area, those of the
/// vertices.
/// @return false if memory ran out.
/// Cost: O(N + M) for N triangles of the target and M of the cage; a triangle across a seam costs as much as the cage
/// has triangles within 1.5 of its edges.
bool findCornerUvs(const MeshView& targetMesh, const Points& points, const Cage& cage, const HalfEdges& edges,
                   const CageTree& tree, const Units& units, const PointResults& results, Arena& arena,
                   float* cornerUvs) noexcept;

}  // namespace cagecast
