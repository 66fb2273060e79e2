#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "geometry/triangle.hpp"
#include "search/kd_tree.hpp"

namespace cagecast {
namespace {

/// How much larger than its contents a box is, as a share of the scene: the ray kernel rounds coordinates relative to
/// the ray's origin by at most 2^-23 of their size, and this is eight times that. The lattice tests leak without it.
constexpr float kPadding = 1e-6f;

/// The same for boxes that are turned. Coordinates along their axes are sums of three products, which are each rounded
/// by up to 2^-24 of a scene, of the box's corners and of points alike; this is ten times what these come to.
constexpr float kTurnedPadding = 5e-6f;

/// A coordinate where nothing is: products with it, and its square, are still finite.
constexpr float kFar = 1e15f;

using simd::f32x4;
using simd::load;
using simd::splat;

/// A box; the fourth lane is not used.
struct Box {
  f32x4 low = splat(std::numeric_limits<float>::infinity());
  f32x4 high = splat(-std::numeric_limits<float>::infinity());

  static Box nowhere() {
    Box box;
    box.low = box.high = splat(kFar);
    return box;
  }
  void grow(f32x4 p) {
    low = simd::min(low, p);
    high = simd::max(high, p);
  }
  void grow(const Box& other) {
    low = simd::min(low, other.low);
    high = simd::max(high, other.high);
  }
  [[nodiscard]] Box padded(float by) const {
    // The second term is two ulps of the coordinate: far from the origin the padding alone would round away.
    const f32x4 most = simd::max(splat(0) - low, high);
    const f32x4 pad = splat(by) + most * splat(2.4e-7f);
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

/// Sets one lane of a leaf.
/// @param middle  Of the cage.
void setNearTriangle(NearLeaf& leaf, std::uint32_t lane, const CageTriangle& t, const float* middle) {
  const Vec3 corners[3] = {Vec3::from(t.a), Vec3::from(t.b), Vec3::from(t.c)};
  std::size_t longest = 0;
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = corners[(i + 1) % 3] - corners[i];
    if (dot(edge, edge) > most) {
      most = dot(edge, edge);
      longest = i;
    }
  }
  const Vec3 a = corners[longest];
  const Vec3 ab = corners[(longest + 1) % 3] - a;
  const Vec3 ac = corners[(longest + 2) % 3] - a;
  const double base = length(ab);
  const Vec3 axisX = 1 / base * ab;
  const Vec3& axisZ = t.normal.exact;
  const Vec3 axisY = cross(axisZ, axisX);
  const double footX = dot(ac, axisX);
  const double height = dot(ac, axisY);

  const auto put = [lane](float(&to)[4], double value) { to[lane] = static_cast<float>(value); };
  const auto putAxis = [&put, fromA = Vec3::from(middle) - a](NearLeaf::Axis& axis, Vec3 direction) {
    put(axis.offset, dot(fromA, direction));
    put(axis.direction[0], direction.x);
    put(axis.direction[1], direction.y);
    put(axis.direction[2], direction.z);
  };
  const auto putEdge = [&](double toFoot, float(&x)[4], float(&y)[4], float(&along)[4]) {
    const double edgeLength = std::sqrt(toFoot * toFoot + height * height);
    put(x, toFoot / edgeLength);
    put(y, height / edgeLength);
    put(along, edgeLength);
  };
  putAxis(leaf.axes[0], axisX);
  putAxis(leaf.axes[1], axisY);
  putAxis(leaf.axes[2], axisZ);
  put(leaf.base, base);
  put(leaf.foot, footX);
  putEdge(footX, leaf.leftX, leaf.leftY, leaf.leftLength);
  putEdge(base - footX, leaf.rightX, leaf.rightY, leaf.rightLength);
}

void clearNearTriangle(NearLeaf& leaf, std::uint32_t lane) {
  for (int i = 0; i < 3; ++i) {
    leaf.axes[i].offset[lane] = kFar;
    for (int k = 0; k < 3; ++k) leaf.axes[i].direction[k][lane] = i == k ? 1.0f : 0.0f;
  }
  leaf.base[lane] = leaf.foot[lane] = 0;
  leaf.leftX[lane] = leaf.leftY[lane] = leaf.leftLength[lane] = 0;
  leaf.rightX[lane] = leaf.rightY[lane] = leaf.rightLength[lane] = 0;
  leaf.slot[lane] = 0;
}

constexpr std::uint32_t groupsOfFour(std::uint32_t count) { return (count + 3) / 4; }

/// Takes the memory of a tree over a row of leaves: four neighbours make a node, four nodes a node, up to the root.
/// @return The nodes, which `fillNodes` fills.
Node* takeNodes(std::uint32_t leafCount, Arena& arena, CageTree& out) {
  out.leafCount = leafCount;
  std::uint32_t nodeCount = 0;
  std::uint32_t width = leafCount;
  do nodeCount += width = groupsOfFour(width);
  while (width > 1);
  out.lastLevel = nodeCount - groupsOfFour(leafCount);
  return arena.allocate<Node>(nodeCount);
}

/// @param boxes  Of the leaves; used up.
void fillNodes(Box* boxes, Node* nodes, CageTree& out) {
  out.entryCount = out.levelsBelowEntry = 0;
  std::uint32_t childBase = 0;
  std::uint32_t levelEnd = out.lastLevel + groupsOfFour(out.leafCount);
  for (std::uint32_t width = out.leafCount;;) {
    const std::uint32_t levelSize = groupsOfFour(width);
    const std::uint32_t levelBegin = levelEnd - levelSize;
    const bool overLeaves = levelBegin == out.lastLevel;
    for (std::uint32_t i = 0; i < levelSize; ++i) {
      Box children[4];
      Box around;
      for (std::uint32_t lane = 0; lane < 4; ++lane) {
        const std::uint32_t child = 4 * i + lane;
        nodes[levelBegin + i].child[lane] = kLeafBit;
        children[lane] = Box::nowhere();
        if (child >= width) continue;
        nodes[levelBegin + i].child[lane] = overLeaves ? leafOf(4 * child) : childBase + child;
        children[lane] = boxes[child];
        around.grow(boxes[child]);
      }
      setChildren(nodes[levelBegin + i], children);
      boxes[i] = around;
    }
    if (out.entryCount == 0 && levelSize <= CageTree::kMostEntries) {
      out.entry = levelBegin;
      out.entryCount = levelSize;
    }
    if (out.entryCount == 0) ++out.levelsBelowEntry;
    if (levelSize == 1) break;
    width = levelSize;
    levelEnd = childBase = levelBegin;
  }
}

/// Orders the cage's triangles so that runs of 4, 16, 64 … of them, which will be leaves and nodes, are compact: a k-d
/// tree whose every split is at such a run's end. (The surface area heuristic over bins finds trees no better for these
/// queries, with leaves half empty: 8 % slower.)
class CageOrder {
 public:
  /// A triangle to be ordered: twice the middle of its box.
  struct alignas(16) Item {
    float centre[3];
    std::uint32_t slot;
  };

  explicit CageOrder(Item* items) : items_(items) {}

  /// @param run  Triangles below one child: 4, 16, 64 …
  void sort(std::uint32_t begin, std::uint32_t end, std::uint32_t run) {
    while (run > 4 && end - begin <= run) run /= 4;
    const std::uint32_t children = (end - begin + run - 1) / run;
    if (children < 2) return;
    const std::uint32_t middle = begin + children / 2 * run;
    split(begin, middle, end);
    sort(begin, middle, run);
    sort(middle, end, run);
  }

 private:
  /// Puts those that come first along the longest side of the box around all before `middle`, the others after it.
  /// As `std::nth_element`, but what is less than a pivot moves without a branch, which could not be guessed.
  void split(std::uint32_t begin, std::uint32_t middle, std::uint32_t end) const {
    float* const all = items_->centre;
    float low[4];
    float high[4];
    const auto measure = [&] {
      Box box;
      for (std::uint32_t i = begin; i < end; ++i) box.grow(load(all + kStride * i));
      simd::store(low, box.low);
      simd::store(high, box.high);
    };
    measure();
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    bool helped = true;
    while (begin < middle && low[axis] < high[axis]) {
      // Where the middle would be, were they evenly spread; if that did not help much, the middle of the box.
      const float share = helped ? static_cast<float>(middle - begin) / static_cast<float>(end - begin) : 0.5f;
      const float between = low[axis] + share * (high[axis] - low[axis]);
      const float pivot = between > low[axis] ? between : high[axis];
      float* less = all + kStride * begin;
      for (float* item = less; item < all + kStride * end; item += kStride) {
        const f32x4 moved = load(item);
        const bool isLess = item[axis] < pivot;
        simd::store(item, load(less));
        simd::store(less, moved);
        less += isLess ? kStride : 0;
      }
      const std::uint32_t before = end - begin;
      const auto cut = static_cast<std::uint32_t>((less - all) / std::ptrdiff_t{kStride});
      if (cut <= middle) {
        begin = cut;
        low[axis] = pivot;
      } else {
        end = cut;
        high[axis] = pivot;
      }
      helped = 2 * (end - begin) <= before;
      if (!helped) measure();
    }
  }

  static constexpr std::size_t kStride = sizeof(Item) / sizeof(float);
  Item* items_;
};

std::uint32_t firstPointOf(const std::uint32_t* corner) { return std::min({corner[0], corner[1], corner[2]}); }

/// Cuts triangles that are in the order of a curve where the curve goes from one half of a cell to the other, so that
/// what is between two cuts has a box of its own.
class CurveCuts {
 public:
  /// @param corners  Of the triangles, in the order of their first points.
  /// @param places   Of the points along the curve, ascending.
  CurveCuts(const std::uint32_t* corners, const std::uint32_t* places) : corners_(corners), places_(places) {}

  /// What `add` notes for a leaf: its first triangle, and in the lowest two bits how many more it has.
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// How many nodes there are for a range of triangles, the root included.
  [[nodiscard]] std::uint32_t count(std::uint32_t begin, std::uint32_t end) const {
    std::uint32_t cuts[5];
    cut(begin, end, cuts);
    std::uint32_t nodes = 1;
    for (std::uint32_t i = 0; i < 4; ++i) nodes += cuts[i + 1] - cuts[i] > 4 ? count(cuts[i], cuts[i + 1]) : 0;
    return nodes;
  }

  /// Notes the children of a node, and of all that are below it, which come after it.
  /// @param nodes  Room for as many as `count` says, and `next` of them used.
  /// @return Its index.
  std::uint32_t add(std::uint32_t begin, std::uint32_t end, Node* nodes, std::uint32_t& next) const {
    const std::uint32_t node = next++;
    std::uint32_t cuts[5];
    cut(begin, end, cuts);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t size = cuts[i + 1] - cuts[i];
      const std::uint32_t leaf = size > 0 ? kLeafBit | cuts[i] << 2 | (size - 1) : kNone;
      nodes[node].child[i] = size > 4 ? add(cuts[i], cuts[i + 1], nodes, next) : leaf;
    }
    return node;
  }

 private:
  /// So few triangles are cut into full leaves instead: cells would cost more time than they save.
  static constexpr std::uint32_t kFew = 256;

  void cut(std::uint32_t begin, std::uint32_t end, std::uint32_t (&cuts)[5]) const {
    const std::uint32_t count = end - begin;
    if (count > kFew) return cutCells(begin, end, cuts);
    std::uint32_t run = 4;
    while (4 * run < count) run *= 4;
    for (std::uint32_t i = 0; i < 5; ++i) cuts[i] = begin + std::min(run * i, count);
  }

  /// Cuts in two, and twice what is largest then.
  void cutCells(std::uint32_t begin, std::uint32_t end, std::uint32_t (&cuts)[5]) const {
    cuts[0] = begin;
    cuts[1] = end;
    for (std::uint32_t parts = 1; parts < 4; ++parts) {
      std::uint32_t largest = 0;
      for (std::uint32_t i = 1; i < parts; ++i) {
        if (cuts[i + 1] - cuts[i] > cuts[largest + 1] - cuts[largest]) largest = i;
      }
      for (std::uint32_t i = parts; i > largest; --i) cuts[i + 1] = cuts[i];
      cuts[largest + 1] = cutBetween(cuts[largest], cuts[largest + 1]);
    }
  }

  [[nodiscard]] std::uint32_t cutBetween(std::uint32_t begin, std::uint32_t end) const {
    const std::uint32_t first = placeOf(begin);
    const std::uint32_t last = placeOf(end - 1);
    if (first == last) return begin + (end - begin) / 2;
    const auto bit = std::bit_width(first ^ last) - 1;
    const std::uint32_t cut = last >> bit << bit;
    while (begin < end) {
      const std::uint32_t middle = begin + (end - begin) / 2;
      (placeOf(middle) < cut ? begin = middle + 1 : end = middle);
    }
    return begin;
  }

  [[nodiscard]] std::uint32_t placeOf(std::uint32_t triangle) const {
    return places_[firstPointOf(corners_ + std::size_t{3} * triangle)];
  }

  const std::uint32_t* corners_;
  const std::uint32_t* places_;
};

}  // namespace

bool buildCageTree(const Cage& cage, const Units& units, Arena& arena, CageTree& out) noexcept {
  const std::uint32_t leafCount = groupsOfFour(cage.count);
  auto* corners = arena.allocate<std::uint32_t>(std::size_t{12} * leafCount);
  auto* positions = arena.allocate<float>(std::size_t{12} * cage.count);
  auto* nearLeaves = arena.allocate<NearLeaf>(leafCount);
  auto* leafBoxes = arena.allocate<LeafBox>(leafCount);
  auto* nodes = takeNodes(leafCount, arena, out);
  const Arena::Mark mark = arena.mark();
  auto* items = arena.allocate<CageOrder::Item>(cage.count);
  auto* boxes = arena.allocate<Box>(leafCount);
  if (arena.failed()) return false;
  Box all;
  for (std::uint32_t i = 0; i < cage.count; ++i) {
    const CageTriangle& t = cage.triangles[i];
    Box box;
    for (const float* corner : {t.a, t.b, t.c}) box.grow(load(corner));
    all.grow(box);
    simd::store(items[i].centre, box.low + box.high);
    items[i].slot = i;
    int corner = 0;
    for (const float* from : {t.a, t.b, t.c}) simd::store(positions + std::size_t{12} * i + 4 * corner++, load(from));
  }
  simd::store(out.middle, all.low * splat(0.5f) + all.high * splat(0.5f));
  std::uint32_t run = 4;
  while (run < cage.count) run *= 4;
  CageOrder(items).sort(0, cage.count, run);

  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf) {
    Box box;
    const CageTriangle* triangles[4];
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      const std::uint32_t i = 4 * leaf + lane;
      const std::uint32_t slot = items[std::min(i, cage.count - 1)].slot;
      const CageTriangle& t = cage.triangles[slot];
      triangles[lane] = &t;
      nearLeaves[leaf].slot[lane] = slot;
      for (const float* corner : {t.a, t.b, t.c}) box.grow(load(corner));
      for (std::uint32_t k = 0; k < 3; ++k) corners[3 * i + k] = 3 * slot + k;
    }
    for (std::uint32_t lane = 0; lane < 4; ++lane)
      setNearTriangle(nearLeaves[leaf], lane, *triangles[lane], out.middle);
    for (std::uint32_t lane = 4; 4 * leaf + lane > cage.count;) clearNearTriangle(nearLeaves[leaf], --lane);
    boxes[leaf] = box.padded(kPadding * units.reach);
    new (leafBoxes + leaf) LeafBox(boxAround(triangles, out.middle, kTurnedPadding * units.reach));
  }
  fillNodes(boxes, nodes, out);
  arena.rewind(mark);
  out.rays = {nodes, positions, corners, units.reach};
  out.near = nearLeaves;
  out.boxes = leafBoxes;
  float sides[4];
  simd::store(sides, all.high - all.low);
  out.extent = static_cast<double>(std::max({sides[0], sides[1], sides[2]}));
  return true;
}

bool buildTargetTree(const Points& target, const Units& units, Arena& arena, RayTree& out) noexcept {
  const std::uint32_t count = target.triangleCount;
  constexpr std::uint32_t kBeyond = 4;  // What a leaf may be tried with beyond its own.
  auto* corners = arena.allocate<std::uint32_t>(std::size_t{3} * (count + kBeyond));
  const Arena::Mark mark = arena.mark();
  auto* starts = arena.allocate<std::uint32_t>(target.count);
  if (arena.failed()) return false;

  // Points are in curve order; sorting triangles by their first point puts them in curve order as well.
  const std::uint32_t* triangles = target.triangles;
  std::fill(starts, starts + target.count, 0u);
  for (std::uint32_t t = 0; t < count; ++t) ++starts[firstPointOf(triangles + std::size_t{3} * t)];
  std::uint32_t sum = 0;
  for (std::uint32_t point = 0, end = target.count; point < end; ++point) sum += std::exchange(starts[point], sum);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t* corner = triangles + std::size_t{3} * t;
    const std::uint32_t a = corner[0];
    const std::uint32_t b = corner[1];
    const std::uint32_t c = corner[2];
    std::uint32_t* to = corners + std::size_t{3} * starts[std::min({a, b, c})]++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
  }
  std::fill_n(corners + std::size_t{3} * count, 3 * kBeyond, 0u);
  arena.rewind(mark);
  const CurveCuts cuts(corners, target.places);
  const std::uint32_t nodeCount = cuts.count(0, count);
  auto* nodes = arena.allocate<Node>(nodeCount);
  const Arena::Mark end = arena.mark();
  auto* boxes = arena.allocate<Box>(nodeCount);
  if (arena.failed()) return false;
  std::uint32_t used = 0;
  cuts.add(0, count, nodes, used);
  const float* const positions = target.positions;
  const float padding = kPadding * units.reach;
  for (std::uint32_t node = nodeCount; node-- > 0;) {
    Box below[4];
    Box around;
    for (int lane = 0; lane < 4; ++lane) {
      const std::uint32_t child = nodes[node].child[lane];
      if (child == CurveCuts::kNone) {
        nodes[node].child[lane] = kLeafBit;
        below[lane] = Box::nowhere();
        continue;
      }
      if (child & kLeafBit) {
        const std::uint32_t first = (child & ~kLeafBit) >> 2;
        const std::uint32_t* corner = corners + std::size_t{3} * first;
        const std::uint32_t cornerCount = 3 * (child & 3) + 3;
        Box box;
        for (std::uint32_t i = 0; i < cornerCount; ++i) box.grow(load(positions + Points::kStride * corner[i]));
        below[lane] = box.padded(padding);
        nodes[node].child[lane] = leafOf(first);
      } else {
        below[lane] = boxes[child];
        nodes[node].child[lane] = child;
      }
      around.grow(below[lane]);
    }
    boxes[node] = around;
    setChildren(nodes[node], below);
  }
  arena.rewind(end);
  out = {nodes, target.positions, corners, units.reach};
  return true;
}

}  // namespace cagecast
