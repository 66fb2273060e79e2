#pragma once

#include <cstdint>
#include <span>

#include "geometry/vec3.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// To which side the points of the target face.
struct Facing {
  Vec3* normals = nullptr;     ///< 1 per point: of unit length, or zero if the normals of its triangles cancel out.
  bool* isTwoSided = nullptr;  ///< 1 per point: whether it faces to the other side as well.
  bool* isTurned = nullptr;    ///< 1 per segment: whether its points face against their normals, as in a segment with
                               ///< reversed winding: by area, its normals disagree with those of the cage.
};

/// Finds the facing of the points of some segments. A normal is the sum of the area normals at the point. Where all
/// triangles have copies in reverse winding and so cancel out, an occluded point is two-sided: its normal is the sum of
/// the normals turned to the side of its largest triangle.
/// @param isChosen    1 per segment.
/// @param isOccluded  1 per point: these have no say in `isTurned`.
/// @param[out] out    Allocated from the scene's arena.
void findFacing(const Scene& scene, const PointData& data, std::span<const bool> isChosen, const bool* isOccluded,
                Facing& out) noexcept;

}  // namespace cagecast
