#pragma once

#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// The target in the template's space.
struct EyedFigure {
  TriangleMesh mesh;                      ///< Without excluded parts other than eyes.
  std::vector<bool> isEye;                ///< Per triangle: by the name of its part.
  std::vector<std::uint32_t> components;  ///< Per triangle.
  TriangleMesh covers;                    ///< What is excluded and no eye: lashes, brows, hair.
  std::vector<std::uint32_t> coverComponents;
};

/// Draws the borders of eye holes to the contours of what is visible of the eyes, seen along the direction in which
/// they look, with lashes as far as there is room. Where a model has no eyes of their own, holes stay where they are.
/// @param from,to  Landmarks of the template and of the target, both in the template's space.
/// @return Per vertex of the cage: the direction in which its eye looks if it is on the border of a hole that was
///   drawn, else zero.
std::vector<Vec3> fitEyeHoles(const TemplateCage& cage, const EyedFigure& figure, const std::vector<Landmark>& from,
                              const std::vector<Landmark>& to, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
