#include <algorithm>
#include <array>
#include <cmath>

#include "landmarks/head.hpp"

namespace cagecast::cages {

namespace {

constexpr double kMouthStep = 0.003;
constexpr double kBlur = 0.002;
/// Half the width of the crease that closed lips make.
constexpr double kCrease = 0.008;

/// The middle line between the lips, followed outward from the midline; its end is the corner.
/// @param side  1: the left corner, -1: the right one.
std::optional<Vec3> follow(const HeightMap& map, double start, double side) {
  const auto depth = [&](double x, double y, double reach) {
    const double here = map.near(side * x, y);
    const double over = map.near(side * x, y + reach), under = map.near(side * x, y - reach);
    // A hole has no bottom that could be seen.
    if (std::isinf(here)) return 0.03;
    return std::isfinite(over) && std::isfinite(under) ? std::min(0.03, 0.5 * (over + under) - here) : 0.0;
  };
  constexpr double kClimb = 0.006;   ///< Up or down, at most, for a step outward.
  constexpr double kLongest = 0.16;  ///< Half a mouth.
  double y = start, typical = 0;
  Vec3 end{0, start, 0};
  int weak = 0;
  for (double x = 0; x < kLongest; x += kMouthStep) {
    double best = -1, bestY = y;
    for (double d = -kClimb; d <= kClimb + 1e-9; d += kMouthStep) {
      const double value = depth(x, y + d, kCrease) - 0.02 * std::abs(d);
      if (value > best) {
        best = value;
        bestY = y + d;
      }
    }
    if (x < 0.025) typical = std::max(typical, best);
    const bool creased = best > std::max(0.0008, 0.22 * std::min(typical, 0.01));
    weak = creased ? 0 : weak + 1;
    if (weak > 2) break;
    y = bestY;
    if (creased) end = {side * x, y, map.near(side * x, y)};
  }
  if (std::abs(end.x) < 0.02 || std::abs(end.x) > 0.14 || !std::isfinite(end.z)) return std::nullopt;
  return end;
}

/// The corners of a gaping mouth: the ends of what lies behind a surface that bridges it from lip to lip.
std::array<std::optional<Vec3>, 2> gapEnds(const HeightMap& map, double top, double bottom, double middle) {
  constexpr double kBehind = 0.012;
  const Grid& grid = map.grid;
  // A morphological closing along the columns, by a segment that is longer than the gap.
  const int half = static_cast<int>(std::ceil(0.5 * (1.15 * (top - bottom) + 0.01) / kMouthStep));
  const HeightMap bridged = closed(map, Place{0, half});
  const std::vector<Place> gap = areaAround(map, {grid.columnOf(0), grid.rowOf(middle)}, [&](const Place& place) {
    return bridged.at(place) - map.at(place) > kBehind;
  });
  const auto [first, last] =
      std::minmax_element(gap.begin(), gap.end(), [](const Place& a, const Place& b) { return a.column < b.column; });
  const int columns[] = {last->column, first->column};
  std::array<std::optional<Vec3>, 2> out;
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
    double rows = 0, count = 0;
    for (const auto& [column, row] : gap) {
      if (std::abs(column - columns[i]) > 1) continue;
      rows += row;
      ++count;
    }
    const double x = grid.a(columns[i]) + (i == 0 ? kMouthStep : -kMouthStep), y = grid.b0 + grid.step * rows / count;
    const double z = map.near(x, y);
    if (std::isfinite(z) && std::abs(x) > 0.02 && std::abs(x) < 0.14) out[i] = Vec3{x, y, z};
  }
  return out;
}

}  // namespace

void findMouthCorners(Head& head) {
  if (!head.mouth) return;
  constexpr double kGaping = 0.025;
  constexpr double kAround = 0.08;
  const MouthLine& line = *head.mouth;
  const Grid grid = Grid::over(-0.18, 0.18, line.bottom - kAround, line.top + kAround, kMouthStep);
  const HeightMap map = heightMapOf(head.surface, kFrontView, grid, 0.6);
  std::array<std::optional<Vec3>, 2> ends;
  const Spot *left = head.hint("mouth_corner_left"), *right = head.hint("mouth_corner_right");
  if (left != nullptr && right != nullptr) {
    ends = {left->position, right->position};
  } else if (line.top - line.bottom > kGaping) {
    ends = gapEnds(map, line.top, line.bottom, 0.5 * (line.top + line.bottom));
  } else {
    const HeightMap smooth = blurred(map, kBlur);
    ends = {follow(smooth, line.crease, 1), follow(smooth, line.crease, -1)};
  }
  if (!ends[0] || !ends[1]) return;
  // On the skin, not in the crease.
  const HeightMap skin = closed(map, 0.009);
  for (std::optional<Vec3>& end : ends) end->z = skin.near(end->x, end->y);
  // Mouths may be crooked, but not by much: what differs has followed a fold of the cheek.
  const double off = std::hypot(ends[0]->x + ends[1]->x, ends[0]->y - ends[1]->y);
  const double trust = off < 0.01 ? 0.75 : off < 0.02 ? 0.6 : 0.3;
  head.add("mouth_corner_left", *ends[0], trust);
  head.add("mouth_corner_right", *ends[1], trust);
}

}  // namespace cagecast::cages
