#include <cmath>
#include <limits>

#include "kd_tree.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// What the kernel below may be off, as a share of the distance and of the cage's extent: it rounds a dozen times, each time
/// by 2^-24 of one of them.
constexpr double kRounding = 1e-6;

/// Squared distance of p to four boxes.
f32x4 squaredDistanceToBoxes(const Node& node, const f32x4 (&p)[3]) {
  f32x4 sum = splat(0);
  for (int k = 0; k < 3; ++k) {
    const f32x4 outside = simd::max(simd::max(load(node.low[k]) - p[k], p[k] - load(node.high[k])), splat(0));
    sum = sum + outside * outside;
  }
  return sum;
}

/// Squared distance of p to four triangles, each in its own frame.
f32x4 squaredDistanceToTriangles(const NearLeaf& leaf, const f32x4 (&p)[3]) {
  const f32x4 dx = p[0] - load(leaf.origin[0]);
  const f32x4 dy = p[1] - load(leaf.origin[1]);
  const f32x4 dz = p[2] - load(leaf.origin[2]);
  const auto along = [&](const float (&axis)[3][4]) { return dx * load(axis[0]) + dy * load(axis[1]) + dz * load(axis[2]); };
  const f32x4 x = along(leaf.axes[0]);
  const f32x4 y = along(leaf.axes[1]);
  const f32x4 z = along(leaf.axes[2]);
  const f32x4 zero = splat(0);

  // To edge AB, which lies on the x-axis.
  const f32x4 base = load(leaf.base);
  const f32x4 baseX = x - simd::clamp(x, zero, base);
  const f32x4 toAB = baseX * baseX + y * y;
  // To edge AC.
  const f32x4 cx = load(leaf.toC[0]);
  const f32x4 cy = load(leaf.toC[1]);
  const f32x4 alongC = simd::clamp(x * cx + y * cy, zero, load(leaf.lengthC));
  const f32x4 acX = x - alongC * cx;
  const f32x4 acY = y - alongC * cy;
  const f32x4 toAC = acX * acX + acY * acY;
  // To edge BC.
  const f32x4 bx = load(leaf.fromB[0]);
  const f32x4 by = load(leaf.fromB[1]);
  const f32x4 xB = x - base;
  const f32x4 alongB = simd::clamp(xB * bx + y * by, zero, load(leaf.lengthB));
  const f32x4 bcX = xB - alongB * bx;
  const f32x4 bcY = y - alongB * by;
  const f32x4 toBC = bcX * bcX + bcY * bcY;

  // Below AB the nearest is on AB, since the angles at A and B are acute. Above it, inside if right of AC and left of BC.
  const mask4 below = y < zero;
  const mask4 within = (cx * y <= cy * x) & (by * xB <= bx * y);
  const f32x4 inPlane = simd::select(below, toAB, simd::drop(within, simd::min(toAC, toBC)));
  return z * z + inPlane;
}

}  // namespace

std::uint32_t nearTriangles(const CageTree& tree, const float* p, double diagonal, std::uint32_t* found) noexcept {
  const f32x4 point[3] = {splat(p[0]), splat(p[1]), splat(p[2])};
  const double fixedSlack = kTieDistance * diagonal + kRounding * tree.extent;
  // The squared distance within which a triangle is still of interest, given the least so far.
  const auto limitFor = [&](float least) {
    const double distance = std::sqrt(static_cast<double>(least));
    const double limit = distance + fixedSlack + kRounding * distance;
    return static_cast<float>(limit * limit * (1 + kRounding));
  };

  struct Visit {
    std::uint32_t child;
    float squaredDistance;
  };
  Visit stack[kStackSize];
  int depth = 0;
  stack[depth++] = {0, 0.0f};
  float least = std::numeric_limits<float>::infinity();
  float limit = least;
  std::uint32_t count = 0;
  // The first few are remembered with their distances, to drop those that fall behind when a nearer one is found. Of more
  // than that (a fan around one corner, a stack of copies) all are kept, and the exact test sorts them out.
  constexpr std::uint32_t kRemembered = 16;
  float distances[kRemembered];

  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (visit.squaredDistance > limit) continue;
    if (visit.child & kLeafBit) {
      const NearLeaf& leaf = tree.near[visit.child & ~kLeafBit];
      const f32x4 squared = squaredDistanceToTriangles(leaf, point);
      unsigned close = simd::bits(squared <= splat(limit));
      if (close == 0) continue;
      float lanes[4];
      simd::store(lanes, squared);
      for (int i = 0; i < 4; ++i) {
        if (!(close >> i & 1) || lanes[i] > limit) continue;
        if (lanes[i] < least) {
          least = lanes[i];
          limit = limitFor(least);
          std::uint32_t kept = 0;
          for (std::uint32_t j = 0; j < count && count <= kRemembered; ++j) {
            if (distances[j] > limit) continue;
            distances[kept] = distances[j];
            found[kept++] = found[j];
          }
          if (count <= kRemembered) count = kept;
        }
        if (count < kRemembered) distances[count] = lanes[i];
        found[count++] = leaf.slot[i];
      }
      continue;
    }
    const Node& node = tree.rays.nodes[visit.child];
    const f32x4 squared = squaredDistanceToBoxes(node, point);
    unsigned close = simd::bits(squared <= splat(limit));
    float lanes[4];
    simd::store(lanes, squared);
    // Push the far ones first.
    const int first = depth;
    for (int i = 0; i < 4; ++i) {
      if (!(close >> i & 1)) continue;
      int at = depth++;
      for (; at > first && stack[at - 1].squaredDistance < lanes[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[i], lanes[i]};
    }
  }
  return count;
}

}  // namespace cagecast
