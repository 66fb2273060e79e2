#pragma once

#include <cstddef>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// Limit of triangles and of vertices of a model: beyond it a call would take minutes in a page.
inline constexpr std::size_t kMaxModelTriangles = 2'000'000;
inline constexpr std::size_t kMaxModelVertices = 6'000'000;

/// Checks what every function of this library asks of a model: triangles with an area, positions that are finite and
/// not too far from the origin, a size of at least 1e-37, indices, groups, marks and joints that fit together. Holes,
/// edges of more than two triangles, several shells and triangles turned inside out are no errors.
/// @return Problem::badModel with a sentence that begins with "model".
Outcome checkModel(const Model& model);

/// The same for any mesh, such as the cage of a template.
/// @param name  What to call it: "template.cage".
/// @param problem  What to return if something is wrong.
Outcome checkMesh(const MeshView& mesh, const char* name, Problem problem);

/// Checks that an option is within its range; NaN is not.
/// @return Problem::badOptions with "options.closing = 0.5 is not within 0.0005..0.2".
Outcome checkOption(const char* name, double value, double least, double most);

}  // namespace cagecast::cages
