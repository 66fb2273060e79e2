#pragma once

#include "base/list.hpp"
#include "clip/border_classifier.hpp"

namespace cagecast {

/// Weights are whole multiples of this, so that they add up to 1 exactly.
inline constexpr double kWeightUnit = 1.0 / (1 << 24);

/// A target whose triangles are cut; its vertices keep their numbers, new ones come after them.
struct CutTriangles {
  List<std::uint32_t> sources;  ///< 3 per new vertex.
  List<float> weights;          ///< 3 per new vertex.
  List<std::uint8_t> onBorder;  ///< 1 per vertex: 1 if it lies on a border.
  List<std::uint32_t> indices;  ///< 3 per triangle.
  List<std::uint32_t> origins;  ///< 1 per triangle: that of the target which it is a part of.
  List<std::uint32_t> sides;    ///< 1 per triangle: the side that it lies on, see `Look`.

  [[nodiscard]] bool failed() const noexcept {
    return sources.failed() || weights.failed() || onBorder.failed() || indices.failed() || origins.failed() ||
           sides.failed();
  }
};

/// Step 10: cuts the triangles of the target along the loops, or the seams, that the cage projects on it.
/// @param takesPart  1 per vertex of the target: an edge is cut if both its ends have 1 here.
/// @param diagonal   Of the target as it was given, scaled.
/// @return false if memory ran out.
/// Cost: some twenty searches for a nearest point for each edge that is cut.
bool cutTriangles(const MeshView& target, double scale, double diagonal, const std::uint8_t* takesPart,
                  BorderClassifier& classifier, Arena& arena, CutTriangles& out) noexcept;

}  // namespace cagecast
