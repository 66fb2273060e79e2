#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

/// A target whose triangles are cut along the projected boundary loops and seams of the cage: step 10. Every triangle
/// lies on one side. The vertices of the target keep their numbers and new ones follow. An edge is cut at the same
/// places for all triangles on it, also where its vertices are split, so the surface stays as watertight as it was.
struct CutTarget {
  /// 3 per new vertex: the vertices of the target that it blends, corners of one triangle. For a vertex on an edge, the
  /// two ends of the edge, ordered by their positions alone, and the first one again.
  Array<std::uint32_t> sources;
  Array<float> weights;          ///< 3 per new vertex: how much of each source; multiples of 2^-24 that add up to 1.
  Array<std::uint32_t> indices;  ///< 3 per triangle.
  Array<std::uint32_t> origins;  ///< 1 per triangle: the triangle of the target that it is a part of, ascending.
  Array<float> uvs;              ///< 2 per vertex.
  Array<float> cornerUvs;        ///< 2 per index with `Seams::corner`; else empty.
  Array<Zone> zones;             ///< 1 per vertex; vertices on the border of a hole are cosmetic.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per triangle: 1 if it may be painted.
};

/// A target and what a transfer to it decided, seen but not owned.
struct DecidedTarget {
  MeshView mesh;
  std::span<const Zone> zones;              ///< 1 per vertex: `Zones::zones`.
  std::span<const std::uint32_t> segments;  ///< 1 per vertex: `Projection::segments`.
  std::span<const CulledBy> culledBy;       ///< 1 per segment: `Zones::culledBy`.
};

/// Cuts a target along the boundary loops that its cage projects on it, and, with `Seams::corner`, along the seams of
/// the texture, and transfers to the cut target: step 10. Culled segments stay culled, and others are kept. With
/// `ProjectionMode::nearestVertex` nothing is cut.
/// @param target   The result of a transfer with the same cage and options.
/// @return As `transfer`; resultMismatch if the zones or segments do not belong to the mesh.
/// Cost: that of a transfer, and about twenty searches for a nearest point for each edge that is cut.
Status cutBorders(const MeshView& cage, const DecidedTarget& target, const TransferOptions& options,
                  Workspace& workspace, CutTarget& out) noexcept;

}  // namespace cagecast
