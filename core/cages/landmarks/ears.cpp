#include <algorithm>
#include <cmath>

#include "landmarks/head.hpp"

namespace cagecast::cages {

namespace {

constexpr double kEarStep = 0.004;
/// Ears are narrower than this, from front to back; the head behind them is wider.
constexpr double kWidest = 0.125;
/// An ear stands out from the head by more than this, and ends where it does by less than a share of its own most, or
/// by less than jaws and temples may curve.
constexpr double kStandsOut = 0.01, kCurves = 0.02, kEnds = 0.4;
/// Higher areas are looked at again with a higher limit, up to a share of the most: they may reach down the jaw.
constexpr double kHigh = 0.17, kMaxEnds = 0.5;

/// How far each place stands out from the head, seen from a side: the height over what a line segment of the width
/// `kWidest` can reach from inside (a morphological top-hat, along each row).
HeightMap standingOut(const HeightMap& map) {
  const Place half{static_cast<int>(std::lround(0.5 * kWidest / kEarStep)), 0};
  HeightMap out = extremes(extremes(map, half, false), half, true);
  for (std::size_t i = 0; i < out.heights.size(); ++i) {
    const double over = map.heights[i] - out.heights[i];
    out.heights[i] = std::isfinite(over) ? over : 0;
  }
  return out;
}

/// Ears are within these limits, seen from the side: behind the eyes, and about as high as the nose.
bool inRegion(const Grid& grid, const Place& place) {
  const double z = grid.a(place.column), y = grid.b(place.row);
  return z > -0.45 && z < -0.03 && std::abs(y) < 0.2;
}

/// The largest connected area that stands out by more than a limit.
std::vector<Place> largestArea(const HeightMap& out, double limit) {
  std::vector<bool> seen(out.heights.size());
  std::vector<Place> best;
  const auto isIn = [&](const Place& place) { return inRegion(out.grid, place) && out.at(place) > limit; };
  for (int row = 0; row < out.grid.rows; ++row)
    for (int column = 0; column < out.grid.columns; ++column) {
      if (seen[out.index(column, row)] || !isIn({column, row})) continue;
      std::vector<Place> area = areaAround(out, {column, row}, isIn);
      for (const Place& place : area) seen[out.index(place.column, place.row)] = true;
      if (area.size() > best.size()) best = std::move(area);
    }
  return best;
}

/// What is an ear in a side view.
std::vector<Place> earArea(const HeightMap& map) {
  const HeightMap out = standingOut(map);
  double most = 0;
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 0; column < map.grid.columns; ++column)
      if (inRegion(map.grid, {column, row})) most = std::max(most, out.at(column, row));
  double limit = std::max(kStandsOut, std::min(kCurves, kEnds * most));
  std::vector<Place> area = largestArea(out, limit);
  constexpr double kRaise = 1.1;
  while (!area.empty() && limit * kRaise < kMaxEnds * most) {
    const auto [low, high] =
        std::minmax_element(area.begin(), area.end(), [](const Place& a, const Place& b) { return a.row < b.row; });
    if (map.grid.step * (high->row - low->row) < kHigh) break;
    limit *= kRaise;
    area = largestArea(out, limit);
  }
  return area;
}

struct Ear {
  Vec3 top, lobe, outer;
  double area = 0;  ///< As seen from the side.
};

/// @param side  1: the left ear, -1: the right one.
std::optional<Ear> findEar(const Head& head, double side, double bottom) {
  const View view{{0, 0, 1}, {0, 1, 0}, {side, 0, 0}};
  const Grid grid = Grid::over(-0.52, 0.1, bottom, 0.3, kEarStep);
  const HeightMap map = heightMapOf(head.surface, view, grid, 1.0);
  const std::vector<Place> places = earArea(map);
  if (places.empty()) return std::nullopt;
  Ear ear;
  ear.area = kEarStep * kEarStep * static_cast<double>(places.size());
  const auto point = [&](const Place& place) {
    return view.point(grid.a(place.column), grid.b(place.row), map.at(place));
  };
  double low = grid.b(grid.rows);
  ear.outer = ear.top = point(places.front());
  for (const Place& place : places) {
    const Vec3 p = point(place);
    if (p.y > ear.top.y) ear.top = p;
    low = std::min(low, p.y);
    if (side * p.x > side * ear.outer.x) ear.outer = p;
  }
  // The lobe is blunt: the middle of what is close to the lowest row.
  constexpr double kBlunt = 0.01;
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (const Place& place : places) {
    const Vec3 p = point(place);
    if (p.y > low + kBlunt) continue;
    sum = sum + p;
    ++count;
  }
  ear.lobe = {sum.x / count, low, sum.z / count};
  return ear;
}

}  // namespace

void findEars(Head& head) {
  const Spot* chin = head.find("chin");
  const double bottom = chin != nullptr ? std::max(-0.3, chin->position.y) : -0.25;
  const auto left = findEar(head, 1, bottom), right = findEar(head, -1, bottom);
  if (!left || !right) return;
  constexpr double kMinEar = 0.001, kMaxEar = 0.04;
  if (std::min(left->area, right->area) < kMinEar || std::max(left->area, right->area) > kMaxEar) return;
  const auto add = [&](const char* name, const Vec3& l, const Vec3& r) {
    const double off = length(Vec3{-l.x, l.y, l.z} - r);
    const double trust = off < 0.015 ? 0.75 : off < 0.03 ? 0.55 : 0.3;
    head.add(std::string(name) + "_left", l, trust);
    head.add(std::string(name) + "_right", r, trust);
  };
  add("ear_top", left->top, right->top);
  add("ear_lobe", left->lobe, right->lobe);
  add("ear_outer", left->outer, right->outer);
}

}  // namespace cagecast::cages
