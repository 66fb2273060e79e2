#pragma once

#include "clip/border_classifier.hpp"

namespace cagecast {

/// Where a vertex of a cut target lies.
enum class BoundarySide : std::uint8_t { inside, onBorder, beyond };

/// A target with its triangles cut.
struct CutMesh {
  Array<float> positions;        ///< 3 per vertex: those of the target, then the new ones.
  Array<std::uint32_t> sources;  ///< The fields from here are those of `CutTarget`.
  Array<float> weights;
  Array<std::uint32_t> indices;
  Array<std::uint32_t> origins;
  Array<BoundarySide> vertexSides;  ///< 1 per vertex.
  Array<std::uint8_t> areBeyond;    ///< 1 per triangle: 1 if it lies beyond a loop.
};

/// Step 10: cuts the target along the loops, and then, if there is an charts, what is not beyond them along the seams.
/// @param[in,out] takesPart  1 per vertex of the target: an edge is cut if both its ends have 1 here. Those in one
/// place get the same.
/// @return false if memory ran out.
bool cutTarget(const MeshView& cageMesh, const MeshView& target, const Cage& cage, const CageTree& tree,
               const BoundaryLoops& loops, const UvCharts* charts, const Units& units, std::uint8_t* takesPart,
               Arena& arena, CutMesh& out) noexcept;

}  // namespace cagecast
