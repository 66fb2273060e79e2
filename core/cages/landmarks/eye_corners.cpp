#include <algorithm>
#include <cmath>

#include "landmarks/head.hpp"

namespace cagecast::cages {

void findEyeCorners(Head& head, const Surface& all, const std::vector<bool>& isEye) {
  constexpr double kStep = 0.002;
  const double reach = 1.3 * head.eyes.radius;
  for (const int i : {0, 1}) {
    const Vec3& eye = head.eyes.centres[static_cast<std::size_t>(i)];
    const double side = i == 0 ? 1 : -1;
    const Grid grid = Grid::over(eye.x - reach, eye.x + reach, eye.y - reach, eye.y + reach, kStep);
    const HeightMap map = look(all, kFrontView, grid, 0.6);
    int inner = -1, outer = -1;
    std::vector<double> middles(static_cast<std::size_t>(grid.columns)), heights(middles.size());
    double area = 0;
    for (int column = 0; column < grid.columns; ++column) {
      double sum = 0, height = 0;
      int count = 0;
      for (int row = 0; row < grid.rows; ++row) {
        const std::size_t k = map.index(column, row);
        if (std::isinf(map.heights[k]) || !isEye[map.triangles[k]]) continue;
        sum += grid.b(row);
        height += map.heights[k];
        ++count;
      }
      area += count;
      if (count < 2) continue;
      middles[static_cast<std::size_t>(column)] = sum / count;
      heights[static_cast<std::size_t>(column)] = height / count;
      const bool nearer = side > 0;
      if (inner < 0) inner = column;
      if (!nearer) inner = column;
      if (nearer) outer = column;
      if (outer < 0) outer = column;
    }
    // Eyes that stand out freely have no corners.
    const double disc = std::acos(-1.0) * head.eyes.radius * head.eyes.radius / (kStep * kStep);
    if (inner < 0 || outer == inner || area > 0.85 * disc) continue;
    const auto corner = [&](int column) {
      const auto k = static_cast<std::size_t>(column);
      return Vec3{grid.a(column), middles[k], heights[k]};
    };
    const std::string suffix = i == 0 ? "_left" : "_right";
    head.add("eye_inner" + suffix, corner(inner), 0.75);
    head.add("eye_outer" + suffix, corner(outer), 0.75);
  }
}

}  // namespace cagecast::cages
