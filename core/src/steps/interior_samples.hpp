#pragma once

#include <cstdint>

#include "cagecast/array.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Four samples inside each large triangle of a small segment near a hole. The triangle's area counts by what covers
/// them instead of those of its corners.
struct InteriorSamples {
  std::uint32_t triangleCount = 0;
  const std::uint32_t* triangles = nullptr;  ///< In `Points::triangles`, ascending.
  PointData data;                            ///< 4 points per triangle.
};

/// Step 7: finds the triangles and places the samples in them. Steps 1 to 3 have not been done for the samples yet.
void placeInteriorSamples(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats,
                          InteriorSamples& out) noexcept;

}  // namespace cagecast
