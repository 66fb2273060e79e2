#pragma once

#include <cstdint>
#include <span>

#include "base/list.hpp"
#include "cage/boundary_loops.hpp"
#include "cage/uv_charts.hpp"
#include "clip/boundary_lines.hpp"
#include "steps/steps.hpp"

/// docs/method.md, step 10: what borders run between.
namespace cagecast {

/// What is known of a place of the target.
struct Look {
  std::uint32_t
      side;  ///< Between places on two sides runs a border. Of loops: 1 beyond one, else 0. Of seams: the island.
  std::uint32_t slot;  ///< The cage triangle that it is nearest to,
  Vec3 q;              ///< where,
  Uv uv;               ///< and what of the texture is there.
};

/// A part of the target: all that lies between some places, the corners of a segment or of a triangle.
using Hull = std::span<const Vec3>;

/// All triangles of the cage that can be nearest to a place of a part; of those that a `BorderClassifier` has listed.
/// None: not known.
struct Nearby {
  std::uint32_t first = 0, count = 0;
};

/// Looks at single places of the target, in double.
class BorderClassifier {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  /// @param charts  To look for seams of the texture; null to look for loops.
  BorderClassifier(const MeshView& mesh, const Cage& cage, const CageTree& tree, const BoundaryLoops& loops,
                   const UvCharts* charts, const Units& units, Arena& arena) noexcept;

  /// @param p  Scaled.
  Look at(Vec3 p) noexcept;
  /// @param nearby  To a part that the place is in: quicker.
  Look at(Nearby nearby, Vec3 p) noexcept;

  /// What is near a part of the target, from arena.
  /// @param distance  Not less than how far its middle is from the cage; the less the better.
  Nearby around(Hull hull, double distance) noexcept;
  /// A part has so many corners at most.
  static constexpr std::size_t kMostCorners = 6;
  /// What is near a part of another part.
  Nearby within(Nearby nearby, Hull hull) noexcept;
  /// What was listed since is forgotten by `rewind`.
  [[nodiscard]] std::size_t mark() const noexcept { return listed_.size(); }
  void rewind(std::size_t mark) noexcept { listed_.cut(mark); }
  [[nodiscard]] bool failed() const noexcept { return listed_.failed(); }

  /// Whether, for sure, all places of a part are on a side.
  [[nodiscard]] bool areAllOn(std::uint32_t side, Nearby nearby, Hull hull) const noexcept;
  /// Whether, for sure, no border runs between any two places of a part, one of which is on a side.
  [[nodiscard]] bool isWhole(std::uint32_t side, Nearby nearby, Hull hull) const noexcept;

  /// So far around a place that was looked at no other is nearest to a loop, for sure; 0 where seams are looked for.
  [[nodiscard]] double clearance(const Look& look, Vec3 p) noexcept;

  /// Whether a border runs between two places.
  [[nodiscard]] bool isBetween(const Look& a, const Look& b) const noexcept;

 private:
  /// Finds the triangles that are farther from a place than the nearest by up to `more`.
  /// @param distance  As in `NearestSearch::widen`.
  /// @return How many there are in `found_`.
  std::uint32_t find(Vec3 p, double more, double distance) noexcept;
  /// Finds which of some triangles a place is nearest to; `candidates_` are then those that can be.
  const Candidate& nearestOf(const std::uint32_t* slots, std::uint32_t count, Vec3 p) noexcept;
  [[nodiscard]] Look judge(const Candidate& nearest) const noexcept;

  const MeshView& mesh_;
  const Cage& cage_;
  const BoundaryLoops& loops_;
  const UvCharts* charts_;
  double diagonal_;
  double margin_;  ///< What is farther than the nearest by more is not the answer.
  NearestSearch search_;
  std::uint32_t* found_;
  Candidate* candidates_;
  List<std::uint32_t> listed_;
  BoundaryLines lines_;
  double*
      clearances_;  ///< 1 per vertex of the cage: its distance to the nearest line, or less than 0 if nobody asked yet.
};

}  // namespace cagecast
