#pragma once

#include <cstdint>
#include <span>

#include "base/list.hpp"
#include "base/units.hpp"
#include "cage/boundary_loops.hpp"
#include "cage/uv_charts.hpp"
#include "clip/boundary_lines.hpp"
#include "search/closest_point_search.hpp"

/// docs/borders.md: which region of the target a point is in. Borders run between regions.
namespace cagecast {

/// The cage, as the clip step needs it.
struct ClipCage {
  const MeshView& mesh;  ///< As it was given.
  const Cage& cage;
  const CageTree& tree;
  const BoundaryLoops& loops;
  const UvCharts* charts;  ///< Null if borders along seams are not asked for.
  const Units& units;
};

/// What the borders are that a target is cut along.
enum class BorderKind : std::uint8_t { loops, seams };

/// What is known of a point on the target.
struct BorderSample {
  /// For boundary loops: 1 if the closest point of the cage lies on a loop, else 0. For seams: the chart.
  std::uint32_t region;
  std::uint32_t cageTriangle;  ///< The nearest.
  Vec3 closest;                ///< The closest point of the cage.
  Uv uv;                       ///< There.
};

/// The corners of a convex part of the target: a line segment or a polygon.
using Hull = std::span<const Vec3>;

/// All cage triangles that may be the nearest to a point of a part of the target, as a range of a classifier's list.
/// Empty: unknown.
struct NearbyTriangles {
  std::uint32_t first = 0, count = 0;
  [[nodiscard]] std::uint32_t end() const noexcept { return first + count; }
};

/// Classifies points of the target, in double precision, and proves that parts of the target contain no border.
class BorderClassifier {
 public:
  /// Allocates its working memory from `arena`; check `arena.failed()` afterwards.
  /// @param limit  Of comparisons with triangles of the cage.
  BorderClassifier(const ClipCage& cage, BorderKind kind, std::uint64_t limit, Arena& arena) noexcept;

  /// @param p  Scaled.
  BorderSample sample(Vec3 p) noexcept;
  /// The same, faster.
  /// @param nearby  Of a part that contains the point.
  BorderSample sample(NearbyTriangles nearby, Vec3 p) noexcept;

  /// Lists what is near a part of the target.
  /// @param distance  An upper bound of the distance between the part's centroid and the cage; the tighter the faster.
  NearbyTriangles listNearby(Hull hull, double distance) noexcept;
  /// Lists those that are near a smaller part, without those that surely lose a tie at every point of it.
  NearbyTriangles narrow(NearbyTriangles nearby, Hull hull) noexcept;

  /// How much is listed now.
  [[nodiscard]] std::size_t mark() const noexcept { return listed_.size(); }
  /// Forgets what was listed after a call of `mark`.
  void rewind(std::size_t mark) noexcept { listed_.truncate(mark); }
  /// Whether there were more comparisons than the limit.
  [[nodiscard]] bool isOverLimit() const noexcept { return comparisons_ > limit_; }
  /// Whether memory ran out, or there were too many comparisons.
  [[nodiscard]] bool failed() const noexcept { return listed_.failed() || limits_.failed() || isOverLimit(); }

  /// Whether it is certain that all points of a part are in a region.
  [[nodiscard]] bool isSurelyIn(std::uint32_t region, NearbyTriangles nearby, Hull hull) noexcept;
  /// The same, and also that no border within the region runs through the part.
  [[nodiscard]] bool isSurelyWhole(std::uint32_t region, NearbyTriangles nearby, Hull hull) noexcept;

  /// The radius of a ball around a point within which, for certain, no point has its closest point on a boundary loop.
  /// 0 for seams.
  [[nodiscard]] double clearance(const BorderSample& sample, Vec3 p) noexcept;

  /// Whether a border runs between two points: their regions differ, or the texture is smeared between them.
  [[nodiscard]] bool separates(const BorderSample& a, const BorderSample& b) const noexcept;

 private:
  [[nodiscard]] bool isSurelyIn(std::uint32_t region, std::uint32_t cageTriangle, Hull hull) const noexcept;
  std::uint32_t findWithin(Vec3 p, double more, double distance) noexcept;
  const Candidate& nearestOf(const std::uint32_t* cageTriangles, std::uint32_t count, Vec3 p) noexcept;
  [[nodiscard]] bool losesTie(const Candidate& loser, std::span<const Candidate> near, Hull hull) noexcept;
  [[nodiscard]] BorderSample classify(const Candidate& nearest) const noexcept;

  const ClipCage cage_;
  const UvCharts* charts_;  ///< Null for boundary loops.
  double diagonal_;
  double slack_;  ///< A triangle farther than the nearest one by more than this is not the answer.
  ClosestPointSearch search_;
  std::uint32_t* found_;   ///< 1 per cage triangle: the result of `findWithin`.
  Candidate* candidates_;  ///< 1 per cage triangle: what is being compared.
  List<double> limits_;    ///< 1 per corner of the part that is being narrowed.
  List<std::uint32_t> listed_;
  BoundaryLines lines_;
  double* clearances_;  ///< 1 per vertex of the cage: its distance to the nearest open edge; negative if unknown.
  const std::uint64_t limit_;
  std::uint64_t comparisons_ = 0;  ///< Of points or parts with triangles of the cage.
};

}  // namespace cagecast
