#pragma once

namespace cagecast {

/// The power of two that brings the target's diagonal to 1..2, and what follows from it. Everything inside the core is
/// in such scaled units. Scaling by a power of two is exact, so every decision is the same in any unit of the input,
/// and no square leaves the range of a float.
struct Units {
  float scale = 1;  ///< Multiplies input coordinates.
  /// Of the target's bounding box, scaled: 1..2; 0 if the target is a single point.
  double diagonal = 0;
  float low[3] = {};  ///< The target's bounding box, scaled.
  float high[3] = {};
  /// The longest side of the box around cage and target, scaled; more if that box is far from the origin.
  float sceneSize = 0;

  /// What turns a scaled area into one in squared units of the input.
  [[nodiscard]] double areaToInput() const noexcept { return 1.0 / scale / scale; }
};

}  // namespace cagecast
