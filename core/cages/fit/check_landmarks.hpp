#pragma once

#include <string>
#include <vector>

#include "fit/template_cage.hpp"
#include "fit/warp.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

/// Checks a list of landmarks by itself: not too many, finite, named, near its model, no name twice, no two on one
/// spot.
/// @param argument  What to blame.
/// @param box  Of the model.
Status checkLandmarkList(const std::vector<Landmark>& landmarks, Argument argument, const Bounds& box);

/// Checks that joints among the landmarks of a model, which its skeleton may have told, are in the unit of its mesh.
/// @param box  Of the mesh.
/// @return `at` is a place in the list.
Status checkJoints(const std::vector<Landmark>& landmarks, const Bounds& box);

/// Checks that landmarks of a model are where those of a template can be after turning and scaling.
/// @param from,to  In the same order.
/// @param given  Whether a person gave it.
/// @return `at` is a place in these lists.
Status checkAgreement(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                      const std::vector<bool>& given, double diagonal);

}  // namespace cagecast::cages
