#pragma once

#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// The target without what sticks out of it, in the template's space.
struct EyedFigure {
  TriangleMesh mesh;
  std::vector<bool> isEye;                ///< Per triangle: by the name of its part.
  std::vector<std::uint32_t> components;  ///< Per triangle.
};

/// Draws the borders of eye holes to the contours of what is visible of the eyes, seen along the direction in which
/// they look. Where a model has no eyes of their own, holes stay where they are.
/// @param from,to  Landmarks of the template and of the target, both in the template's space.
/// @return Per vertex of the cage: whether it was moved.
std::vector<bool> fitEyeHoles(const TemplateCage& cage, const EyedFigure& figure, const std::vector<Landmark>& from,
                              const std::vector<Landmark>& to, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
