#pragma once

#include <vector>

#include "fit/template_cage.hpp"
#include "fit/warp.hpp"

namespace cagecast::cages {

/// A pair for each landmark; those that are not certain may stay off a little. The centre of an eye is deep inside, and
/// is left out where both corners say more.
/// @param from,to  In the same order.
/// @param withJoints  Joints count only where there is a skeleton.
std::vector<Anchor> landmarkAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                                    bool withJoints);

/// Pairs of points around the rims where both end, such as necks: front on front, back on back, the sides by length.
/// Empty if one of the two has no rim.
/// @param target  The target's skin, in the template's space.
std::vector<Anchor> rimAnchors(const TemplateCage& cage, const TriangleMesh& target, const Axes& axes);

/// Pairs along the lower edge of a jaw of which only the chin is known, as where a mouth is open or the chin double:
/// all of it moves with the chin, less and less towards the lobes of the ears. Empty if menton is known.
/// @param own  All landmarks of the template.
std::vector<Anchor> jawAnchors(const std::vector<Landmark>& own, const std::vector<Landmark>& to);

/// Pairs above and below each eye: an eye that is wider is higher, too, by as much.
std::vector<Anchor> eyeAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to, const Axes& axes);

}  // namespace cagecast::cages
