#include "leaf_box.hpp"

#include <cmath>
#include <limits>

#include "kd_tree.hpp"

namespace cagecast {
namespace {

/// Of unit normals added up, a length that says no direction any more.
constexpr float kNoDirection = 0.1f;

using simd::f32x4;
using simd::load;

}  // namespace

LeafBox boxAround(const NearLeaf& leaf, const CageTriangle* const (&triangles)[4], const float* middle, float padding) noexcept {
  // One axis along the longest edge of the first triangle, one as near to the normals of all as that allows.
  float x[3];
  float z[3];
  float along = 0;
  for (int k = 0; k < 3; ++k) {
    const float* normals = leaf.axes[2][k];
    x[k] = leaf.axes[0][k][0];
    z[k] = normals[0] + normals[1] + normals[2] + normals[3];
    along += z[k] * x[k];
  }
  float squared = 0;
  for (int k = 0; k < 3; ++k) {
    z[k] -= along * x[k];
    squared += z[k] * z[k];
  }
  const float size = std::sqrt(squared);
  LeafBox box{};
  for (int k = 0; k < 3; ++k) {
    z[k] = size > kNoDirection ? z[k] / size : leaf.axes[2][k][0];
    box.axes[k][0] = x[k];
    box.axes[k][2] = z[k];
  }
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    const int m = (k + 2) % 3;
    box.axes[k][1] = z[l] * x[m] - z[m] * x[l];
  }
  f32x4 low = simd::splat(std::numeric_limits<float>::infinity());
  f32x4 high = simd::splat(-std::numeric_limits<float>::infinity());
  for (const CageTriangle* triangle : triangles) {
    for (const float* corner : {triangle->a, triangle->b, triangle->c}) {
      const f32x4 offset = load(corner) - load(middle);
      const f32x4 place = simd::splatLane<0>(offset) * load(box.axes[0]) + simd::splatLane<1>(offset) * load(box.axes[1]) +
                          simd::splatLane<2>(offset) * load(box.axes[2]);
      low = simd::min(low, place);
      high = simd::max(high, place);
    }
  }
  simd::store(box.low, low - simd::splat(padding));
  simd::store(box.high, high + simd::splat(padding));
  return box;
}

}  // namespace cagecast
