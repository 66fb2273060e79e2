#pragma once

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// Checks what every function of this library asks of a model: triangles with an area, positions that are finite and
/// not too far from the origin, a size of at least 1e-37, indices, groups, marks, joints and base colours that fit
/// together. Holes, edges of more than two triangles, several shells and triangles turned inside out are no errors.
Status checkModel(const Model& model) noexcept;

/// The same for any mesh, such as the cage of a template.
/// @param argument  What to blame.
Status checkMesh(const MeshView& mesh, Argument argument) noexcept;

/// Checks that an option is within its range; NaN is not.
Status checkOption(Option option, float value) noexcept;

}  // namespace cagecast::cages
