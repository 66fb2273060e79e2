#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "views/height_map.hpp"

namespace cagecast::cages {

/// A height along a line, in steps: a section of a head.
class Curve {
 public:
  Curve(double from, double step, std::vector<double> heights)
      : from_(from), step_(step), heights_(std::move(heights)) {}

  /// The median of the columns of a narrow map: `along` becomes the curve's coordinate.
  static Curve along(const HeightMap& map);

  [[nodiscard]] int count() const { return static_cast<int>(heights_.size()); }
  /// Interpolated; `HeightMap::kNone` where there is nothing.
  [[nodiscard]] double at(double place) const;
  /// The change of the height by that of the place, over +-reach.
  [[nodiscard]] double slope(double place, double reach) const;
  /// How much higher the curve is on both sides than here: positive in grooves.
  [[nodiscard]] double hollow(double place, double reach) const {
    return 0.5 * (at(place - reach) + at(place + reach)) - at(place);
  }
  [[nodiscard]] Curve blurred(double sigma) const;

  /// The place in a range where a function is greatest; nothing if it is nowhere finite.
  [[nodiscard]] std::optional<double> greatest(double low, double high,
                                               const std::function<double(double)>& function) const;
  /// The place in a range where the curve is highest, as seen along a direction `tilt` upward from the view's
  /// (radians).
  [[nodiscard]] std::optional<double> highest(double low, double high, double tilt = 0) const;

 private:
  double from_, step_;
  std::vector<double> heights_;
};

}  // namespace cagecast::cages
