#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "input/cage.hpp"
#include "search/ray.hpp"
#include "steps/point_data.hpp"

namespace cagecast {

/// Makes the ray that steps 2 and 3 send from a point: along the normal of its cage triangle, without end.
inline void setNormalRay(Ray& ray, const PointData& data, const Cage& cage, std::uint32_t point) {
  // Field by field: a ray that is copied as a whole right after it was written waits for those writes.
  static constexpr float kNoLow[3] = {};
  const Points& points = data.points;
  ray.direction = &cage.triangles[data.cageTriangles[point]].normal;
  ray.startAt(points.at(point), points.positionLow == nullptr ? kNoLow : points.positionLow + std::size_t{3} * point);
  ray.end = std::numeric_limits<double>::infinity();
}

}  // namespace cagecast
