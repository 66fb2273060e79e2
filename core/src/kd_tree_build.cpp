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

struct Box {
  float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                  std::numeric_limits<float>::infinity()};
  float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};

  void grow(const float* p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void grow(const Box& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  void pad(float by) {
    for (int k = 0; k < 3; ++k) {
      // The second term is an ulp of the coordinate: far from the origin the padding alone would round away.
      low[k] -= by + std::abs(low[k]) * 1.2e-7f;
      high[k] += by + std::abs(high[k]) * 1.2e-7f;
    }
  }
  [[nodiscard]] float halfArea() const {
    const float x = high[0] - low[0];
    const float y = high[1] - low[1];
    const float z = high[2] - low[2];
    return x * y + y * z + z * x;
  }
};

void setChild(Node& node, int lane, const Box& box, std::uint32_t child) {
  for (int k = 0; k < 3; ++k) {
    node.low[k][lane] = box.low[k];
    node.high[k][lane] = box.high[k];
  }
  node.child[lane] = child;
}

void setRayTriangle(RayLeaf& leaf, int lane, const float* a, const float* b, const float* c) {
  for (int k = 0; k < 3; ++k) {
    leaf.corner[0][k][lane] = a[k];
    leaf.corner[1][k][lane] = b[k];
    leaf.corner[2][k][lane] = c[k];
  }
}

void clearRayTriangle(RayLeaf& leaf, int lane) {
  constexpr float kZero[3] = {};
  setRayTriangle(leaf, lane, kZero, kZero, kZero);
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
  const Vec3 x = 1 / base * ab;
  const Vec3 z = triangle.normal.exact;
  const Vec3 y = cross(z, x);
  const double cx = dot(ac, x);
  const double cy = dot(ac, y);
  const double lengthC = std::sqrt(cx * cx + cy * cy);
  const double lengthB = std::sqrt((cx - base) * (cx - base) + cy * cy);

  const auto put = [lane](float (&to)[4], double value) { to[lane] = static_cast<float>(value); };
  const auto putVector = [&put](float (&to)[3][4], Vec3 v) {
    put(to[0], v.x);
    put(to[1], v.y);
    put(to[2], v.z);
  };
  putVector(leaf.origin, a);
  putVector(leaf.axes[0], x);
  putVector(leaf.axes[1], y);
  putVector(leaf.axes[2], z);
  put(leaf.base, base);
  put(leaf.height, cy);
  put(leaf.toC[0], cx / lengthC);
  put(leaf.toC[1], cy / lengthC);
  put(leaf.lengthC, lengthC);
  put(leaf.fromB[0], (cx - base) / lengthB);
  put(leaf.fromB[1], cy / lengthB);
  put(leaf.lengthB, lengthB);
  leaf.slot[lane] = slot;
}

void clearNearTriangle(NearLeaf& leaf, int lane) {
  constexpr float kFar = 1e15f;
  for (int k = 0; k < 3; ++k) {
    leaf.origin[k][lane] = kFar;
    for (int i = 0; i < 3; ++i) leaf.axes[i][k][lane] = i == k ? 1.0f : 0.0f;
  }
  leaf.base[lane] = leaf.height[lane] = leaf.lengthC[lane] = leaf.lengthB[lane] = 0;
  leaf.toC[0][lane] = leaf.fromB[1][lane] = 0;
  leaf.toC[1][lane] = leaf.fromB[0][lane] = 0;
  leaf.slot[lane] = 0;
}

constexpr std::uint32_t groupsOfFour(std::uint32_t count) { return (count + 3) / 4; }

/// Builds the cage's tree from the top, by the surface area heuristic over binned centroids (Wald 2007).
class CageTreeBuilder {
 public:
  CageTreeBuilder(const Cage& cage, float padding, const Box* boxes, std::uint32_t* order, Node* nodes, RayLeaf* rayLeaves,
                  NearLeaf* nearLeaves)
      : cage_(cage), padding_(padding), boxes_(boxes), order_(order), nodes_(nodes), rayLeaves_(rayLeaves), nearLeaves_(nearLeaves) {}

  void build() {
    Range all{0, cage_.count, {}};
    for (std::uint32_t i = 0; i < cage_.count; ++i) all.box.grow(boxes_[i]);
    nodeCount_ = 1;
    fill(0, all, 0);
  }

 private:
  static constexpr int kBins = 8;
  /// Below this depth ranges are halved, whatever their shape, so that a traversal's stack has a bound.
  static constexpr int kMaxDepth = 32;

  /// A run of `order_` and the box around it.
  struct Range {
    std::uint32_t begin, end;
    Box box;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };

  void fill(std::uint32_t nodeIndex, const Range& range, int depth) {
    Range children[4] = {range};
    int count = 1;
    while (count < 4) {
      int widest = -1;
      for (int i = 0; i < count; ++i) {
        if (children[i].size() > 4 && (widest < 0 || children[i].box.halfArea() > children[widest].box.halfArea())) widest = i;
      }
      if (widest < 0) break;
      const Range parent = children[widest];
      split(parent, depth, children[widest], children[count]);
      ++count;
    }
    for (int i = 0; i < 4; ++i) {
      if (i >= count) {
        setChild(nodes_[nodeIndex], i, Box{}, kLeafBit);
        continue;
      }
      Box padded = children[i].box;
      padded.pad(padding_);
      if (children[i].size() <= 4) {
        setChild(nodes_[nodeIndex], i, padded, kLeafBit | makeLeaf(children[i]));
      } else {
        const std::uint32_t child = nodeCount_++;
        setChild(nodes_[nodeIndex], i, padded, child);
        fill(child, children[i], depth + 1);
      }
    }
  }

  std::uint32_t makeLeaf(const Range& range) {
    const std::uint32_t leaf = leafCount_++;
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      const int at = static_cast<int>(lane);
      if (lane < range.size()) {
        const std::uint32_t slot = order_[range.begin + lane];
        const CageTriangle& t = cage_.triangles[slot];
        setRayTriangle(rayLeaves_[leaf], at, t.a, t.b, t.c);
        setNearTriangle(nearLeaves_[leaf], at, t, slot);
      } else {
        clearRayTriangle(rayLeaves_[leaf], at);
        clearNearTriangle(nearLeaves_[leaf], at);
      }
    }
    return leaf;
  }

  [[nodiscard]] float centre(std::uint32_t slot, int axis) const { return boxes_[slot].low[axis] + boxes_[slot].high[axis]; }

  void split(const Range& range, int depth, Range& left, Range& right) {
    float low[3];
    float high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::numeric_limits<float>::infinity();
      high[k] = -low[k];
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        low[k] = std::min(low[k], centre(order_[i], k));
        high[k] = std::max(high[k], centre(order_[i], k));
      }
    }
    float bestCost = std::numeric_limits<float>::infinity();
    int bestAxis = -1;
    int bestBin = 0;
    for (int axis = 0; axis < 3 && depth < kMaxDepth; ++axis) {
      if (!(high[axis] > low[axis])) continue;
      Box boxes[kBins];
      std::uint32_t counts[kBins] = {};
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const int bin = binOf(order_[i], axis, low[axis], high[axis]);
        boxes[bin].grow(boxes_[order_[i]]);
        ++counts[bin];
      }
      float costFromRight[kBins];
      Box box;
      std::uint32_t count = 0;
      for (int bin = kBins - 1; bin > 0; --bin) {
        box.grow(boxes[bin]);
        count += counts[bin];
        costFromRight[bin] = count == 0 ? std::numeric_limits<float>::infinity() : box.halfArea() * static_cast<float>(groupsOfFour(count));
      }
      box = {};
      count = 0;
      for (int bin = 0; bin < kBins - 1; ++bin) {
        box.grow(boxes[bin]);
        count += counts[bin];
        if (count == 0) continue;
        const float cost = box.halfArea() * static_cast<float>(groupsOfFour(count)) + costFromRight[bin + 1];
        if (cost < bestCost) {
          bestCost = cost;
          bestAxis = axis;
          bestBin = bin;
        }
      }
    }
    std::uint32_t middle = range.begin + range.size() / 2;
    if (bestAxis >= 0) {
      middle = static_cast<std::uint32_t>(
          std::partition(order_ + range.begin, order_ + range.end,
                         [&](std::uint32_t slot) { return binOf(slot, bestAxis, low[bestAxis], high[bestAxis]) <= bestBin; }) -
          order_);
    }
    left = rangeOf(range.begin, middle);
    right = rangeOf(middle, range.end);
  }

  [[nodiscard]] int binOf(std::uint32_t slot, int axis, float low, float high) const {
    const float share = (centre(slot, axis) - low) / (high - low);
    return std::clamp(static_cast<int>(share * static_cast<float>(kBins)), 0, kBins - 1);
  }

  [[nodiscard]] Range rangeOf(std::uint32_t begin, std::uint32_t end) const {
    Range range{begin, end, {}};
    for (std::uint32_t i = begin; i < end; ++i) range.box.grow(boxes_[order_[i]]);
    return range;
  }

  const Cage& cage_;
  float padding_;
  const Box* boxes_;
  std::uint32_t* order_;
  Node* nodes_;
  RayLeaf* rayLeaves_;
  NearLeaf* nearLeaves_;
  std::uint32_t nodeCount_ = 0;
  std::uint32_t leafCount_ = 0;
};

}  // namespace

bool buildCageTree(const Cage& cage, const Units& units, Scratch& scratch, CageTree& out) noexcept {
  // A split never makes an empty side, so a leaf has at least one triangle, and a node at least two children.
  auto* nodes = scratch.take<Node>(cage.count);
  auto* rayLeaves = scratch.take<RayLeaf>(cage.count);
  auto* nearLeaves = scratch.take<NearLeaf>(cage.count);
  const Scratch::Mark mark = scratch.mark();
  auto* boxes = scratch.take<Box>(cage.count);
  auto* order = scratch.take<std::uint32_t>(cage.count);
  if (scratch.failed()) return false;
  Box all;
  for (std::uint32_t i = 0; i < cage.count; ++i) {
    const CageTriangle& t = cage.triangles[i];
    boxes[i] = {};
    boxes[i].grow(t.a);
    boxes[i].grow(t.b);
    boxes[i].grow(t.c);
    all.grow(boxes[i]);
    order[i] = i;
  }
  CageTreeBuilder(cage, kPadding * units.reach, boxes, order, nodes, rayLeaves, nearLeaves).build();
  scratch.rewind(mark);
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, all.high[k] - all.low[k]);
  out = {{nodes, rayLeaves}, nearLeaves, static_cast<double>(extent)};
  return true;
}

bool buildTargetTree(const Points& target, const Units& units, Scratch& scratch, RayTree& out) noexcept {
  const std::uint32_t leafCount = std::max(1u, groupsOfFour(target.triangleCount));
  std::uint32_t nodeCount = 0;
  for (std::uint32_t width = leafCount; nodeCount == 0 || width > 1; width = groupsOfFour(width)) nodeCount += groupsOfFour(width);
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
    boxes[leaf] = {};
    for (int lane = 0; lane < 4; ++lane) {
      const std::uint32_t i = 4 * leaf + static_cast<std::uint32_t>(lane);
      if (i >= target.triangleCount) {
        clearRayTriangle(leaves[leaf], lane);
        continue;
      }
      const std::uint32_t* corner = target.triangles + std::size_t{3} * order[i];
      const float* positions[3] = {target.at(corner[0]), target.at(corner[1]), target.at(corner[2])};
      setRayTriangle(leaves[leaf], lane, positions[0], positions[1], positions[2]);
      for (const float* p : positions) boxes[leaf].grow(p);
    }
    if (target.triangleCount > 0) boxes[leaf].pad(kPadding * units.reach);
  }
  // Levels are stored root first, so that the root is node 0; they are filled from the leaves upwards.
  std::uint32_t childBase = 0;
  std::uint32_t childFlag = kLeafBit;
  std::uint32_t levelEnd = nodeCount;
  for (std::uint32_t width = leafCount;;) {
    const std::uint32_t levelSize = groupsOfFour(width);
    const std::uint32_t levelBegin = levelEnd - levelSize;
    for (std::uint32_t i = 0; i < levelSize; ++i) {
      Box around;
      for (int lane = 0; lane < 4; ++lane) {
        const std::uint32_t child = 4 * i + static_cast<std::uint32_t>(lane);
        const Box box = child < width ? boxes[child] : Box{};
        setChild(nodes[levelBegin + i], lane, box, child < width ? childFlag | (childBase + child) : kLeafBit);
        around.grow(box);
      }
      boxes[i] = around;
    }
    if (levelSize == 1) break;
    width = levelSize;
    levelEnd = childBase = levelBegin;
    childFlag = 0;
  }
  scratch.rewind(mark);
  out = {nodes, leaves};
  return true;
}

}  // namespace cagecast
