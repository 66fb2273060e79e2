#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

/// The target with its triangles cut where a loop or a seam of the cage is projected to: step 10. Every triangle lies
/// on one side. Vertices keep their numbers, new ones come after them; an edge is cut at the same places for all
/// triangles on it, also where its vertices are split, so that the surface stays as watertight as it was.
struct CutTarget {
  /// 3 per new vertex: the vertices of the target that it is a blend of, corners of one triangle. Of a vertex on an
  /// edge those of the edge, in an order that depends on their positions alone, and the first once more.
  Array<std::uint32_t> sources;
  Array<float> weights;          ///< 3 per new vertex: how much of each; multiples of 2^-24 that add up to 1.
  Array<std::uint32_t> indices;  ///< 3 per triangle.
  Array<std::uint32_t> origins;  ///< 1 per triangle: the triangle of the target that it is a part of. In order.
  Array<float> uvs;              ///< 2 per vertex.
  Array<float> cornerUvs;        ///< 2 per index, with `Seams::corner`; else empty.
  Array<Zone> zones;             ///< 1 per vertex; those on the border of a hole are cosmetic.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per triangle: 1 if it may be painted.
};

/// What a transfer decided about its target, seen but not owned.
struct DecidedView {
  std::span<const Zone> zones;                   ///< 1 per vertex: `Zones::zones`.
  std::span<const std::uint32_t> segments;       ///< 1 per vertex: `Projection::segments`.
  std::span<const std::uint8_t> culledSegments;  ///< 1 per segment: `Zones::culledSegments`.
};

/// Cuts a target along the loops that its cage projects on it, and, with `Seams::corner`, along the seams of the
/// texture, and transfers to that: step 10. Segments pass or not as they did. With `ProjectionMode::nearestVertex`
/// nothing is cut.
/// @param decided  Of a transfer to the same target with the same options.
/// @return As `transfer`; resultMismatch if `decided` is not of this target.
/// Cost: that of a transfer, and some twenty searches for a nearest point for each edge that is cut.
Status cutBorders(const MeshView& cage, const MeshView& target, const TransferOptions& options,
                  const DecidedView& decided, CutTarget& out) noexcept;

}  // namespace cagecast
