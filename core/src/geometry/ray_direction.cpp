#include "geometry/ray_direction.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast {

RayDirection RayDirection::along(Vec3 unit) noexcept {
  const auto x = static_cast<float>(unit.x);
  const auto y = static_cast<float>(unit.y);
  const auto z = static_cast<float>(unit.z);
  const float row[] = {x, y, z, x, y};  // x and y are repeated so that the next two axes always follow.
  RayDirection ray{{}, unit};
  Rough& rough = ray.rough;
  // A component of 0 gives a large finite number, so that 0 · inverse is 0 and not NaN.
  for (int k = 0; k < 3; ++k) rough.inverse[k] = std::copysign(1 / std::max(std::abs(row[k]), 1e-20f), row[k]);
  // Without branches, which could not be predicted: rays go in all directions.
  const auto second = static_cast<std::uint32_t>(std::abs(y) > std::abs(x));
  rough.z = second + (2 - second) * static_cast<std::uint32_t>(std::abs(z) > std::max(std::abs(x), std::abs(y)));
  rough.scaleZ = -rough.inverse[rough.z];
  rough.shearX = row[rough.z + 1] * rough.scaleZ;
  rough.shearY = row[rough.z + 2] * rough.scaleZ;
  return ray;
}

}  // namespace cagecast
