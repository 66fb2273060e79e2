#include "search/target_tree.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "search/box.hpp"

namespace cagecast {
namespace {

using simd::load;

/// The point that comes first in curve order.
std::uint32_t firstPointOf(const std::uint32_t* corner) { return std::min({corner[0], corner[1], corner[2]}); }

/// Divides triangles in curve order into nodes. It cuts where the curve goes from one half of a cell to the other, so
/// that the parts hardly overlap.
class CurveCuts {
 public:
  /// @param corners  Of the triangles, in the order of their first points.
  /// @param cells    As in `Points`.
  CurveCuts(const std::uint32_t* corners, const std::uint32_t* cells) : corners_(corners), cells_(cells) {}

  /// An unused child, as `add` writes it.
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// The number of nodes for a range of triangles, the root included.
  [[nodiscard]] std::uint32_t count(std::uint32_t begin, std::uint32_t end) const {
    std::uint32_t cuts[5];
    cut(begin, end, cuts);
    std::uint32_t nodes = 1;
    for (std::uint32_t i = 0; i < 4; ++i) nodes += cuts[i + 1] - cuts[i] > 4 ? count(cuts[i], cuts[i + 1]) : 0;
    return nodes;
  }

  /// Sets the children of a node and of all nodes below it, which come after it. A leaf is written as its first
  /// triangle times 4, plus the number of its other triangles, with `kLeafBit`: `setNodeBoxes` needs both.
  /// @param nodes  `count` of them, of which `next` are used.
  /// @return The node's index.
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
  /// Up to this many triangles are cut into full leaves instead, which is faster than cutting by cells.
  static constexpr std::uint32_t kFew = 256;

  void cut(std::uint32_t begin, std::uint32_t end, std::uint32_t (&cuts)[5]) const {
    const std::uint32_t count = end - begin;
    if (count > kFew) return cutCells(begin, end, cuts);
    std::uint32_t run = 4;
    while (4 * run < count) run *= 4;
    for (std::uint32_t i = 0; i < 5; ++i) cuts[i] = begin + std::min(run * i, count);
  }

  /// Cuts the range in two, and then twice the largest part.
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
    const std::uint32_t first = cellOf(begin);
    const std::uint32_t last = cellOf(end - 1);
    if (first == last) return begin + (end - begin) / 2;
    const auto bit = std::bit_width(first ^ last) - 1;
    const std::uint32_t cut = last >> bit << bit;
    while (begin < end) {
      const std::uint32_t middle = begin + (end - begin) / 2;
      if (cellOf(middle) < cut) {
        begin = middle + 1;
      } else {
        end = middle;
      }
    }
    return begin;
  }

  [[nodiscard]] std::uint32_t cellOf(std::uint32_t triangle) const {
    return cells_[firstPointOf(corners_ + std::size_t{3} * triangle)];
  }

  const std::uint32_t* corners_;
  const std::uint32_t* cells_;
};

/// Sorts triangles by their first point. Points are in curve order, so the triangles are as well then.
/// @param starts  Working memory, 1 per point.
void sortByFirstPoint(const Points& target, std::uint32_t* starts, std::uint32_t* corners) {
  const std::uint32_t* triangles = target.triangles;
  const std::uint32_t count = target.triangleCount;
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
}

/// Sets the boxes of all nodes, from the last one, and the final form of their leaves.
/// @param boxes  Working memory, 1 per node.
void setNodeBoxes(const RayTree& tree, float padding, Node* nodes, std::uint32_t nodeCount, Box* boxes) {
  for (std::uint32_t node = nodeCount; node-- > 0;) {
    Box children[4];
    Box around;
    for (int lane = 0; lane < 4; ++lane) {
      const std::uint32_t child = nodes[node].child[lane];
      if (child == CurveCuts::kNone) {
        nodes[node].child[lane] = kLeafBit;
        children[lane] = Box::farAway();
        continue;
      }
      if (isLeaf(child)) {
        const std::uint32_t first = firstOf(child) >> 2;
        const std::uint32_t* corner = tree.corners + std::size_t{3} * first;
        const std::uint32_t cornerCount = 3 * (child & 3) + 3;
        Box box;
        for (std::uint32_t i = 0; i < cornerCount; ++i) box.grow(load(tree.positions + Points::kStride * corner[i]));
        children[lane] = box.padded(padding);
        nodes[node].child[lane] = leafOf(first);
      } else {
        children[lane] = boxes[child];
      }
      around.grow(children[lane]);
    }
    boxes[node] = around;
    setBoxes(nodes[node], children);
  }
}

}  // namespace

bool buildTargetTree(const Points& target, const Units& units, Arena& arena, RayTree& out) noexcept {
  const std::uint32_t count = target.triangleCount;
  constexpr std::uint32_t kBeyond = 4;  // Triangles that may be read after the last one.
  auto* corners = arena.allocate<std::uint32_t>(std::size_t{3} * (count + kBeyond));
  {
    const Arena::Scope scope(arena);
    auto* starts = arena.allocate<std::uint32_t>(target.count);
    if (arena.failed()) return false;
    sortByFirstPoint(target, starts, corners);
  }
  std::fill_n(corners + std::size_t{3} * count, 3 * kBeyond, 0u);

  const CurveCuts cuts(corners, target.cells);
  const std::uint32_t nodeCount = cuts.count(0, count);
  auto* nodes = arena.allocate<Node>(nodeCount);
  const Arena::Scope scope(arena);
  auto* boxes = arena.allocate<Box>(nodeCount);
  if (arena.failed()) return false;
  std::uint32_t used = 0;
  cuts.add(0, count, nodes, used);
  out = {nodes, target.positions, corners, units.sceneSize};
  setNodeBoxes(out, Box::kPadding * units.sceneSize, nodes, nodeCount, boxes);
  return true;
}

}  // namespace cagecast
