#include <algorithm>
#include <cmath>

#include "landmarks/head.hpp"

namespace cagecast::cages {

void findEyeCorners(Head& head, const Surface& all, const std::vector<bool>& isEye) {
  constexpr double kCornerStep = 0.002;
  const double reach = 1.3 * head.eyes.radius;
  for (const int i : {0, 1}) {
    const Vec3& eye = head.eyes.centres[static_cast<std::size_t>(i)];
    const double side = i == 0 ? 1 : -1;
    const Grid grid = Grid::over(eye.x - reach, eye.x + reach, eye.y - reach, eye.y + reach, kCornerStep);
    const HeightMap map = heightMapOf(all, kFrontView, grid, 0.6);
    int first = -1, last = -1;
    std::vector<double> middles(static_cast<std::size_t>(grid.columns)), lowest(middles.size());
    double area = 0;
    for (int column = 0; column < grid.columns; ++column) {
      double sum = 0, least = 1;
      int count = 0;
      for (int row = 0; row < grid.rows; ++row) {
        const std::size_t k = map.index(column, row);
        if (std::isinf(map.heights[k]) || !isEye[map.triangles[k]]) continue;
        sum += grid.b(row);
        least = std::min(least, map.heights[k]);
        ++count;
      }
      area += count;
      if (count < 2) continue;
      middles[static_cast<std::size_t>(column)] = sum / count;
      lowest[static_cast<std::size_t>(column)] = least;
      if (first < 0) first = column;
      last = column;
    }
    const int inner = side > 0 ? first : last, outer = side > 0 ? last : first;
    // Eyes that stand out freely have no corners.
    const double disc = std::acos(-1.0) * head.eyes.radius * head.eyes.radius / (kCornerStep * kCornerStep);
    if (first < 0 || first == last || area > 0.85 * disc) continue;
    // The lids meet behind what is seen, about beside the middle of the front half of the eyeball. A visible end far
    // from there is that of an eye that is no ball.
    const auto corner = [&](int column) {
      constexpr double kAside = 1.04, kBefore = 0.45;  // Radii.
      constexpr double kBall = 0.3;
      const auto k = static_cast<std::size_t>(column);
      const double aside = (grid.a(column) - eye.x) / head.eyes.radius;
      if (std::abs(aside) < kBall || std::abs(aside) > kAside) return Vec3{grid.a(column), middles[k], lowest[k]};
      return Vec3{eye.x + std::copysign(kAside, aside) * head.eyes.radius, middles[k],
                  eye.z + kBefore * head.eyes.radius};
    };
    const std::string suffix = i == 0 ? "_left" : "_right";
    head.add("eye_inner" + suffix, corner(inner), 0.75);
    head.add("eye_outer" + suffix, corner(outer), 0.75);
  }
}

}  // namespace cagecast::cages
