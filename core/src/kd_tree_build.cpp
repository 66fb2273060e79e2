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
  const f32x4 most = splat(std::numeric_limits<float>::infinity());
  f32x4 low[3] = {most, most, most};
  f32x4 high[3] = {splat(0) - most, splat(0) - most, splat(0) - most};
  for (int i = 0; i < 3; ++i) {
    f32x4(&rows)[4] = corners[i];
    simd::transpose(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 3; ++k) {
      simd::store(leaf.corner[i][k], rows[k]);
      low[k] = simd::min(low[k], rows[k]);
      high[k] = simd::max(high[k], rows[k]);
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

/// Takes the memory of a tree over a row of leaves: four neighbours make a node, four nodes a node, up to the root.
/// @return The nodes, which `fillNodes` fills.
Node* takeTree(std::uint32_t leafCount, float reach, Scratch& scratch, RayTree& out) {
  out.leafCount = leafCount;
  out.reach = reach;
  out.levels = 0;
  std::uint32_t nodeCount = 0;
  for (std::uint32_t width = leafCount; out.levels == 0 || width > 1; ++out.levels) nodeCount += width = groupsOfFour(width);
  auto* nodes = scratch.take<Node>(nodeCount);
  out.nodes = nodes;
  out.lastLevel = nodeCount - groupsOfFour(leafCount);
  return nodes;
}

/// @param boxes  Of the leaves; used up.
void fillNodes(Box* boxes, Node* nodes, RayTree& out) {
  out.entryCount = out.levelsBelowEntry = 0;
  std::uint32_t childBase = 0;
  std::uint32_t childFlag = kLeafBit;
  std::uint32_t levelEnd = out.lastLevel + groupsOfFour(out.leafCount);
  for (std::uint32_t width = out.leafCount;;) {
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
    if (out.entryCount == 0 && levelSize <= RayTree::kMostEntries) {
      out.entry = levelBegin;
      out.entryCount = levelSize;
    }
    if (out.entryCount == 0) ++out.levelsBelowEntry;
    if (levelSize == 1) break;
    width = levelSize;
    levelEnd = childBase = levelBegin;
    childFlag = 0;
  }
}

/// Orders the cage's triangles so that runs of 4, 16, 64 … of them, which will be leaves and nodes, are compact: a k-d tree
/// whose every split is at such a run's end. (The surface area heuristic over bins finds trees no better for these queries,
/// with leaves half empty: 8 % slower.)
class CageOrder {
 public:
  /// @param centres  Of the triangles, 4 floats each.
  CageOrder(const float* centres, std::uint32_t* order) : centres_(centres), order_(order) {}

  /// @param run  Triangles below one child: 4, 16, 64 …
  void sort(std::uint32_t begin, std::uint32_t end, std::uint32_t run) {
    while (run > 4 && end - begin <= run) run /= 4;
    const std::uint32_t children = (end - begin + run - 1) / run;
    if (children < 2) return;
    Box box;
    for (std::uint32_t i = begin; i < end; ++i) box.grow(load(centres_ + 4 * order_[i]));
    float spread[4];
    simd::store(spread, box.high - box.low);
    const float* along = centres_ + (std::max_element(spread, spread + 3) - spread);
    const std::uint32_t middle = begin + children / 2 * run;
    std::nth_element(order_ + begin, order_ + middle, order_ + end,
                     [along](std::uint32_t a, std::uint32_t b) { return along[4 * a] < along[4 * b]; });
    sort(begin, middle, run);
    sort(middle, end, run);
  }

 private:
  const float* centres_;
  std::uint32_t* order_;
};

}  // namespace

bool buildCageTree(const Cage& cage, const Units& units, Scratch& scratch, CageTree& out) noexcept {
  const std::uint32_t leafCount = groupsOfFour(cage.count);
  auto* rayLeaves = scratch.take<RayLeaf>(leafCount);
  auto* nearLeaves = scratch.take<NearLeaf>(leafCount);
  auto* nodes = takeTree(leafCount, units.reach, scratch, out.rays);
  const Scratch::Mark mark = scratch.mark();
  auto* order = scratch.take<std::uint32_t>(cage.count);
  auto* centres = scratch.take<float>(std::size_t{4} * cage.count);
  auto* boxes = scratch.take<Box>(leafCount);
  if (scratch.failed()) return false;
  Box all;
  for (std::uint32_t i = 0; i < cage.count; ++i) {
    const CageTriangle& t = cage.triangles[i];
    Box box;
    box.grow(load(t.a));
    box.grow(load(t.b));
    box.grow(load(t.c));
    all.grow(box);
    simd::store(centres + 4 * i, box.low + box.high);
    order[i] = i;
  }
  std::uint32_t run = 4;
  while (run < cage.count) run *= 4;
  CageOrder(centres, order).sort(0, cage.count, run);

  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf) {
    Box box;
    f32x4 corners[3][4];
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      const std::uint32_t i = 4 * leaf + lane;
      if (i < cage.count) {
        const CageTriangle& t = cage.triangles[order[i]];
        corners[0][lane] = load(t.a);
        corners[1][lane] = load(t.b);
        corners[2][lane] = load(t.c);
        for (auto& corner : corners) box.grow(corner[lane]);
        setNearTriangle(nearLeaves[leaf], static_cast<int>(lane), t, order[i]);
      } else {
        corners[0][lane] = corners[1][lane] = corners[2][lane] = splat(0);
        clearNearTriangle(nearLeaves[leaf], static_cast<int>(lane));
      }
    }
    setRayLeaf(rayLeaves[leaf], corners, std::min(4u, cage.count - 4 * leaf), units.reach);
    boxes[leaf] = box.padded(kPadding * units.reach);
  }
  fillNodes(boxes, nodes, out.rays);
  scratch.rewind(mark);
  out.rays.leaves = rayLeaves;
  out.near = nearLeaves;
  float sides[4];
  simd::store(sides, all.high - all.low);
  out.extent = static_cast<double>(std::max({sides[0], sides[1], sides[2]}));
  return true;
}

bool buildTargetTree(const Points& target, const Units& units, Scratch& scratch, RayTree& out) noexcept {
  const std::uint32_t leafCount = std::max(1u, groupsOfFour(target.triangleCount));
  auto* leaves = scratch.take<RayLeaf>(leafCount);
  auto* nodes = takeTree(leafCount, units.reach, scratch, out);
  const Scratch::Mark mark = scratch.mark();
  auto* boxes = scratch.take<Box>(leafCount);
  auto* order = scratch.take<std::uint32_t>(target.triangleCount);
  auto* starts = scratch.take<std::uint32_t>(std::size_t{target.count} + 1);
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
  fillNodes(boxes, nodes, out);
  scratch.rewind(mark);
  out.leaves = leaves;
  return true;
}

}  // namespace cagecast
