#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kd_tree.hpp"
#include "triangle.hpp"

namespace cagecast {
namespace {

/// How much larger than its contents a box is, as a share of the scene: the ray kernel rounds coordinates relative to the
/// ray's origin by at most 2^-23 of their size, and this is eight times that. The lattice tests leak without it.
constexpr float kPadding = 1e-6f;

using simd::f32x4;
using simd::load;
using simd::splat;

/// A box; the fourth lane is not used.
struct Box {
  f32x4 low = splat(std::numeric_limits<float>::infinity());
  f32x4 high = splat(-std::numeric_limits<float>::infinity());

  void grow(f32x4 p) {
    low = simd::min(low, p);
    high = simd::max(high, p);
  }
  void grow(const Box& other) {
    low = simd::min(low, other.low);
    high = simd::max(high, other.high);
  }
  [[nodiscard]] Box padded(float by) const {
    // The second term is an ulp of the coordinate: far from the origin the padding alone would round away.
    const f32x4 most = simd::max(simd::max(low, splat(0) - low), simd::max(high, splat(0) - high));
    const f32x4 pad = splat(by) + most * splat(1.2e-7f);
    Box box;
    box.low = low - pad;
    box.high = high + pad;
    return box;
  }
  [[nodiscard]] float halfArea() const {
    float side[4];
    simd::store(side, high - low);
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
  }
};

void setChildren(Node& node, const Box (&boxes)[4]) {
  f32x4 low[4] = {boxes[0].low, boxes[1].low, boxes[2].low, boxes[3].low};
  f32x4 high[4] = {boxes[0].high, boxes[1].high, boxes[2].high, boxes[3].high};
  simd::transpose(low[0], low[1], low[2], low[3]);
  simd::transpose(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 3; ++k) {
    simd::store(node.low[k], low[k]);
    simd::store(node.high[k], high[k]);
  }
}

/// The rounding of an edge function in float, for a ray that hits, as a share of the scene's reach R times the triangle's
/// size E: corners are moved and sheared with errors up to 2^-21 R, then lie within 2 E of the ray; of their products four
/// are off by as much. The double of that.
constexpr float kEdgeRounding = 0x1p-17f;

/// Puts up to four triangles into a leaf.
/// @param corners  Of all four, corner by corner; anything where unused.
void setRayLeaf(RayLeaf& leaf, f32x4 (&corners)[3][4], std::uint32_t used, float reach) {
  f32x4 low[3];
  f32x4 high[3];
  for (int i = 0; i < 3; ++i) {
    f32x4(&rows)[4] = corners[i];
    simd::transpose(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 3; ++k) {
      simd::store(leaf.corner[i][k], rows[k]);
      low[k] = i == 0 ? rows[k] : simd::min(low[k], rows[k]);
      high[k] = i == 0 ? rows[k] : simd::max(high[k], rows[k]);
    }
  }
  const f32x4 size = (high[0] - low[0]) + (high[1] - low[1]) + (high[2] - low[2]);
  simd::store(leaf.rounding, size * splat(kEdgeRounding * reach));
  for (std::uint32_t lane = used; lane < 4; ++lane) leaf.rounding[lane] = -1;
}

void setNearTriangle(NearLeaf& leaf, int lane, const CageTriangle& triangle, std::uint32_t slot) {
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  int longest = 0;
  double longestSquared = -1;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = corners[(i + 1) % 3] - corners[i];
    if (dot(edge, edge) > longestSquared) {
      longestSquared = dot(edge, edge);
      longest = i;
    }
  }
  const Vec3 a = corners[longest];
  const Vec3 ab = corners[(longest + 1) % 3] - a;
  const Vec3 ac = corners[(longest + 2) % 3] - a;
  const double base = length(ab);
  const Vec3 axisX = 1 / base * ab;
  const Vec3 axisZ = triangle.normal.exact;
  const Vec3 axisY = cross(axisZ, axisX);
  const double footX = dot(ac, axisX);
  const double height = dot(ac, axisY);

  const auto put = [lane](float (&to)[4], double value) { to[lane] = static_cast<float>(value); };
  const auto putVector = [&put](float (&to)[3][4], Vec3 v) {
    put(to[0], v.x);
    put(to[1], v.y);
    put(to[2], v.z);
  };
  const auto putEdge = [&put, height](NearLeaf::Edge& edge, double toFoot) {
    const double edgeLength = std::sqrt(toFoot * toFoot + height * height);
    put(edge.x, toFoot / edgeLength);
    put(edge.y, height / edgeLength);
    put(edge.length, edgeLength);
  };
  putVector(leaf.origin, a);
  putVector(leaf.axes[0], axisX);
  putVector(leaf.axes[1], axisY);
  putVector(leaf.axes[2], axisZ);
  put(leaf.base, base);
  put(leaf.foot, footX);
  putEdge(leaf.left, footX);
  putEdge(leaf.right, base - footX);
  leaf.slot[lane] = slot;
}

void clearNearTriangle(NearLeaf& leaf, int lane) {
  constexpr float kFar = 1e15f;
  for (int k = 0; k < 3; ++k) {
    leaf.origin[k][lane] = kFar;
    for (int i = 0; i < 3; ++i) leaf.axes[i][k][lane] = i == k ? 1.0f : 0.0f;
  }
  leaf.base[lane] = leaf.foot[lane] = 0;
  for (NearLeaf::Edge* edge : {&leaf.left, &leaf.right}) edge->x[lane] = edge->y[lane] = edge->length[lane] = 0;
  leaf.slot[lane] = 0;
}

constexpr std::uint32_t groupsOfFour(std::uint32_t count) { return (count + 3) / 4; }

/// Builds the cage's tree from the top, by the surface area heuristic over binned centroids (Wald 2007), along the axis on
/// which the centroids spread most: looking at all three costs three times as much and finds trees hardly better.
class CageTreeBuilder {
 public:
  struct Leaf {
    std::uint32_t begin, size;
  };

  /// @param order   Room for all triangles; on return they stand leaf by leaf.
  /// @param leaves  Room for as many: on return the part of `order` that each leaf holds.
  /// @param nodes   Room for as many.
  CageTreeBuilder(std::uint32_t count, float reach, const Box* boxes, std::uint32_t* order, Leaf* leaves, Node* nodes)
      : count_(count), reach_(reach), boxes_(boxes), order_(order), leaves_(leaves), nodes_(nodes) {}

  void build(const Box& all) {
    nodeCount_ = 1;
    fill(0, {0, count_, all}, 1);
  }
  [[nodiscard]] std::uint32_t nodeCount() const { return nodeCount_; }
  [[nodiscard]] std::uint32_t leafCount() const { return leafCount_; }
  [[nodiscard]] std::uint32_t levels() const { return levels_; }

 private:
  static constexpr int kBins = 8;
  /// Below this level ranges are halved, whatever their shape, so that the number of levels has a bound.
  static constexpr std::uint32_t kMaxBinnedLevel = 32;

  /// A run of `order_` and the box around it.
  struct Range {
    std::uint32_t begin, end;
    Box box;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };

  void fill(std::uint32_t nodeIndex, const Range& range, std::uint32_t level) {
    levels_ = std::max(levels_, level);
    Range children[4] = {range, {}, {}, {}};
    int count = 1;
    for (; count < 4; ++count) {
      int widest = -1;
      float widestArea = -1;
      for (int i = 0; i < count; ++i) {
        const float area = children[i].box.halfArea();
        if (children[i].size() <= 4 || !(area > widestArea)) continue;
        widestArea = area;
        widest = i;
      }
      if (widest < 0) break;
      const Range parent = children[widest];
      split(parent, level, children[widest], children[count]);
    }
    Box boxes[4];
    std::uint32_t* child = nodes_[nodeIndex].child;
    for (int i = 0; i < 4; ++i) {
      child[i] = kLeafBit;
      if (i >= count) continue;
      boxes[i] = children[i].box.padded(kPadding * reach_);
      if (children[i].size() > 4) {
        child[i] = nodeCount_++;
      } else {
        child[i] = kLeafBit | leafCount_;
        leaves_[leafCount_++] = {children[i].begin, children[i].size()};
      }
    }
    setChildren(nodes_[nodeIndex], boxes);
    for (int i = 0; i < count; ++i) {
      if ((child[i] & kLeafBit) == 0) fill(child[i], children[i], level + 1);
    }
  }

  /// Twice the centre of a triangle's box.
  [[nodiscard]] f32x4 centre(std::uint32_t slot) const { return boxes_[slot].low + boxes_[slot].high; }

  [[nodiscard]] float at(std::uint32_t slot, int axis) const {
    float coordinates[4];
    simd::store(coordinates, centre(slot));
    return coordinates[axis];
  }

  void split(const Range& range, std::uint32_t level, Range& left, Range& right) {
    Box centres;
    for (std::uint32_t i = range.begin; i < range.end; ++i) centres.grow(centre(order_[i]));
    float low[4];
    float spread[4];
    simd::store(low, centres.low);
    simd::store(spread, centres.high - centres.low);
    const int axis = static_cast<int>(std::max_element(spread, spread + 3) - spread);
    const float toBin = static_cast<float>(kBins) * 0.9999f / spread[axis];
    if (!(spread[axis] > 0) || !(toBin < std::numeric_limits<float>::max()) || level > kMaxBinnedLevel) {
      const std::uint32_t half = range.begin + range.size() / 2;
      left = rangeOf(range.begin, half);
      right = rangeOf(half, range.end);
      return;
    }

    const auto binOf = [&](std::uint32_t slot) { return static_cast<int>((at(slot, axis) - low[axis]) * toBin); };
    Box boxes[kBins];
    std::uint32_t counts[kBins] = {};
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const int bin = binOf(order_[i]);
      boxes[bin].grow(boxes_[order_[i]]);
      ++counts[bin];
    }
    float rightCost[kBins];
    std::uint32_t count = 0;
    Box box;
    for (int bin = kBins - 1; bin > 0; --bin) {
      box.grow(boxes[bin]);
      count += counts[bin];
      rightCost[bin] = box.halfArea() * static_cast<float>(groupsOfFour(count));
    }
    float bestCost = std::numeric_limits<float>::infinity();
    std::uint32_t middle = range.begin;
    int best = 0;
    count = 0;
    box = {};
    for (int bin = 0; bin < kBins - 1; ++bin) {
      box.grow(boxes[bin]);
      count += counts[bin];
      const float cost = box.halfArea() * static_cast<float>(groupsOfFour(count)) + rightCost[bin + 1];
      if (!(cost < bestCost)) continue;
      bestCost = cost;
      middle = range.begin + count;
      best = bin + 1;
    }
    std::uint32_t* first = order_ + range.begin;
    std::partition(first, order_ + range.end, [&](std::uint32_t slot) { return binOf(slot) < best; });
    // Full leaves are better than tight ones: the split is moved to the next multiple of four.
    const std::uint32_t full = range.begin + std::clamp((middle - range.begin + 2) / 4 * 4, 4u, (range.size() - 1) / 4 * 4);
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return at(a, axis) < at(b, axis); };
    if (full < middle) std::nth_element(first, order_ + full, order_ + middle, before);
    if (full > middle) std::nth_element(order_ + middle, order_ + full, order_ + range.end, before);
    left = rangeOf(range.begin, full);
    right = rangeOf(full, range.end);
  }

  [[nodiscard]] Range rangeOf(std::uint32_t begin, std::uint32_t end) const {
    Range range{begin, end, {}};
    for (std::uint32_t i = begin; i < end; ++i) range.box.grow(boxes_[order_[i]]);
    return range;
  }

  std::uint32_t count_;
  float reach_;  ///< See `RayTree`.
  const Box* boxes_;
  std::uint32_t* order_;
  Leaf* leaves_;
  Node* nodes_;
  std::uint32_t nodeCount_ = 0;
  std::uint32_t leafCount_ = 0;
  std::uint32_t levels_ = 0;
};

}  // namespace

bool buildCageTree(const Cage& cage, const Units& units, Scratch& scratch, CageTree& out) noexcept {
  auto* order = scratch.take<std::uint32_t>(cage.count);
  auto* built = scratch.take<CageTreeBuilder::Leaf>(cage.count);
  auto* boxes = scratch.take<Box>(cage.count);
  // A split never makes an empty side, so a leaf has at least one triangle, and a node at least two children.
  auto* nodes = scratch.take<Node>(cage.count);
  if (scratch.failed()) return false;
  Box all;
  for (std::uint32_t i = 0; i < cage.count; ++i) {
    const CageTriangle& t = cage.triangles[i];
    Box box;
    box.grow(load(t.a));
    box.grow(load(t.b));
    box.grow(load(t.c));
    boxes[i] = box;
    all.grow(box);
    order[i] = i;
  }
  CageTreeBuilder builder(cage.count, units.reach, boxes, order, built, nodes);
  builder.build(all);
  scratch.shrink(nodes, builder.nodeCount());

  const std::uint32_t leafCount = builder.leafCount();
  auto* rayLeaves = scratch.take<RayLeaf>(leafCount);
  auto* nearLeaves = scratch.take<NearLeaf>(leafCount);
  if (scratch.failed()) return false;
  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf) {
    const auto [begin, size] = built[leaf];
    f32x4 corners[3][4];
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      if (lane < size) {
        const CageTriangle& t = cage.triangles[order[begin + lane]];
        corners[0][lane] = load(t.a);
        corners[1][lane] = load(t.b);
        corners[2][lane] = load(t.c);
        setNearTriangle(nearLeaves[leaf], static_cast<int>(lane), t, order[begin + lane]);
      } else {
        corners[0][lane] = corners[1][lane] = corners[2][lane] = splat(0);
        clearNearTriangle(nearLeaves[leaf], static_cast<int>(lane));
      }
    }
    setRayLeaf(rayLeaves[leaf], corners, size, units.reach);
  }
  float sides[4];
  simd::store(sides, all.high - all.low);
  out = {{nodes, rayLeaves, units.reach, builder.levels()}, nearLeaves, static_cast<double>(std::max({sides[0], sides[1], sides[2]}))};
  return true;
}

bool buildTargetTree(const Points& target, const Units& units, Scratch& scratch, RayTree& out) noexcept {
  const std::uint32_t leafCount = std::max(1u, groupsOfFour(target.triangleCount));
  std::uint32_t nodeCount = 0;
  std::uint32_t levels = 0;
  for (std::uint32_t width = leafCount; levels == 0 || width > 1; ++levels) nodeCount += width = groupsOfFour(width);
  auto* nodes = scratch.take<Node>(nodeCount);
  auto* leaves = scratch.take<RayLeaf>(leafCount);
  const Scratch::Mark mark = scratch.mark();
  auto* order = scratch.take<std::uint32_t>(target.triangleCount);
  auto* starts = scratch.take<std::uint32_t>(std::size_t{target.count} + 1);
  auto* boxes = scratch.take<Box>(leafCount);
  if (scratch.failed()) return false;

  // Points are in curve order; sorting triangles by their first point puts them in curve order as well.
  const auto firstPoint = [&](std::uint32_t t) {
    const std::uint32_t* corner = target.triangles + std::size_t{3} * t;
    return std::min({corner[0], corner[1], corner[2]});
  };
  std::fill(starts, starts + target.count + 1, 0u);
  for (std::uint32_t t = 0; t < target.triangleCount; ++t) ++starts[firstPoint(t)];
  std::uint32_t sum = 0;
  for (std::uint32_t p = 0; p < target.count; ++p) sum += std::exchange(starts[p], sum);
  for (std::uint32_t t = 0; t < target.triangleCount; ++t) order[starts[firstPoint(t)]++] = t;

  // Four neighbours along the curve make a leaf, four leaves a node, four nodes a node, up to the root.
  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf) {
    Box box;
    f32x4 corners[3][4];
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      const std::uint32_t i = 4 * leaf + lane;
      for (std::size_t k = 0; k < 3; ++k) {
        if (i < target.triangleCount) {
          corners[k][lane] = load(target.at(target.triangles[std::size_t{3} * order[i] + k]));
          box.grow(corners[k][lane]);
        } else {
          corners[k][lane] = splat(0);
        }
      }
    }
    setRayLeaf(leaves[leaf], corners, std::min(4u, target.triangleCount - 4 * leaf), units.reach);
    boxes[leaf] = target.triangleCount == 0 ? box : box.padded(kPadding * units.reach);
  }
  // Levels are stored root first, so that the root is node 0; they are filled from the leaves upwards.
  std::uint32_t childBase = 0;
  std::uint32_t childFlag = kLeafBit;
  std::uint32_t levelEnd = nodeCount;
  for (std::uint32_t width = leafCount;;) {
    const std::uint32_t levelSize = groupsOfFour(width);
    const std::uint32_t levelBegin = levelEnd - levelSize;
    for (std::uint32_t i = 0; i < levelSize; ++i) {
      Box children[4];
      Box around;
      for (std::uint32_t lane = 0; lane < 4; ++lane) {
        const std::uint32_t child = 4 * i + lane;
        nodes[levelBegin + i].child[lane] = child < width ? childFlag | (childBase + child) : kLeafBit;
        if (child >= width) continue;
        children[lane] = boxes[child];
        around.grow(boxes[child]);
      }
      setChildren(nodes[levelBegin + i], children);
      boxes[i] = around;
    }
    if (levelSize == 1) break;
    width = levelSize;
    levelEnd = childBase = levelBegin;
    childFlag = 0;
  }
  scratch.rewind(mark);
  out = {nodes, leaves, units.reach, levels};
  return true;
}

}  // namespace cagecast
