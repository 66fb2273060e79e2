#pragma once

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Before step 2′: finds how far along its ray the cage is, for the points of which step 1 does not know it. Without
/// step 2′ it does nothing.
void findCageDistances(const Scene& scene, PointData& data) noexcept;

/// Step 3: marks the points, other than occluded ones, whose ray leaves through a hole of the cage. Step 3′ spares
/// those that poke out of the cage by no more than `pokeThrough`. Steps 7 and 10 may make them cosmetic again.
void markUncovered(const Scene& scene, PointData& data) noexcept;

}  // namespace cagecast
