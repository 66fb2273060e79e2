#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "mesh/surface.hpp"

namespace cagecast::cages {

/// A direction to look at a head from, in its own space: a point is `a * across + b * along + height * toward`.
struct View {
  Vec3 across, along, toward;

  [[nodiscard]] Vec3 point(double a, double b, double height) const { return a * across + b * along + height * toward; }
};

inline constexpr View kFrontView{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline constexpr View kBackView{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
inline constexpr View kTopView{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
inline constexpr View kBottomView{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};

/// A point of a grid; or how far it is to another one.
struct Place {
  int column = 0, row = 0;
};

/// A rectangle of a view: `columns` by `rows` points, `step` apart.
struct Grid {
  double a0 = 0, b0 = 0, step = 1;
  int columns = 0, rows = 0;

  /// Covers a range of both coordinates.
  static Grid over(double a0, double a1, double b0, double b1, double step) {
    return {a0, b0, step, static_cast<int>(std::lround((a1 - a0) / step)) + 1,
            static_cast<int>(std::lround((b1 - b0) / step)) + 1};
  }
  [[nodiscard]] double a(int column) const { return a0 + step * column; }
  [[nodiscard]] double b(int row) const { return b0 + step * row; }
  [[nodiscard]] int columnOf(double a) const { return static_cast<int>(std::lround((a - a0) / step)); }
  [[nodiscard]] int rowOf(double b) const { return static_cast<int>(std::lround((b - b0) / step)); }
  [[nodiscard]] bool has(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
};

/// How high the surface is above the plane of a view: the first hit of parallel rays.
struct HeightMap {
  static constexpr double kNone = -std::numeric_limits<double>::infinity();  ///< Nothing is hit.

  Grid grid;
  std::vector<double> heights;           ///< Row by row.
  std::vector<std::uint32_t> triangles;  ///< That are hit.

  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
  }
  /// `kNone` outside the grid.
  [[nodiscard]] double at(int column, int row) const {
    return grid.has(column, row) ? heights[index(column, row)] : kNone;
  }
  [[nodiscard]] double at(const Place& place) const { return at(place.column, place.row); }
  [[nodiscard]] double near(double a, double b) const { return at(grid.columnOf(a), grid.rowOf(b)); }
};

/// @param from  Height that the rays begin at.
HeightMap heightMapOf(const Surface& surface, const View& view, const Grid& grid, double from);

/// A Gaussian blur that leaves out points without a height. @param sigma  In the unit of the grid's step.
HeightMap blurred(const HeightMap& map, double sigma);

/// The greatest, or the least, height of a rectangle about each place.
/// @param half  From its middle to its sides.
HeightMap extremes(const HeightMap& map, const Place& half, bool greatest);

/// Fills what is narrower than twice `half` (a morphological closing): slits and creases.
inline HeightMap closed(const HeightMap& map, const Place& half) {
  return extremes(extremes(map, half, true), half, false);
}
/// The same in any direction. @param reach  In the unit of the grid's step.
HeightMap closed(const HeightMap& map, double reach);

/// The connected places around one, which counts in any case, at which a condition holds.
template <typename Condition>
std::vector<Place> areaAround(const HeightMap& map, const Place& start, const Condition& isIn) {
  std::vector<bool> seen(map.heights.size());
  seen[map.index(start.column, start.row)] = true;
  std::vector<Place> area = {start};
  for (std::size_t i = 0; i < area.size(); ++i)
    for (const Place& step : {Place{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Place next{area[i].column + step.column, area[i].row + step.row};
      if (!map.grid.has(next.column, next.row) || seen[map.index(next.column, next.row)] || !isIn(next)) continue;
      seen[map.index(next.column, next.row)] = true;
      area.push_back(next);
    }
  return area;
}

}  // namespace cagecast::cages
