#include "search/triangle_order.hpp"

#include <cstddef>

#include "search/box.hpp"

// Tried: the surface area heuristic over bins. Its trees are no better for these queries and have half-empty leaves; a
// transfer takes 8 % longer.

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;

constexpr std::size_t kTriangleStride = sizeof(OrderedTriangle) / sizeof(float);

/// Moves the triangles that come first along the longest side of the box around all of them before `middle`. This is
/// `std::nth_element` with partitions that have no branch to mispredict.
void split(OrderedTriangle* triangles, std::uint32_t begin, std::uint32_t middle, std::uint32_t end) {
  float* const all = triangles->centre;
  float low[4];
  float high[4];
  const auto measure = [&] {
    Box box;
    for (std::uint32_t i = begin; i < end; ++i) box.grow(load(all + kTriangleStride * i));
    simd::store(low, box.low);
    simd::store(high, box.high);
  };
  measure();
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  }
  bool isBalanced = true;
  while (begin < middle && low[axis] < high[axis]) {
    // The pivot is where the middle would be if the centres were evenly spread. If the last one removed less than half
    // of the triangles, it is the middle of their box.
    const float share = isBalanced ? static_cast<float>(middle - begin) / static_cast<float>(end - begin) : 0.5f;
    const float between = low[axis] + share * (high[axis] - low[axis]);
    const float pivot = between > low[axis] ? between : high[axis];
    float* less = all + kTriangleStride * begin;
    for (float* item = less; item < all + kTriangleStride * end; item += kTriangleStride) {
      const f32x4 moved = load(item);
      const bool isLess = item[axis] < pivot;
      simd::store(item, load(less));
      simd::store(less, moved);
      less += isLess ? kTriangleStride : 0;
    }
    const std::uint32_t before = end - begin;
    const auto cut = static_cast<std::uint32_t>((less - all) / std::ptrdiff_t{kTriangleStride});
    if (cut <= middle) {
      begin = cut;
      low[axis] = pivot;
    } else {
      end = cut;
      high[axis] = pivot;
    }
    isBalanced = 2 * (end - begin) <= before;
    if (!isBalanced) measure();
  }
}

/// @param run  Triangles below one child: 4, 16, 64 …
void sort(OrderedTriangle* triangles, std::uint32_t begin, std::uint32_t end, std::uint32_t run) {
  while (run > 4 && end - begin <= run) run /= 4;
  const std::uint32_t children = (end - begin + run - 1) / run;
  if (children < 2) return;
  const std::uint32_t middle = begin + children / 2 * run;
  split(triangles, begin, middle, end);
  sort(triangles, begin, middle, run);
  sort(triangles, middle, end, run);
}

}  // namespace

void orderTriangles(OrderedTriangle* triangles, std::uint32_t count) noexcept {
  std::uint32_t run = 4;
  while (run < count) run *= 4;
  sort(triangles, 0, count, run);
}

}  // namespace cagecast
