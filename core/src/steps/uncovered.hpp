#pragma once

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Step 6: finds how far along its ray the cage is, for the points of which step 1 does not know it. Without
/// a reach it does nothing.
void findCageDistances(const Scene& scene, PointData& data) noexcept;

/// Step 3: marks the points, other than occluded ones, whose ray leaves through a hole of the cage. Step 6 spares
/// those that poke out of the cage by no more than `pokeThrough`, away from boundary loops. Step 10 may recover those
/// that are marked.
void markUncovered(const Scene& scene, PointData& data) noexcept;

}  // namespace cagecast
