#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

/// A target whose triangles are cut along the projected boundary loops and seams of the cage. Every triangle
/// lies on one side. The vertices of the target keep their numbers and new ones follow. All triangles at an edge are
/// cut at the same places, even if they do not share vertices, so the surface stays as watertight as it was.
struct CutTarget {
  /// 3 per new vertex: the vertices of the target that it blends, which are corners of one triangle. For a vertex on an
  /// edge: the two ends of the edge, in an order that depends on their positions alone, and the first one again.
  Array<std::uint32_t> sources;
  Array<float> weights;          ///< 3 per new vertex: how much of each source; multiples of 2^-24 that add up to 1.
  Array<std::uint32_t> indices;  ///< 3 per triangle.
  Array<std::uint32_t> origins;  ///< 1 per triangle: the triangle of the target that it was cut from; ascending.
  Array<float> uvs;              ///< 2 per vertex.
  Array<float> cornerUvs;        ///< 2 per index with `Seams::corner` and `ProjectionMode::nearestPoint`; else empty.
  Array<Zone> zones;             ///< 1 per vertex; vertices on the border of a hole are cosmetic.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per triangle: 1 if it may be painted.
};

/// A non-owning view of a target and the result of a transfer to it.
struct DecidedTarget {
  MeshView mesh;
  std::span<const Zone> zones;              ///< 1 per vertex: `Zones::zones`.
  std::span<const std::uint32_t> segments;  ///< 1 per vertex: `Projection::segments`.
  std::span<const CulledBy> culledBy;       ///< 1 per segment: `Zones::culledBy`.
};

/// Cuts a target along the projected boundary loops of its cage and, with `Seams::corner`, along the seams of the
/// texture, and transfers to the cut target. Which segments are culled does not change. Pieces of a triangle that a
/// mask decides are decided as the whole triangle was. With `ProjectionMode::nearestVertex` nothing is cut.
/// @param target   The result of a transfer with the same cage and options.
/// @return As `transfer`; resultMismatch if the zones or segments do not belong to the mesh; bordersTooComplex if that
/// takes more comparisons with triangles of the cage than 4,000,000, 20,000 for each triangle of the target and 100,000
/// for each border edge of the cage.
/// Cost: that of a transfer, about twenty nearest-point searches per cut edge, and a search for borders that no edge
/// meets, which takes seconds for large triangles under a finely divided cage.
Status cutBorders(const MeshView& cage, const DecidedTarget& target, const TransferOptions& options,
                  Workspace& workspace, CutTarget& out) noexcept;

}  // namespace cagecast
