#include "search/cage_tree.hpp"

#include <algorithm>
#include <new>

#include "search/box.hpp"
#include "search/triangle_order.hpp"

namespace cagecast {
namespace {

using simd::load;
using simd::splat;

/// How much larger than its triangles an oriented box is made, as a share of the scene. Coordinates along its axes are
/// sums of three products, each rounded by up to 2^-24 of a scene, for the box's corners and for points alike; this is
/// ten times their sum.
constexpr float kOrientedPadding = 5e-6f;

constexpr std::uint32_t groupsOfFour(std::uint32_t count) { return (count + 3) / 4; }

/// Allocates the nodes over a row of leaves: four neighbours make a node, four nodes a node, up to the root.
Node* allocateNodes(std::uint32_t leafCount, Arena& arena, CageTree& out) {
  out.leafCount = leafCount;
  std::uint32_t nodeCount = 0;
  std::uint32_t width = leafCount;
  do nodeCount += width = groupsOfFour(width);
  while (width > 1);
  out.lastLevel = nodeCount - groupsOfFour(leafCount);
  return arena.allocate<Node>(nodeCount);
}

/// Sets the boxes and children of the nodes, from the leaves up.
/// @param boxes  Of the leaves; overwritten.
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
        children[lane] = Box::farAway();
        if (child >= width) continue;
        nodes[levelBegin + i].child[lane] = overLeaves ? leafOf(4 * child) : childBase + child;
        children[lane] = boxes[child];
        around.grow(boxes[child]);
      }
      setBoxes(nodes[levelBegin + i], children);
      boxes[i] = around;
    }
    if (out.entryCount == 0 && levelSize <= CageTree::kMaxEntries) {
      out.entry = levelBegin;
      out.entryCount = levelSize;
    }
    if (out.entryCount == 0) ++out.levelsBelowEntry;
    if (levelSize == 1) break;
    width = levelSize;
    levelEnd = childBase = levelBegin;
  }
}

/// What the steps of building the tree write.
struct Building {
  OrderedTriangle* order;  ///< 1 per cage triangle.
  Box* boxes;              ///< 1 per leaf.
  FlatLeaf* leaves;
  OrientedBox* leafBoxes;
  std::uint32_t* corners;  ///< `RayTree::corners`.
};

/// Copies the corners of all triangles to `positions` and their centres to `order`.
/// @return The box around all of them.
Box collectTriangles(const Cage& cage, OrderedTriangle* order, float* positions) {
  Box all;
  for (std::uint32_t i = 0; i < cage.count; ++i) {
    const CageTriangle& t = cage.triangles[i];
    Box box;
    float* to = positions + std::size_t{12} * i;
    for (const float* corner : {t.a, t.b, t.c}) {
      box.grow(load(corner));
      simd::store(to, load(corner));
      to += 4;
    }
    all.grow(box);
    simd::store(order[i].centre, box.low + box.high);
    order[i].cageTriangle = i;
  }
  return all;
}

void makeLeaf(const Cage& cage, std::uint32_t leaf, const float* centre, float sceneSize, const Building& out) {
  Box box;
  const Triangle* triangles[4];
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    const std::uint32_t i = 4 * leaf + lane;
    const std::uint32_t cageTriangle = out.order[std::min(i, cage.count - 1)].cageTriangle;
    const CageTriangle& t = cage.triangles[cageTriangle];
    triangles[lane] = &t;
    out.leaves[leaf].cageTriangles[lane] = cageTriangle;
    for (const float* corner : {t.a, t.b, t.c}) box.grow(load(corner));
    for (std::uint32_t k = 0; k < 3; ++k) out.corners[3 * i + k] = 3 * cageTriangle + k;
  }
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    if (4 * leaf + lane < cage.count)
      setTriangle(out.leaves[leaf], lane, *triangles[lane], centre);
    else
      clearTriangle(out.leaves[leaf], lane);
  }
  out.boxes[leaf] = box.padded(Box::kPadding * sceneSize);
  new (out.leafBoxes + leaf) OrientedBox(orientedBoxAround(triangles, centre, kOrientedPadding * sceneSize));
}

}  // namespace

bool buildCageTree(const Cage& cage, const Units& units, Arena& arena, CageTree& out) noexcept {
  const std::uint32_t leafCount = groupsOfFour(cage.count);
  auto* corners = arena.allocate<std::uint32_t>(std::size_t{12} * leafCount);
  auto* positions = arena.allocate<float>(std::size_t{12} * cage.count);
  auto* leaves = arena.allocate<FlatLeaf>(leafCount);
  auto* leafBoxes = arena.allocate<OrientedBox>(leafCount);
  auto* nodes = allocateNodes(leafCount, arena, out);
  const Arena::Scope scope(arena);
  auto* order = arena.allocate<OrderedTriangle>(cage.count);
  auto* boxes = arena.allocate<Box>(leafCount);
  if (arena.failed()) return false;

  const Box all = collectTriangles(cage, order, positions);
  simd::store(out.centre, all.low * splat(0.5f) + all.high * splat(0.5f));
  float sides[4];
  simd::store(sides, all.high - all.low);
  out.extent = static_cast<double>(std::max({sides[0], sides[1], sides[2]}));
  orderTriangles(order, cage.count);
  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf)
    makeLeaf(cage, leaf, out.centre, units.sceneSize, {order, boxes, leaves, leafBoxes, corners});
  fillNodes(boxes, nodes, out);
  out.rays = {nodes, positions, corners, units.sceneSize};
  out.leaves = leaves;
  out.leafBoxes = leafBoxes;
  return true;
}

}  // namespace cagecast
