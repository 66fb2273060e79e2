#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "search/near_kernel.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::kWide;
using simd::load;
using simd::loadWide;
using simd::splat;
using simd::wide;

/// Squared distance of a box to four boxes.
f32x4 squaredDistanceToBoxes(const Node& node, const f32x4 (&low)[3], const f32x4 (&high)[3]) {
  f32x4 sum;
  for (int k = 0; k < 3; ++k) {
    const f32x4 outside = simd::max(simd::max(load(node.low[k]) - high[k], low[k] - load(node.high[k])), splat(0));
    sum = k == 0 ? outside * outside : simd::multiplyAdd(outside, outside, sum);
  }
  return sum;
}

/// Squared distance of p to four triangles.
/// @param p  From the middle of the cage.
f32x4 squaredDistanceToTriangles(const NearLeaf& leaf, f32x4 p) {
  return squaredDistances(leaf, simd::splatLane<0>(p), simd::splatLane<1>(p), simd::splatLane<2>(p),
                          [](const float(&field)[4]) { return load(field); });
}

/// For every choice of a node's children, a bit each: which they are, one after the other, and each as its number below
/// 0.
constexpr auto kChosen = [] {
  struct Table {
    alignas(16) std::uint32_t rows[16][4];
  } table{};
  for (std::uint32_t choice = 0; choice < 16; ++choice) {
    std::uint32_t* next = table.rows[choice];
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      if (choice >> lane & 1) *next++ = 0 - lane;
    }
  }
  return table;
}();
/// How many they are, a hexadecimal digit for each choice.
constexpr std::uint64_t kChosenCounts = 0x4332'3221'3221'2110;

}  // namespace

NearestSearch::NearestSearch(const CageTree& tree, double diagonal, Arena& arena) noexcept
    : tree_(tree),
      slack_(slackOf(tree, diagonal)),
      growth_(1 + static_cast<float>(kRelativeSlack)),
      fixedSlack_(fixedSlack(slack_, kRelativeSlack)),
      list_(arena.allocate<std::uint32_t>(std::size_t{tree.leafCount} + CageTree::kMostEntries + 4)),
      otherList_(arena.allocate<std::uint32_t>(std::size_t{tree.leafCount} + CageTree::kMostEntries + 4)) {}

void NearestSearch::widen(double more, double distance) noexcept {
  const double slack = slack_ + more;
  const double ratio = std::max(slack / distance, kRelativeSlack);
  growth_ = static_cast<float>(1 + ratio);
  fixedSlack_ = fixedSlack(slack, ratio);
}

// Not inlined: it is long, and called from two places.
[[gnu::noinline]] std::uint32_t NearestSearch::listLeaves(const f32x4 (&low)[3], const f32x4 (&high)[3], f32x4 limit,
                                                          std::uint32_t*& leaves) const noexcept {
  std::uint32_t* from = list_;
  std::uint32_t* to = otherList_;
  // Copies stay in registers: the others might be what is written to.
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
      simd::store(end, simd::splatCount(4 * node) - simd::load(kChosen.rows[close]));
      end += kChosenCounts >> 4 * close & 7;
    }
    count = static_cast<std::uint32_t>(end - to);
    std::swap(from, to);
  }
  leaves = from;
  return count;
}

std::uint32_t NearestSearch::leafNear(f32x4 point) const noexcept {
  const f32x4 box[3] = {simd::splatLane<0>(point), simd::splatLane<1>(point), simd::splatLane<2>(point)};
  for (std::uint32_t i = 0;;) {
    const Node& node = tree_.rays.nodes[i];
    const f32x4 squared = squaredDistanceToBoxes(node, box, box);
    const std::uint32_t child = node.child[std::countr_zero(simd::bits(squared <= simd::lowest(squared)))];
    if ((child & kLeafBit) != 0) return firstOf(child) / 4;
    i = child;
  }
}

void NearestSearch::searchLeaf(std::uint32_t leafIndex, unsigned members) noexcept {
  const NearLeaf& leaf = tree_.near[leafIndex];
  const f32x4 growth = splat(growth_);
  const f32x4 slack = splat(fixedSlack_);
  for (; members != 0; members &= members - 1) {
    const int i = std::countr_zero(members);
    const f32x4 squared = squaredDistanceToTriangles(leaf, load(points_[i]));
    const f32x4 least = simd::lowest(squared);
    const f32x4 limit = simd::min(simd::multiplyAdd(least, growth, slack), splat(limits_[i]));
    const unsigned lanes = simd::bits(squared <= limit);
    limits_[i] = simd::first(limit);
    // No branch: whether a leaf is of interest is a coin toss. One that is not is written over by the next.
    const std::uint32_t count = nearCount_[i];
    squaredDistances_[count % kRoom][i] = simd::first(least);
    lanes_[count % kRoom][i] = leafIndex << 4 | lanes;
    nearCount_[i] = count + (lanes != 0);
  }
}

void NearestSearch::searchSeed(std::uint32_t leafIndex, std::uint32_t place, std::uint32_t count) noexcept {
  const NearLeaf& leaf = tree_.near[leafIndex];
  for (std::uint32_t i = 0; i < count; i += kWide) {
    // Where all points are looked at, each has a lane, and triangles come one after the other.
    const wide x = loadWide(columns_[0] + i), y = loadWide(columns_[1] + i), z = loadWide(columns_[2] + i);
    alignas(32) float squared[4][kWide];
    wide least = simd::splatWide(std::numeric_limits<float>::max());
#pragma GCC unroll 1
    for (int lane = 0; lane < 4; ++lane) {
      const wide one =
          squaredDistances(leaf, x, y, z, [lane](const float(&field)[4]) { return simd::splatWide(field[lane]); });
      simd::store(squared[lane], one);
      least = simd::min(one, least);
    }
    const wide limit = simd::min(simd::multiplyAdd(least, simd::splatWide(growth_), simd::splatWide(fixedSlack_)),
                                 loadWide(limits_ + i));
    simd::store(limits_ + i, limit);
    simd::store(squaredDistances_[place] + i, least);
    simd::count4 lanes[simd::kParts];
    for (simd::count4& l : lanes) l = simd::splatCount(leafIndex);
    for (int lane = 4; lane-- > 0;) {
      simd::forParts(loadWide(squared[lane]) <= limit, [&](int part, simd::mask4 isNear) {
        lanes[part] = simd::countTrue(lanes[part] + lanes[part], isNear);
      });
    }
    simd::forParts(least <= limit, [&](int part, simd::mask4 isNear) {
      const std::uint32_t at = i + static_cast<std::uint32_t>(part) * simd::kWidth;
      simd::store(lanes_[place] + at, lanes[part]);
      simd::store(nearCount_ + at, simd::countTrue(simd::splatCount(place), isNear));
    });
  }
}

void NearestSearch::searchLeaves(const std::uint32_t* leaves, std::uint32_t leafCount, std::uint32_t count) noexcept {
  // Squared distances of the points to the leaves' boxes, each tagged with its leaf, and the least of each point.
  alignas(32) float distances[kBatch][kGroup];
  wide nearest[kGroup / kWide];
  for (wide& n : nearest) n = simd::splatWide(std::numeric_limits<float>::infinity());
  const LeafBox* const boxes = tree_.boxes;
  for (std::uint32_t j = 0; j < leafCount; ++j) {
    const LeafBox& box = boxes[leaves[j]];
    wide squared[kGroup / kWide];
    const auto addAxis = [&]<int axis>(std::integral_constant<int, axis>) {
      const wide x = simd::splatWideAt<axis>(box.axes[0]);
      const wide y = simd::splatWideAt<axis>(box.axes[1]);
      const wide z = simd::splatWideAt<axis>(box.axes[2]);
      const wide low = simd::splatWideAt<axis>(box.low);
      const wide high = simd::splatWideAt<axis>(box.high);
      for (unsigned i = 0; i < kGroup; i += kWide) {
        const wide place =
            simd::multiplyAdd(z, loadWide(columns_[2] + i),
                              simd::multiplyAdd(y, loadWide(columns_[1] + i), x * loadWide(columns_[0] + i)));
        const wide outside = place - simd::clamp(place, low, high);
        wide& sum = squared[i / kWide];
        sum = axis == 0 ? outside * outside : simd::multiplyAdd(outside, outside, sum);
      }
    };
    addAxis(std::integral_constant<int, 0>{});
    addAxis(std::integral_constant<int, 1>{});
    addAxis(std::integral_constant<int, 2>{});
    for (unsigned i = 0; i < kGroup; i += kWide) {
      const wide tagged = simd::withTag<kTagBits>(squared[i / kWide], j);
      simd::store(distances[j] + i, tagged);
      nearest[i / kWide] = simd::min(tagged, nearest[i / kWide]);
    }
  }
  alignas(32) float least[kGroup];
  for (unsigned i = 0; i < kGroup; i += kWide) simd::store(least + i, nearest[i / kWide]);
  // Each point begins with the leaf whose box is nearest to it: the other leaves then have little to offer.
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(least[i] <= limits_[i])) continue;
    const std::uint32_t j = simd::tagOf<kTagBits>(least[i]);
    searchLeaf(leaves[j], 1u << i);
    distances[j][i] = std::numeric_limits<float>::infinity();
  }
  for (std::uint32_t j = 0; j < leafCount; ++j) {
    simd::wideMask close[kGroup / kWide];
    for (unsigned i = 0; i < kGroup; i += kWide) close[i / kWide] = loadWide(distances[j] + i) <= loadWide(limits_ + i);
    if (const unsigned members = simd::bits(close); members != 0) searchLeaf(leaves[j], members);
  }
}

void NearestSearch::search(const float* positions, std::uint32_t count) noexcept {
  positions_ = positions;
  const f32x4 middle = load(tree_.middle);
  f32x4 lowCorner = load(positions);
  f32x4 highCorner = lowCorner;
  for (std::uint32_t i = 0; i < count; i += simd::kWidth) {
    f32x4 rows[simd::kWidth];
    for (std::uint32_t j = 0; j < simd::kWidth; ++j) {
      rows[j] = load(positions + Points::kStride * std::min(i + j, count - 1));
      lowCorner = simd::min(lowCorner, rows[j]);
      highCorner = simd::max(highCorner, rows[j]);
      rows[j] = rows[j] - middle;
      simd::store(points_[i + j], rows[j]);
    }
    simd::transpose(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 3; ++k) simd::store(columns_[k] + i, rows[k]);
    simd::store(limits_ + i, splat(std::numeric_limits<float>::max()));
    for (auto& squaredDistances : squaredDistances_)
      simd::store(squaredDistances + i, splat(std::numeric_limits<float>::infinity()));
  }
  const f32x4 low[3] = {simd::splatLane<0>(lowCorner), simd::splatLane<1>(lowCorner), simd::splatLane<2>(lowCorner)};
  const f32x4 high[3] = {simd::splatLane<0>(highCorner), simd::splatLane<1>(highCorner),
                         simd::splatLane<2>(highCorner)};
  std::fill(limits_ + count, limits_ + kGroup, -1.0f);
  // For limits to begin with: a leaf near where the last group ends, and one near where this one does.
  const std::uint32_t last = count - 1;
  const std::uint32_t seeds[] = {lastLeaf_, leafNear(load(positions + Points::kStride * last))};
  searchSeed(seeds[0], 0, count);
  if (seeds[1] != seeds[0]) searchSeed(seeds[1], 1, count);
  f32x4 most = load(limits_);
  for (std::uint32_t i = simd::kWidth; i < kGroup; i += simd::kWidth) most = simd::max(most, load(limits_ + i));
  std::uint32_t* leaves;
  std::uint32_t leafCount = listLeaves(low, high, simd::highest(most), leaves);
  for (const std::uint32_t seed : seeds) {
    if (std::uint32_t* const known = std::find(leaves, leaves + leafCount, seed); known < leaves + leafCount)
      *known = leaves[--leafCount];
  }
  for (std::uint32_t begin = 0; begin < leafCount; begin += kBatch) {
    searchLeaves(leaves + begin, std::min(kBatch, leafCount - begin), count);
  }

  // For all points at once: how many leaves each still has would be guessed wrong.
  for (std::uint32_t i = 0; i < count; i += simd::kWidth) {
    const f32x4 limits = load(limits_ + i);
    simd::count4 foundCount = simd::splatCount(0);
    simd::count4 found = foundCount;
#pragma GCC unroll 1
    for (std::uint32_t j = 0; j < kRoom; ++j) {
      const simd::mask4 isNear = load(squaredDistances_[j] + i) <= limits;
      foundCount = simd::countTrue(foundCount, isNear);
      found = simd::with(found, simd::load(lanes_[j] + i), isNear);
    }
    simd::store(foundCount_ + i, foundCount);
    simd::store(found_ + i, found);
  }

  // Where the last point is nearest, the next group begins.
  std::uint32_t nearest = 0;
  for (std::uint32_t j = 1; j < std::min(nearCount_[last], kRoom); ++j) {
    if (squaredDistances_[j][last] < squaredDistances_[nearest][last]) nearest = j;
  }
  lastLeaf_ = lanes_[nearest][last] >> 4;
}

std::uint32_t NearestSearch::candidates(std::uint32_t i, std::uint32_t* found) noexcept {
  std::uint32_t count = 0;
  const auto take = [&](std::uint32_t place) {
    const NearLeaf& leaf = tree_.near[lanes_[place][i] >> 4];
    for (unsigned lanes = lanes_[place][i] & 15; lanes != 0; lanes &= lanes - 1)
      found[count++] = leaf.slot[std::countr_zero(lanes)];
  };
  if (nearCount_[i] < kRoom) {
    for (std::uint32_t j = 0; j < nearCount_[i]; ++j) {
      if (squaredDistances_[j][i] <= limits_[i]) take(j);
    }
    return count;
  }
  // A fan around a corner, or a stack of copies: collect all within the limit, which is known by now.
  const f32x4 point = load(positions_ + Points::kStride * i);
  const f32x4 box[3] = {simd::splatLane<0>(point), simd::splatLane<1>(point), simd::splatLane<2>(point)};
  std::uint32_t* leaves;
  const std::uint32_t leafCount = listLeaves(box, box, splat(limits_[i]), leaves);
  for (std::uint32_t j = 0; j < leafCount; ++j) {
    nearCount_[i] = 0;  // What is found is the first then.
    searchLeaf(leaves[j], 1u << i);
    take(0);
  }
  nearCount_[i] = kRoom;
  return count;
}

}  // namespace cagecast
