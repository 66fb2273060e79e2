#pragma once

#include <functional>
#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// What a cage is pushed out of, in the template's space.
struct Enclosed {
  const TriangleMesh& skin;
  const TriangleMesh& hull;  ///< Skin that is farther inside than the offset, such as a mouth's, does not count.
};

/// Moves a cage outward where skin sticks out of it, by at most four times the offset and only where both face the same
/// way and no triangle folds over.
/// @param tracks  Per vertex: the only direction in which it moves; zero if it is free.
/// @param step  Called before each of the iterations, with its share; false cancels.
bool pushOut(const TemplateCage& cage, const Enclosed& inside, const std::vector<Vec3>& tracks,
             const std::function<bool(double)>& step, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
