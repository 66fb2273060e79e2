#include "views/height_map.hpp"

#include <algorithm>

namespace cagecast::cages {

namespace {

/// Blurs along one direction. @param stride  Between neighbours; `count` of them in a line.
void blurLine(const double* in, double* out, std::size_t stride, std::size_t count,
              const std::vector<double>& weights) {
  const auto reach = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0, total = 0;
    for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
      const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) + d;
      if (k < 0 || k >= static_cast<std::ptrdiff_t>(count)) continue;
      const double height = in[static_cast<std::size_t>(k) * stride];
      if (std::isinf(height)) continue;
      const double weight = weights[static_cast<std::size_t>(d < 0 ? -d : d)];
      sum += weight * height;
      total += weight;
    }
    // Points without a height stay so.
    out[i * stride] = std::isinf(in[i * stride]) ? HeightMap::kNone : sum / total;
  }
}

}  // namespace

HeightMap heightMapOf(const Surface& surface, const View& view, const Grid& grid, double from) {
  HeightMap out;
  out.grid = grid;
  std::vector<SurfaceRay> rays;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      rays.push_back({view.point(grid.a(column), grid.b(row), from), -1 * view.toward});
  for (const RayHit& hit : surface.trace(rays)) {
    out.heights.push_back(std::isinf(hit.distance) ? HeightMap::kNone : from - hit.distance);
    out.triangles.push_back(hit.triangle);
  }
  return out;
}

HeightMap blurred(const HeightMap& map, double sigma) {
  std::vector<double> weights;
  const double inSteps = sigma / map.grid.step;
  for (int d = 0; d <= static_cast<int>(std::ceil(3 * inSteps)); ++d)
    weights.push_back(std::exp(-0.5 * (d / inSteps) * (d / inSteps)));
  HeightMap out = map;
  const auto columns = static_cast<std::size_t>(map.grid.columns), rows = static_cast<std::size_t>(map.grid.rows);
  std::vector<double> half(map.heights.size());
  for (std::size_t row = 0; row < rows; ++row)
    blurLine(map.heights.data() + row * columns, half.data() + row * columns, 1, columns, weights);
  for (std::size_t column = 0; column < columns; ++column)
    blurLine(half.data() + column, out.heights.data() + column, columns, rows, weights);
  return out;
}

HeightMap extremes(const HeightMap& map, const Place& half, bool greatest) {
  HeightMap out = map;
  // Those of a rectangle are those of its rows, then of its columns.
  for (const Place& along : {Place{1, 0}, Place{0, 1}}) {
    const HeightMap from = out;
    const int reach = along.column * half.column + along.row * half.row;
    for (int row = 0; row < map.grid.rows; ++row)
      for (int column = 0; column < map.grid.columns; ++column) {
        double& value = out.heights[map.index(column, row)];
        for (int d = -reach; d <= reach; ++d) {
          const Place other{column + d * along.column, row + d * along.row};
          if (!map.grid.has(other.column, other.row)) continue;
          value = greatest ? std::max(value, from.at(other)) : std::min(value, from.at(other));
        }
      }
  }
  return out;
}

HeightMap closed(const HeightMap& map, double reach) {
  const int half = static_cast<int>(std::lround(reach / map.grid.step));
  return closed(map, Place{half, half});
}

}  // namespace cagecast::cages
