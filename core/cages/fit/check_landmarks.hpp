#pragma once

#include <string>
#include <vector>

#include "fit/template_cage.hpp"
#include "fit/warp.hpp"

namespace cagecast::cages {

/// Checks a list of landmarks by itself: finite, named, no name twice, no two on one spot.
/// @param name  What to call the list: "landmarks".
/// @param size  The size of the model, by which spots are told apart.
Outcome checkLandmarkList(const std::vector<Landmark>& landmarks, const char* name, double size, Problem problem);

/// Checks that landmarks of a model are where those of a template can be after turning and scaling.
/// @param from,to  In the same order.
/// @param given  Whether a person gave it.
Outcome checkAgreement(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                       const std::vector<bool>& given, double diagonal);

}  // namespace cagecast::cages
