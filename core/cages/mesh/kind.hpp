#pragma once

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// What a model seems to be, by the names of its joints and parts and by its proportions; y is up.
/// A body stands: it is much taller than deep, or taller than deep and has the joints of legs. A head is about as tall
/// as deep, and has a part that only heads have, or an open border at its bottom. Anything else is a prop.
/// @param model  Checked by `checkModel`.
Kind kindOf(const Model& model);

}  // namespace cagecast::cages
