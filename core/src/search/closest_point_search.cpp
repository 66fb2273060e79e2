#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "search/closest_point_search.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::splat;

/// Squared distance of a box to four boxes.
f32x4 squaredDistanceToBoxes(const Node& node, const f32x4 (&low)[3], const f32x4 (&high)[3]) {
  f32x4 sum;
  for (int k = 0; k < 3; ++k) {
    const f32x4 outside = simd::max(simd::max(load(node.low[k]) - high[k], low[k] - load(node.high[k])), splat(0));
    sum = k == 0 ? outside * outside : simd::multiplyAdd(outside, outside, sum);
  }
  return sum;
}

/// For each set of lanes, a bit each, the lanes in it. The rest of a row is 0.
constexpr auto kLanes = [] {
  std::array<std::array<std::uint32_t, 4>, 16> table{};
  for (std::uint32_t set = 0; set < 16; ++set) {
    std::size_t count = 0;
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      if (set >> lane & 1) table[set][count++] = lane;
    }
  }
  return table;
}();

/// The work that a candidate makes for the caller, in tests of a leaf against a point.
constexpr std::uint64_t kCandidate = 16;

}  // namespace

ClosestPointSearch::ClosestPointSearch(const CageTree& tree, double diagonal, Arena& arena) noexcept
    : tree_(tree),
      arena_(arena),
      slack_(slackOf(tree, diagonal)),
      growth_(1 + static_cast<float>(kRelativeSlack)),
      fixedSlack_(fixedSlack(slack_, kRelativeSlack)),
      list_(arena.allocate<std::uint32_t>(std::size_t{tree.leafCount} + CageTree::kMaxEntries + 4)),
      otherList_(arena.allocate<std::uint32_t>(std::size_t{tree.leafCount} + CageTree::kMaxEntries + 4)) {}

void ClosestPointSearch::widen(double more, double distance) noexcept {
  const double slack = slack_ + more;
  const double ratio = std::max(slack / distance, kRelativeSlack);
  growth_ = static_cast<float>(1 + ratio);
  fixedSlack_ = fixedSlack(slack, ratio);
}

std::uint32_t ClosestPointSearch::listLeaves(const f32x4 (&low)[3], const f32x4 (&high)[3], f32x4 limit,
                                             std::uint32_t*& leaves) const noexcept {
  std::uint32_t* from = list_;
  std::uint32_t* to = otherList_;
  // Copies stay in registers: the compiler would reload the parameters after each store.
  const f32x4 ownLow[3] = {low[0], low[1], low[2]};
  const f32x4 ownHigh[3] = {high[0], high[1], high[2]};
  std::uint32_t count = tree_.entryCount;
  for (std::uint32_t i = 0; i < count; ++i) from[i] = i;
  const Node* row = tree_.rays.nodes + tree_.entry;
  for (std::uint32_t level = 0; level <= tree_.levelsBelowEntry; ++level) {
    if (level > 0) row = tree_.rays.nodes + row->child[0];
    std::uint32_t* end = to;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t node = from[i];
      const unsigned close = simd::bits(squaredDistanceToBoxes(row[node], ownLow, ownHigh) <= limit);
      // Without branches, which could not be predicted.
      for (std::uint32_t k = 0; k < 4; ++k) end[k] = 4 * node + kLanes[close][k];
      end += std::popcount(close);
    }
    count = static_cast<std::uint32_t>(end - to);
    std::swap(from, to);
  }
  leaves = from;
  return count;
}

std::uint32_t ClosestPointSearch::leafNear(f32x4 point) const noexcept {
  const f32x4 box[3] = {simd::splatLane<0>(point), simd::splatLane<1>(point), simd::splatLane<2>(point)};
  for (std::uint32_t i = 0;;) {
    const Node& node = tree_.rays.nodes[i];
    const f32x4 squared = squaredDistanceToBoxes(node, box, box);
    const std::uint32_t child = node.child[std::countr_zero(simd::bits(squared <= simd::lowest(squared)))];
    if ((child & kLeafBit) != 0) return firstOf(child) / 4;
    i = child;
  }
}

inline unsigned ClosestPointSearch::candidatesIn(const FlatLeaf& leaf, std::uint32_t i, float& least) noexcept {
  const f32x4 squared = squaredDistances(leaf, splat(points_[i][0]), splat(points_[i][1]), splat(points_[i][2]));
  const f32x4 lowest = simd::lowest(squared);
  const f32x4 limit = simd::min(simd::multiplyAdd(lowest, splat(growth_), splat(fixedSlack_)), splat(limits_[i]));
  limits_[i] = simd::lane<0>(limit);
  least = simd::lane<0>(lowest);
  return simd::bits(squared <= limit);
}

void ClosestPointSearch::searchLeaf(std::uint32_t leafIndex, unsigned members) noexcept {
  const FlatLeaf& leaf = tree_.leaves[leafIndex];
  for (; members != 0; members &= members - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(members));
    // Without a branch, which could not be predicted: a leaf without candidates is overwritten by the next.
    const std::uint32_t count = nearCount_[i];
    const unsigned lanes = candidatesIn(leaf, i, squaredDistances_[count % kRoom][i]);
    lanes_[count % kRoom][i] = leafIndex << 4 | lanes;
    nearCount_[i] = count + (lanes != 0);
  }
}

void ClosestPointSearch::searchLeaves(const std::uint32_t* leaves, std::uint32_t leafCount) noexcept {
  constexpr unsigned kVectors = kGroup / simd::kWidth;
  const OrientedBox* const boxes = tree_.leafBoxes;
  for (std::uint32_t j = 0; j < leafCount; ++j) {
    const OrientedBox& box = boxes[leaves[j]];
    f32x4 squared[kVectors];
    for (int axis = 0; axis < 3; ++axis) {
      const f32x4 x = splat(box.axes[0][axis]);
      const f32x4 y = splat(box.axes[1][axis]);
      const f32x4 z = splat(box.axes[2][axis]);
      const f32x4 low = splat(box.low[axis]);
      const f32x4 high = splat(box.high[axis]);
      for (unsigned i = 0; i < kVectors; ++i) {
        const f32x4 coordinate =
            simd::multiplyAdd(z, load(columns_[2] + 4 * i),
                              simd::multiplyAdd(y, load(columns_[1] + 4 * i), x * load(columns_[0] + 4 * i)));
        const f32x4 outside = coordinate - min(max(coordinate, low), high);
        squared[i] = axis == 0 ? outside * outside : simd::multiplyAdd(outside, outside, squared[i]);
      }
    }
    unsigned members = 0;
    for (unsigned i = 0; i < kVectors; ++i) members |= simd::bits(squared[i] <= load(limits_ + 4 * i)) << 4 * i;
    if (members != 0) searchLeaf(leaves[j], members);
  }
}

void ClosestPointSearch::search(const float* positions, std::uint32_t count) noexcept {
  positions_ = positions;
  const f32x4 centre = load(tree_.centre);
  f32x4 lowCorner = load(positions);
  f32x4 highCorner = lowCorner;
  for (std::uint32_t i = 0; i < count; i += simd::kWidth) {
    f32x4 rows[simd::kWidth];
    for (std::uint32_t j = 0; j < simd::kWidth; ++j) {
      rows[j] = load(positions + Points::kStride * std::min(i + j, count - 1));
      lowCorner = simd::min(lowCorner, rows[j]);
      highCorner = simd::max(highCorner, rows[j]);
      rows[j] = rows[j] - centre;
      simd::store(points_[i + j], rows[j]);
    }
    simd::transpose(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 3; ++k) simd::store(columns_[k] + i, rows[k]);
    simd::store(limits_ + i, splat(std::numeric_limits<float>::max()));
  }
  const f32x4 low[3] = {simd::splatLane<0>(lowCorner), simd::splatLane<1>(lowCorner), simd::splatLane<2>(lowCorner)};
  const f32x4 high[3] = {simd::splatLane<0>(highCorner), simd::splatLane<1>(highCorner),
                         simd::splatLane<2>(highCorner)};
  std::fill(limits_ + count, limits_ + kGroup, -1.0f);
  // The limits to begin with: from a leaf near the end of the last group, and one near the end of this one.
  const std::uint32_t last = count - 1;
  const std::uint32_t seeds[] = {lastLeaf_, leafNear(load(positions + Points::kStride * last))};
  std::fill(nearCount_, nearCount_ + count, 0u);
  const unsigned all = (1u << count) - 1;
  searchLeaf(seeds[0], all);
  if (seeds[1] != seeds[0]) searchLeaves(seeds + 1, 1);
  f32x4 most = load(limits_);
  for (std::uint32_t i = simd::kWidth; i < kGroup; i += simd::kWidth) most = simd::max(most, load(limits_ + i));
  std::uint32_t* leaves;
  std::uint32_t leafCount = listLeaves(low, high, simd::highest(most), leaves);
  for (const std::uint32_t seed : seeds) {
    if (std::uint32_t* const known = std::find(leaves, leaves + leafCount, seed); known < leaves + leafCount)
      *known = leaves[--leafCount];
  }
  searchLeaves(leaves, leafCount);
  arena_.spend(std::uint64_t{count} * leafCount);

  // The leaf closest to the last point is likely to be close to the next group.
  std::uint32_t nearest = 0;
  for (std::uint32_t j = 1; j < std::min(nearCount_[last], kRoom); ++j) {
    if (squaredDistances_[j][last] < squaredDistances_[nearest][last]) nearest = j;
  }
  lastLeaf_ = lanes_[nearest][last] >> 4;
}

std::uint32_t ClosestPointSearch::onlyCandidate(std::uint32_t i) const noexcept {
  if (nearCount_[i] >= kRoom) return kSeveral;
  std::uint32_t found = 0;
  std::uint32_t foundCount = 0;
  for (std::uint32_t j = 0; j < nearCount_[i]; ++j) {
    const bool isNear = squaredDistances_[j][i] <= limits_[i];
    found = isNear ? lanes_[j][i] : found;
    foundCount += isNear;
  }
  const unsigned lanes = found & 15;
  if (foundCount != 1 || (lanes & (lanes - 1)) != 0) return kSeveral;
  return tree_.leaves[found >> 4].cageTriangles[std::countr_zero(lanes)];
}

std::uint32_t ClosestPointSearch::candidates(std::uint32_t i, std::uint32_t* found) noexcept {
  std::uint32_t count = 0;
  const auto take = [&](const FlatLeaf& leaf, unsigned lanes) {
    for (; lanes != 0; lanes &= lanes - 1) found[count++] = leaf.cageTriangles[std::countr_zero(lanes)];
  };
  if (nearCount_[i] < kRoom) {
    for (std::uint32_t j = 0; j < nearCount_[i]; ++j) {
      if (squaredDistances_[j][i] <= limits_[i]) take(tree_.leaves[lanes_[j][i] >> 4], lanes_[j][i] & 15);
    }
    return count;
  }
  const auto takeFrom = [&](const FlatLeaf& leaf) {
    float least;
    take(leaf, candidatesIn(leaf, i, least));
  };
  // A fan around a corner, or a stack of copies: search again, with the limit that is known by now.
  const f32x4 point = load(positions_ + Points::kStride * i);
  const f32x4 box[3] = {simd::splatLane<0>(point), simd::splatLane<1>(point), simd::splatLane<2>(point)};
  std::uint32_t* leaves;
  const std::uint32_t leafCount = listLeaves(box, box, splat(limits_[i]), leaves);
  for (std::uint32_t j = 0; j < leafCount; ++j) takeFrom(tree_.leaves[leaves[j]]);
  arena_.spend(std::uint64_t{kCandidate} * count);
  if (count == 0) {
    // A needle, whose distance in floats is arbitrary, seemed nearer than its box is: take the nearest of every leaf.
    arena_.spend(tree_.leafCount);
    for (std::uint32_t leaf = 0; leaf < tree_.leafCount; ++leaf) {
      limits_[i] = std::numeric_limits<float>::max();
      takeFrom(tree_.leaves[leaf]);
    }
  }
  return count;
}

}  // namespace cagecast
