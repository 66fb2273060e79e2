#pragma once

#include <string>
#include <vector>

#include "fit/template_cage.hpp"
#include "fit/warp.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

/// Two landmarks that are closer than this share of the diagonal are on one spot, and count once.
constexpr double kOneSpot = 1e-3;

/// Checks a list of landmarks by itself: not too many, finite, named, near its model, no name twice, no two on one
/// spot.
/// @param name  What to call the list: "landmarks".
/// @param box   Of the model.
Outcome checkLandmarkList(const std::vector<Landmark>& landmarks, const char* name, const Bounds& box, Problem problem);

/// Checks that joints among the landmarks of a model, which its skeleton may have told, are in the unit of its mesh.
/// @param box  Of the mesh.
Outcome checkJoints(const std::vector<Landmark>& landmarks, const Bounds& box);

/// Checks that landmarks of a model are where those of a template can be after turning and scaling.
/// @param from,to  In the same order.
/// @param given  Whether a person gave it.
Outcome checkAgreement(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                       const std::vector<bool>& given, double diagonal);

}  // namespace cagecast::cages
