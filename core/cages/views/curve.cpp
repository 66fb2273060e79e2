#include "views/curve.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast::cages {

Curve Curve::along(const HeightMap& map) {
  std::vector<double> heights;
  for (int row = 0; row < map.grid.rows; ++row) {
    std::vector<double> across;
    across.reserve(static_cast<std::size_t>(map.grid.columns));
    for (int column = 0; column < map.grid.columns; ++column) across.push_back(map.at(column, row));
    const auto middle = across.begin() + map.grid.columns / 2;
    std::nth_element(across.begin(), middle, across.end());
    heights.push_back(*middle);
  }
  return {map.grid.b0, map.grid.step, std::move(heights)};
}

double Curve::at(double place) const {
  const double steps = (place - from_) / step_;
  const double floor = std::floor(steps);
  if (floor < 0 || floor + 1 >= static_cast<double>(heights_.size())) return HeightMap::kNone;
  const auto i = static_cast<std::size_t>(floor);
  if (std::isinf(heights_[i]) || std::isinf(heights_[i + 1])) return HeightMap::kNone;
  const double t = steps - floor;
  return (1 - t) * heights_[i] + t * heights_[i + 1];
}

double Curve::slope(double place, double reach) const { return (at(place + reach) - at(place - reach)) / (2 * reach); }

Curve Curve::blurred(double sigma) const {
  HeightMap map;
  map.grid = {0, from_, step_, 1, count()};
  map.heights = heights_;
  return {from_, step_, cages::blurred(map, sigma).heights};
}

std::optional<double> Curve::greatest(double low, double high, const std::function<double(double)>& function) const {
  std::optional<double> best;
  double most = 0;
  const auto steps = static_cast<int>(std::floor((high - low) / step_ + 1e-9));
  for (int i = 0; i <= steps; ++i) {
    const double place = low + step_ * i;
    const double value = function(place);
    if (!std::isfinite(value) || (best && value <= most)) continue;
    best = place;
    most = value;
  }
  return best;
}

std::optional<double> Curve::highest(double low, double high, double tilt) const {
  const double c = std::cos(tilt), s = std::sin(tilt);
  return greatest(low, high, [&](double place) { return c * at(place) + s * place; });
}

}  // namespace cagecast::cages
