#pragma once

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"

namespace cagecast::cages {

/// The axes of the file that are up and front of a model.
struct Stance {
  Vec3 up{0, 1, 0}, front{0, 0, 1};
};

/// As the bones tell it of a figure that stands, with any axis up; y and z of any other model.
Stance stanceOf(const Model& model);

/// What a model seems to be, by the names of its joints and parts and by its proportions.
/// A body stands: it is much taller than deep, or taller than deep and has the joints of legs. A head is about as tall
/// as deep, and has a part that only heads have, or an open border at its bottom. Anything else is a prop.
/// @param model  Checked by `checkModel`.
Kind kindOf(const Model& model);

/// Whether a prop is a head if it turns out to have eyes: it is as compact as one, and has no legs and no wheels.
bool isCompactProp(const Model& model);

}  // namespace cagecast::cages
