#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "base/tolerances.hpp"
#include "base/units.hpp"
#include "input/cage.hpp"
#include "search/flat_triangles.hpp"
#include "search/oriented_box.hpp"
#include "search/ray_tree.hpp"

namespace cagecast {

/// A tree over the cage's triangles, for rays and for closest points. It is complete but for its right edge: node i of
/// a level has the nodes, or leaves, 4i … 4i + 3 of the next level as its children.
struct CageTree {
  /// A search for closest points begins at the lowest level with at most this many nodes: that is quicker than the way
  /// from the root to them.
  static constexpr std::uint32_t kMaxEntries = 16;

  RayTree rays;                            ///< Its nodes are stored level by level.
  const FlatLeaf* leaves = nullptr;        ///< The triangles of `rays`, four by four.
  const OrientedBox* leafBoxes = nullptr;  ///< 1 per leaf.
  std::uint32_t leafCount = 0;
  std::uint32_t lastLevel = 0;   ///< The first node whose children are leaves.
  std::uint32_t entry = 0;       ///< The first node of the level where a search begins.
  std::uint32_t entryCount = 0;  ///< The number of nodes of that level.
  std::uint32_t levelsBelowEntry = 0;
  double extent = 0;     ///< The longest side of the cage's box, scaled.
  float centre[4] = {};  ///< Of that box: x, y, z, 0, scaled. Coordinates relative to it have smaller rounding errors.
};

/// How much farther than the closest triangle a triangle may seem and still be the closest by the tie rule: the slack s
/// of `kRelativeSlack`.
/// @param diagonal  Of the target, scaled.
inline double slackOf(const CageTree& tree, double diagonal) {
  return kTieDistance * diagonal + kRounding * tree.extent;
}

/// Builds the tree.
/// @return false if memory ran out.
bool buildCageTree(const Cage& cage, const Units& units, Arena& arena, CageTree& out) noexcept;

}  // namespace cagecast
