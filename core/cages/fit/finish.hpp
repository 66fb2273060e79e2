#pragma once

#include <functional>
#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// Moves a cage outward where skin sticks out of it, by at most four times the offset and only where both face the same
/// way and no triangle folds over.
/// @param skin  The target, in the template's space.
/// @param hull  Skin that is farther inside than the offset, such as a mouth's, does not count.
/// @param step  Called before each of the iterations, with its share; false cancels.
bool pushOut(const TemplateCage& cage, const TriangleMesh& skin, const TriangleMesh& hull,
             const std::function<bool(double)>& step, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
