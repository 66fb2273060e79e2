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
constexpr double kRounding = 1e-6;
/// A squared distance of interest is (d + s)² for the nearest distance d and the slack s. It is at most
/// d² · (1 + r) + s² · (1 + 1/r) for any r, which needs no root; this r is good where d is a few thousandths of the diagonal.
constexpr double kRelativeSlack = 1e-4;

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
f32x4 squaredDistanceToChild(const Node& node, std::uint32_t child, const float* x, const float* y, const float* z) {
  const float* const points[3] = {x, y, z};
  f32x4 sum = splat(0);
  for (int k = 0; k < 3; ++k) {
    const f32x4 p = load(points[k]);
    const f32x4 outside = simd::max(simd::max(splat(node.low[k][child]) - p, p - splat(node.high[k][child])), splat(0));
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
  return z * z + simd::select(below, toAB, simd::drop(within, simd::min(toAC, toBC)));
}

/// What is still to be visited, with the node that holds its box.
struct Visit {
  std::uint32_t child;
  std::uint32_t lane;
  const Node* parent;
};

/// Pushes the children that are near enough.
void pushChildren(const Node& node, unsigned close, Visit* stack, std::uint32_t& depth) {
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    stack[depth] = {node.child[lane], lane, &node};
    depth += close >> lane & 1;
  }
}

}  // namespace

NearestSearch::NearestSearch(const CageTree& tree, double diagonal) noexcept : tree_(tree) {
  const double slack = kTieDistance * diagonal + kRounding * tree.extent;
  fixedSlack_ = static_cast<float>(slack * slack * (1 + 1 / kRelativeSlack));
}

void NearestSearch::searchLeaf(std::uint32_t leafIndex, unsigned members) noexcept {
  const NearLeaf& leaf = tree_.near[leafIndex];
  for (std::uint32_t i = 0; members != 0; ++i, members >>= 1) {
    if ((members & 1) == 0) continue;
    const f32x4 point[3] = {splat(points_[0][i]), splat(points_[1][i]), splat(points_[2][i])};
    const f32x4 squared = squaredDistanceToTriangles(leaf, point);
    const float least = simd::lowest(squared);
    const float limit = std::min(limits_[i], least * (1 + static_cast<float>(kRelativeSlack)) + fixedSlack_);
    const unsigned lanes = simd::bits(squared <= splat(limit));
    limits_[i] = limit;
    // No branch: whether a leaf is of interest is a coin toss.
    const std::uint32_t count = nearCount_[i];
    near_[i][std::min(count, kRoom)] = {least, leafIndex << 4 | lanes};
    nearCount_[i] = count + (lanes != 0);
  }
}

void NearestSearch::search(const float* positions, std::uint32_t count) noexcept {
  f32x4 low[3];
  f32x4 high[3];
  for (std::uint32_t k = 0; k < 3; ++k) {
    float least = positions[k];
    float most = positions[k];
    for (std::uint32_t i = 0; i < kGroup; ++i) {
      const float x = positions[Points::kStride * std::min(i, count - 1) + k];
      points_[k][i] = x;
      least = std::min(least, x);
      most = std::max(most, x);
    }
    low[k] = splat(least);
    high[k] = splat(most);
  }
  for (std::uint32_t i = 0; i < kGroup; ++i) {
    limits_[i] = i < count ? std::numeric_limits<float>::max() : -1.0f;
    nearCount_[i] = 0;
  }
  const std::uint32_t seed = lastLeaf_;
  searchLeaf(seed, (1u << count) - 1);
  const auto groupLimit = [this] { return splat(simd::highest(simd::max(load(limits_), load(limits_ + 4)))); };

  Visit stack[kStackSize];
  std::uint32_t depth = 0;
  const Node& root = tree_.rays.nodes[0];
  pushChildren(root, simd::bits(squaredDistanceToBoxes(root, low, high) <= groupLimit()), stack, depth);
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if ((visit.child & kLeafBit) == 0) {
      const Node& node = tree_.rays.nodes[visit.child];
      pushChildren(node, simd::bits(squaredDistanceToBoxes(node, low, high) <= groupLimit()), stack, depth);
      continue;
    }
    const std::uint32_t leaf = visit.child & ~kLeafBit;
    if (leaf == seed) continue;
    unsigned members = 0;
    for (unsigned i = 0; i < kGroup; i += simd::kWidth) {
      const f32x4 squared = squaredDistanceToChild(*visit.parent, visit.lane, points_[0] + i, points_[1] + i, points_[2] + i);
      members |= simd::bits(squared <= load(limits_ + i)) << i;
    }
    searchLeaf(leaf, members);
  }
  // Where the last point is nearest, the next group begins.
  const std::uint32_t last = count - 1;
  float least = std::numeric_limits<float>::infinity();
  for (std::uint32_t j = 0; j < std::min(nearCount_[last], kRoom); ++j) {
    if (near_[last][j].squaredDistance >= least) continue;
    least = near_[last][j].squaredDistance;
    lastLeaf_ = near_[last][j].lanes >> 4;
  }
}

std::uint32_t NearestSearch::candidates(std::uint32_t i, std::uint32_t* found) const noexcept {
  std::uint32_t count = 0;
  const auto takeLanes = [&](std::uint32_t leaf, unsigned lanes) {
    for (std::uint32_t lane = 0; lanes != 0; ++lane, lanes >>= 1) {
      if (lanes & 1) found[count++] = tree_.near[leaf].slot[lane];
    }
  };
  if (nearCount_[i] <= kRoom) {
    for (std::uint32_t j = 0; j < nearCount_[i]; ++j) {
      if (near_[i][j].squaredDistance <= limits_[i]) takeLanes(near_[i][j].lanes >> 4, near_[i][j].lanes & 15);
    }
    return count;
  }
  // A fan around a corner, or a stack of copies: collect all within the limit, which is known by now.
  const f32x4 point[3] = {splat(points_[0][i]), splat(points_[1][i]), splat(points_[2][i])};
  const f32x4 limit = splat(limits_[i]);
  Visit stack[kStackSize];
  std::uint32_t depth = 0;
  stack[depth++] = {0, 0, nullptr};
  while (depth > 0) {
    const std::uint32_t child = stack[--depth].child;
    if (child & kLeafBit) {
      const std::uint32_t leaf = child & ~kLeafBit;
      takeLanes(leaf, simd::bits(squaredDistanceToTriangles(tree_.near[leaf], point) <= limit));
    } else {
      const Node& node = tree_.rays.nodes[child];
      pushChildren(node, simd::bits(squaredDistanceToBoxes(node, point, point) <= limit), stack, depth);
    }
  }
  return count;
}

}  // namespace cagecast
