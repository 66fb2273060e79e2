#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "input/weld.hpp"
#include "search/cage_tree.hpp"
#include "simd/simd.hpp"

namespace cagecast {

/// Finds the cage triangles that are closest to a few points at once.
///
/// Points that are close together have the same closest triangles. So the tree is searched once for the box around a
/// group of points, and each point is only tested against the leaves found. The search needs a limit to begin with: the
/// distances to two leaves, one near the first point and one near the last.
class ClosestPointSearch {
 public:
  static constexpr std::uint32_t kGroup = 16;  ///< The most points to search for at once.

  /// Allocates its working memory; check `arena.failed()` afterwards.
  /// @param diagonal  Of the target, scaled.
  ClosestPointSearch(const CageTree& tree, double diagonal, Arena& arena) noexcept;

  /// From now on also finds triangles that are farther than the closest one by up to `more`.
  /// @param distance  About the distance to the cage, greater than 0. It affects only how many other triangles are
  /// found.
  void widen(double more, double distance) noexcept;

  /// Searches for 1 to `kGroup` points, which should be close together.
  /// Counts its work by `Arena::spend`.
  /// @param positions  As in `Points`. They must stay until the last call of `candidates`.
  void search(const float* positions, std::uint32_t count) noexcept;

  /// The triangles that could be the closest to point i of the last search by the tie rule: all whose distance is
  /// within `kTieDistance` of the least, and some whose difference is below the rounding error.
  /// @param[out] found  Room for every triangle of the cage.
  /// @return How many were found: at least 1.
  std::uint32_t candidates(std::uint32_t i, std::uint32_t* found) noexcept;
  /// A quicker way if there is only one candidate, the usual case.
  /// @return The candidate, or `kSeveral` if there may be more.
  [[nodiscard]] std::uint32_t onlyCandidate(std::uint32_t i) const noexcept;
  static constexpr std::uint32_t kSeveral = UINT32_MAX;

 private:
  /// One more than the leaves that are remembered for a point. If more are close, `candidates` searches again.
  static constexpr std::uint32_t kRoom = 8;

  /// Finds the leaves whose boxes are close enough to a box.
  /// @param limit         A squared distance, in all lanes.
  /// @param[out] leaves  The list.
  /// @return How many there are.
  std::uint32_t listLeaves(const simd::f32x4 (&low)[3], const simd::f32x4 (&high)[3], simd::f32x4 limit,
                           std::uint32_t*& leaves) const noexcept;
  /// A leaf whose box is close to a point: the closest child of each node.
  [[nodiscard]] std::uint32_t leafNear(simd::f32x4 point) const noexcept;
  /// Tests points against those leaves whose oriented boxes are close enough to them.
  void searchLeaves(const std::uint32_t* leaves, std::uint32_t leafCount) noexcept;
  /// Tests a point of the group against a leaf, and lowers the point's limit.
  /// @param[out] least  The least squared distance.
  /// @return The candidates, a bit each.
  unsigned candidatesIn(const FlatLeaf& leaf, std::uint32_t i, float& least) noexcept;
  /// Tests points of the group, a bit each, against a leaf, and remembers it for those that have candidates there.
  void searchLeaf(std::uint32_t leaf, unsigned members) noexcept;

  const CageTree& tree_;
  Arena& arena_;                               ///< Counts the work.
  double slack_;                               ///< The s of `kRelativeSlack`.
  float growth_;                               ///< 1 + r
  float fixedSlack_;                           ///< s² · (1 + 1/r)
  std::uint32_t lastLeaf_ = 0;                 ///< Close to the last point of the last group.
  const float* positions_ = nullptr;           ///< Of the last search.
  alignas(16) float points_[kGroup][4];        ///< x, y, z, 0 relative to the centre of the cage.
  alignas(16) float columns_[3][kGroup] = {};  ///< The same by axis. Undefined from the number of points on.
  alignas(16) float limits_[kGroup];           ///< The squared distance within which triangles are candidates.
  std::uint32_t* list_;                        ///< Room for all leaves, and four more.
  std::uint32_t* otherList_;
  std::uint32_t nearCount_[kGroup];  ///< Leaves that had candidates. From `kRoom` on, some are overwritten.
  // For each point, the leaves that had candidates when they were tested:
  float squaredDistances_[kRoom][kGroup];  ///< The least one of the leaf.
  std::uint32_t lanes_[kRoom][kGroup];     ///< The leaf's index times 16, plus a bit per candidate.
};

}  // namespace cagecast
