#include <algorithm>
#include <cmath>
#include <limits>

#include "kd_tree.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// What the kernels below may be off, as a share of the distance and of the cage's extent: they round a dozen times, each
/// time by 2^-24 of one of them.
constexpr float kRounding = 1e-6f;

/// Squared distance of a box to four boxes.
f32x4 squaredDistanceToBoxes(const Node& node, const f32x4 (&low)[3], const f32x4 (&high)[3]) {
  f32x4 sum = splat(0);
  for (int k = 0; k < 3; ++k) {
    const f32x4 outside = simd::max(simd::max(load(node.low[k]) - high[k], low[k] - load(node.high[k])), splat(0));
    sum = sum + outside * outside;
  }
  return sum;
}

/// Squared distance of four points to a node's child.
f32x4 squaredDistanceToChild(const Node& node, int child, const float* x, const float* y, const float* z) {
  const float* const points[3] = {x, y, z};
  f32x4 sum = splat(0);
  for (int k = 0; k < 3; ++k) {
    const f32x4 p = load(points[k]);
    const f32x4 outside = simd::max(simd::max(splat(node.low[k][child]) - p, p - splat(node.high[k][child])), splat(0));
    sum = sum + outside * outside;
  }
  return sum;
}

/// Squared distance of p to four triangles, each in its own frame; what is beyond `limit` may be any number beyond it.
/// @return Which of the four are within the limit.
unsigned squaredDistanceToTriangles(const NearLeaf& leaf, const f32x4 (&p)[3], f32x4 limit, f32x4& squared) {
  const f32x4 dx = p[0] - load(leaf.origin[0]);
  const f32x4 dy = p[1] - load(leaf.origin[1]);
  const f32x4 dz = p[2] - load(leaf.origin[2]);
  const auto along = [&](const float (&axis)[3][4]) { return dx * load(axis[0]) + dy * load(axis[1]) + dz * load(axis[2]); };
  const f32x4 x = along(leaf.axes[0]);
  const f32x4 y = along(leaf.axes[1]);
  const f32x4 z = along(leaf.axes[2]);
  const f32x4 zero = splat(0);

  // To the rectangle around the triangle: in half the cases that is enough to know that it is too far.
  const f32x4 base = load(leaf.base);
  const f32x4 baseX = x - simd::clamp(x, zero, base);
  const f32x4 sideY = y - simd::clamp(y, zero, load(leaf.height));
  const f32x4 height = z * z;
  const f32x4 beside = baseX * baseX;
  if (simd::bits(height + beside + sideY * sideY <= limit) == 0) return 0;

  // To edge AB, which lies on the x-axis.
  const f32x4 toAB = beside + y * y;
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
  squared = height + simd::select(below, toAB, simd::drop(within, simd::min(toAC, toBC)));
  return simd::bits(squared <= limit);
}

/// What is still to be visited. Nodes and leaves come with the node that holds their box.
struct Visit {
  float squaredDistance;
  std::uint32_t child;
  const Node* parent;
  int lane;
};

/// Pushes the children that are near enough, the nearest last, so that it is visited first.
void pushChildren(const Node& node, f32x4 squaredDistances, float limit, Visit* stack, int& depth) {
  unsigned close = simd::bits(squaredDistances <= splat(limit));
  float lanes[4];
  simd::store(lanes, squaredDistances);
  const int first = depth;
  for (int i = 0; close != 0; ++i, close >>= 1) {
    if ((close & 1) == 0) continue;
    int at = depth++;
    for (; at > first && stack[at - 1].squaredDistance < lanes[i]; --at) stack[at] = stack[at - 1];
    stack[at] = {lanes[i], node.child[i], &node, i};
  }
}

}  // namespace

NearestSearch::NearestSearch(const CageTree& tree, double diagonal) noexcept
    : tree_(tree), slack_(static_cast<float>(kTieDistance * diagonal + static_cast<double>(kRounding) * tree.extent)) {}

float NearestSearch::limitFor(float squaredDistance) const noexcept {
  const float distance = std::sqrt(squaredDistance);
  const float limit = distance + distance * kRounding + slack_;
  return limit * limit * (1 + kRounding);
}

void NearestSearch::lower(std::uint32_t i, float squaredDistance) noexcept {
  limits_[i] = limitFor(squaredDistance);
  if (least_[i] > limits_[i]) foundCount_[i] = 0;  // All that was found is farther than that.
  least_[i] = squaredDistance;
}

void NearestSearch::searchLeaf(std::uint32_t leafIndex, std::uint32_t i) noexcept {
  const NearLeaf& leaf = tree_.near[leafIndex];
  const f32x4 point[3] = {splat(points_[0][i]), splat(points_[1][i]), splat(points_[2][i])};
  f32x4 squared;
  unsigned close = squaredDistanceToTriangles(leaf, point, splat(limits_[i]), squared);
  if (close == 0) return;
  float lanes[4];
  simd::store(lanes, squared);
  // The nearest first: most of the others are then too far.
  const float least = std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
  if (least < least_[i]) {
    lower(i, least);
    close = simd::bits(squared <= splat(limits_[i]));
  }
  for (int lane = 0; close != 0; ++lane, close >>= 1) {
    if ((close & 1) == 0) continue;
    const std::uint32_t found = foundCount_[i]++;
    if (found < kRoom) slots_[i][found] = leaf.slot[lane];
  }
}

void NearestSearch::search(const float* positions, std::uint32_t count) noexcept {
  count_ = count;
  f32x4 low[3];
  f32x4 high[3];
  for (std::uint32_t k = 0; k < 3; ++k) {
    float least = positions[k];
    float most = positions[k];
    for (std::uint32_t i = 0; i < kGroup; ++i) {
      const float x = positions[3 * std::min(i, count - 1) + k];
      points_[k][i] = x;
      least = std::min(least, x);
      most = std::max(most, x);
    }
    low[k] = splat(least);
    high[k] = splat(most);
  }
  for (std::uint32_t i = 0; i < kGroup; ++i) {
    limits_[i] = least_[i] = i < count ? std::numeric_limits<float>::max() : -1.0f;
    foundCount_[i] = 0;
  }
  for (std::uint32_t i = 0; i < count; ++i) searchLeaf(lastLeaf_, i);
  const std::uint32_t seed = lastLeaf_;
  const auto groupLimit = [this] { return *std::max_element(limits_, limits_ + kGroup); };

  Visit stack[kStackSize];
  int depth = 0;
  float limit = groupLimit();
  const Node& root = tree_.rays.nodes[0];
  pushChildren(root, squaredDistanceToBoxes(root, low, high), limit, stack, depth);
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (visit.squaredDistance > limit) continue;
    if ((visit.child & kLeafBit) == 0) {
      const Node& node = tree_.rays.nodes[visit.child];
      pushChildren(node, squaredDistanceToBoxes(node, low, high), limit, stack, depth);
      continue;
    }
    const std::uint32_t leaf = visit.child & ~kLeafBit;
    if (leaf == seed) continue;
    unsigned close = 0;
    for (unsigned i = 0; i < kGroup; i += simd::kWidth) {
      const f32x4 squared = squaredDistanceToChild(*visit.parent, visit.lane, points_[0] + i, points_[1] + i, points_[2] + i);
      close |= simd::bits(squared <= load(limits_ + i)) << i;
    }
    if (close == 0) continue;
    for (std::uint32_t i = 0; close != 0; ++i, close >>= 1) {
      if (close & 1) searchLeaf(leaf, i);
    }
    limit = groupLimit();
    lastLeaf_ = leaf;
  }
}

std::uint32_t NearestSearch::candidates(std::uint32_t i, std::uint32_t* found) const noexcept {
  if (foundCount_[i] <= kRoom) {
    std::copy(slots_[i], slots_[i] + foundCount_[i], found);
    return foundCount_[i];
  }
  // A fan around a corner, or a stack of copies: collect all within the limit, which is known by now.
  const f32x4 point[3] = {splat(points_[0][i]), splat(points_[1][i]), splat(points_[2][i])};
  Visit stack[kStackSize];
  int depth = 0;
  std::uint32_t count = 0;
  stack[depth++] = {0, 0, nullptr, 0};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if ((visit.child & kLeafBit) == 0) {
      const Node& node = tree_.rays.nodes[visit.child];
      pushChildren(node, squaredDistanceToBoxes(node, point, point), limits_[i], stack, depth);
      continue;
    }
    const NearLeaf& leaf = tree_.near[visit.child & ~kLeafBit];
    f32x4 squared;
    unsigned close = squaredDistanceToTriangles(leaf, point, splat(limits_[i]), squared);
    for (int lane = 0; close != 0; ++lane, close >>= 1) {
      if (close & 1) found[count++] = leaf.slot[lane];
    }
  }
  return count;
}

}  // namespace cagecast
