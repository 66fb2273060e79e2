#pragma once

#include <limits>

#include "search/node.hpp"
#include "simd/simd.hpp"

namespace cagecast {

/// An axis-aligned box. The fourth lane is not used.
struct Box {
  simd::f32x4 low = simd::splat(std::numeric_limits<float>::infinity());
  simd::f32x4 high = simd::splat(-std::numeric_limits<float>::infinity());

  /// A coordinate that is far from everything; its square is still finite.
  static constexpr float kFar = 1e15f;
  /// How much larger than its contents a box is made, as a share of the scene's size. The ray kernel rounds coordinates
  /// relative to the ray's origin by at most 2^-23 of that size, and this is eight times as much. The lattice tests
  /// fail without it.
  static constexpr float kPadding = 1e-6f;

  static Box farAway() {
    Box box;
    box.low = box.high = simd::splat(kFar);
    return box;
  }
  void grow(simd::f32x4 p) {
    low = simd::min(low, p);
    high = simd::max(high, p);
  }
  void grow(const Box& other) {
    low = simd::min(low, other.low);
    high = simd::max(high, other.high);
  }
  /// The box with a margin on all sides.
  [[nodiscard]] Box padded(float margin) const {
    // The second term is two ulps of the largest coordinate: far from the origin the margin alone would be rounded
    // away.
    const simd::f32x4 most = simd::max(simd::splat(0) - low, high);
    const simd::f32x4 pad = simd::splat(margin) + most * simd::splat(2.4e-7f);
    Box box;
    box.low = low - pad;
    box.high = high + pad;
    return box;
  }
};

/// Sets the boxes of a node's children.
inline void setBoxes(Node& node, const Box (&boxes)[4]) {
  simd::f32x4 low[4] = {boxes[0].low, boxes[1].low, boxes[2].low, boxes[3].low};
  simd::f32x4 high[4] = {boxes[0].high, boxes[1].high, boxes[2].high, boxes[3].high};
  simd::transpose(low[0], low[1], low[2], low[3]);
  simd::transpose(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 3; ++k) {
    simd::store(node.low[k], low[k]);
    simd::store(node.high[k], high[k]);
  }
}

}  // namespace cagecast
