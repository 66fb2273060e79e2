#pragma once

#include "cagecast/mesh.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

/// The power of two that brings the target's diagonal to 1..2, and what follows from it.
/// Scaling by a power of two is exact, so every decision is the same in any unit, and no square leaves the range of a
/// float.
struct Units {
  float scale = 1;  ///< Multiplies input coordinates. Everything inside works in scaled units.
  double diagonal =
      0;  ///< Of the target's bounding box, scaled: 1..2 (0 if the target is one point, up to 14 beyond 1e38).
  float low[3] = {};  ///< The target's bounding box, scaled.
  float high[3] = {};
  float reach = 0;  ///< The longest side of the box around cage and target together, scaled; more if that is far off.
};

/// Checks everything that is asked of an input; after it, nothing inside can fail but memory.
/// @param[out] units  Valid if the status is ok.
Status checkInput(const MeshView& cage, const MeshView& target, const ProjectOptions& options, Units& units) noexcept;

Status checkClassifyOptions(const ClassifyOptions& options) noexcept;

}  // namespace cagecast
