#pragma once

#include "cagecast/status.hpp"
#include "clip/border_classifier.hpp"

namespace cagecast {

inline constexpr Status kOutOfMemory{Code::outOfMemory};

/// Where a vertex of a clipped target lies with respect to the boundary loops.
enum class LoopSide : std::uint8_t { covered, onBorder, beyond };

/// A target with its triangles cut.
struct ClippedMesh {
  Array<float> positions;        ///< 3 per vertex: those of the target, then the new ones.
  Array<std::uint32_t> sources;  ///< As in `CutTarget`, like the next three.
  Array<float> weights;
  Array<std::uint32_t> indices;
  Array<std::uint32_t> origins;
  Array<LoopSide> loopSides;      ///< 1 per vertex.
  Array<std::uint8_t> areBeyond;  ///< 1 per triangle: 1 if it lies beyond a boundary loop.
};

/// Cuts a target along the boundary loops of the cage, and then, if the cage has charts, what is not beyond
/// the loops along the seams.
/// @param[in,out] takesPart  1 per vertex of the target: an edge is cut if both its ends have 1 here. Vertices with
/// equal positions get the same value, 1 if any has it.
/// @return outOfMemory or bordersTooComplex; `out` is of no use then.
Status clipTarget(const ClipCage& cage, const MeshView& target, std::uint8_t* takesPart, Arena& arena,
                  ClippedMesh& out) noexcept;

}  // namespace cagecast
