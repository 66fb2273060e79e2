#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "cagecast/array.hpp"

/// What the functions of transfer.hpp return.
namespace cagecast {

/// What steps 1 to 3 find of a vertex. Its zone also depends on its segment.
enum class Visibility : std::uint8_t {
  covered = 0,    ///< The cage covers it.
  occluded = 1,   ///< Another surface of the target lies over it.
  uncovered = 2,  ///< The cage has a hole over it, or it lies outside the cage.
  beyond = 3,     ///< It lies beyond an outer border of the cage, which says nothing of it: its zone is uncovered.
};

/// Why a vertex may, or may not, be painted. All but `cosmetic` are Non-Cosmetic Zones (NCZ).
enum class Zone : std::uint8_t {
  cosmetic = 0,   ///< May be painted.
  occluded = 1,   ///< Another surface of the target lies over it.
  uncovered = 2,  ///< The cage has a hole over it, or it lies outside the cage.
  culled = 3,     ///< Its segment is culled (see `CulledBy`), or a mask excludes it.
};

/// Why a segment is culled, that is, why none of it may be painted.
enum class CulledBy : std::uint8_t {
  none,      ///< It is not culled.
  coverage,  ///< The cage covers too little of it, or it lies too deep: one of `Ratios` but `hole` is below 1.
  hole,      ///< A hole of the cage is meant for it: only `Ratios::hole` is below 1.
  lock,      ///< `Lock::exclude`, or `Parts::exclude`.
  ignore,    ///< `Parts::ignore`: it is not there.
};

/// CPU time of each step in milliseconds; wall time in WebAssembly and on Windows, the only clock there.
struct Timings {
  double weld = 0;      ///< Checking the input and welding the target's vertices.
  double build = 0;     ///< Building the search trees, and the boundary loops of the cage.
  double project = 0;   ///< Step 1: the nearest point of the cage for every point of the target.
  double occluded = 0;  ///< Step 2: rays against the target.
  double covered = 0;   ///< Steps 3 and 6: where rays meet the cage.
  double segments = 0;  ///< Steps 4 and 7: connected components and their areas; with steps 1 to 3 of interior samples,
                        ///< and writing the results of all steps per vertex.
  double recheck = 0;   ///< Step 9: more rays from occluded points.
  double motion = 0;    ///< Step 13: what is seen in poses of the target.
  double holes = 0;     ///< Step 10: uncovered points and the holes over them.
  double seams = 0;     ///< Step 12: UVs per triangle corner.
  double classify = 0;  ///< Steps 5, 8, 10 and 11: which segments are culled; zones of vertices and triangles.
  double total = 0;     ///< The whole call.
};

/// The ratios of a segment, by rule: of an amount that it has to the amount that the rule asks for. It
/// meets a rule from 1 on; infinity if the rule asks for nothing, and until `classify` has decided. A, E, C and K are
/// as in docs/method.md.
struct Ratios {
  double threshold = std::numeric_limits<double>::infinity();  ///< Step 5: coverage / `threshold`.
  double floor = std::numeric_limits<double>::infinity();      ///< Step 8: covered area / needed area.
  double depth = std::numeric_limits<double>::infinity();      ///< Step 8: greatest depth allowed / depth.
  double hole = std::numeric_limits<double>::infinity();  ///< Step 10: area allowed in a hole / area there; the least.

  /// The score: the segment is kept if it is at least 1, unless a lock decides.
  [[nodiscard]] double least() const noexcept { return std::min({threshold, floor, depth, hole}); }
};

/// The properties of one segment: a connected component of the welded target. Areas are in squared units of the input,
/// and exact to diagonal² · triangles² · 2^-58 of the target, because that of each triangle is rounded to a whole
/// number of tiny units: what is left of slivers that are 1e12 times longer than wide is rounding.
struct SegmentStats {
  std::uint32_t points = 0;            ///< Number of welded points; 0 if it is ignored.
  std::uint32_t group = 0;             ///< The group of its first vertex; 0 if the target has no groups.
  CulledBy culledBy = CulledBy::none;  ///< Set by `transfer`; `project` sets only `ignore`.
  Ratios ratios;                       ///< Set by `transfer`.
  double area = 0;                     ///< A: its whole area.
  double beyondArea = 0;               ///< The part of A beyond outer borders of the cage, occluded or not.
  double exposedArea = 0;              ///< E: the area that is neither occluded nor beyond.
  double coveredArea = 0;              ///< C: the part of E that the cage covers.
  /// The mean distance of its covered area from the cage, as a share of the target's diagonal; a distance of more than
  /// one diagonal counts as one. 0 if nothing is covered, and with `ProjectionMode::nearestVertex`.
  double depth = 0;

  [[nodiscard]] bool culled() const noexcept { return culledBy != CulledBy::none; }
  /// F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed.
  [[nodiscard]] double coverage() const noexcept { return exposedArea > 0 ? coveredArea / exposedArea : 0; }
  [[nodiscard]] double score() const noexcept { return ratios.least(); }
  /// How sure the verdict is, from 0.5 for a score of 1 to 1 for one that is far from it, or where a lock decides. Of
  /// verdicts with 0.9 and more, over 90 % are right under cages that are out of place by up to 2 % of the target's
  /// diagonal; docs/evaluation.md has the table.
  [[nodiscard]] double confidence() const noexcept {
    const double has = score();
    if (culledBy == CulledBy::lock || culledBy == CulledBy::ignore || culled() != (has < 1)) return 1;
    const double closeness = has < 1 ? has : 1 / has;
    return 1 - closeness * closeness * closeness * closeness / 2;
  }
};

/// Whether an occluded or uncovered vertex becomes cosmetic if its segment is not culled: `never`, `always`, or, for
/// values of at least `throughHole`, if a culled segment lies behind hole number `value − throughHole` and explains it.
/// If the vertex has a record in `Hiders`, what hides it must be culled as well.
struct Recovery {
  static constexpr std::uint32_t never = 0;
  static constexpr std::uint32_t always = 1;
  static constexpr std::uint32_t throughHole = 2;
};

/// What hides occluded vertices, by segment: a vertex is free if enough of its rays, at rest or in a pose, hit nothing
/// but culled segments.
struct Hiders {
  /// 1 per vertex: where its record in `records` begins; 0 if its recovery depends on no segment but its own.
  std::span<const std::uint32_t> ofVertex;
  /// One after the other, from 1 on: where an earlier record begins that is enough as well, or 0; how many rays are
  /// enough, how many follow, and for each of these the number of segments that it hits, and their numbers.
  std::span<const std::uint32_t> records;
};

/// The part of a segment that lies nearest to the boundary loop of one hole of the cage. All areas are those at this
/// loop only, and of points only, without interior samples. They are in squared units of the input, rounded so that
/// sums of them are exact.
struct HoleShare {
  std::uint32_t hole = 0;  ///< The number of the boundary loop.
  std::uint32_t segment = 0;
  double exposedArea = 0;    ///< Area that is not occluded, or is bare in a pose of the target (step 13).
  double uncoveredArea = 0;  ///< The part of it that the cage does not cover.
  /// Occluded area that the cage does not cover; 0 if `occlusionReach` is infinite or nothing of the segment is
  /// covered.
  double hiddenArea = 0;
};

/// A non-owning view of what `classify` needs of a projection.
struct ProjectionView {
  std::span<const Visibility> visibility;  ///< All fields are as in `Projection`.
  std::span<const std::uint32_t> segments;
  std::span<const SegmentStats> segmentStats;
  std::span<const std::uint32_t> recovery = {};
  std::span<const HoleShare> holeShares = {};
  Hiders hiders = {};
};

/// The result of `project`: steps 1 to 4, and what later steps need.
struct Projection {
  Array<float> uvs;  ///< 2 per target vertex: its UV in the cage's texture, also where it may not be painted.
  /// 2 per target index with `Seams::corner` and `ProjectionMode::nearestPoint`, else empty. They differ from `uvs`
  /// only where a seam of the cage's texture runs through a triangle.
  Array<float> cornerUvs;
  Array<Visibility> visibility;      ///< 1 per vertex.
  Array<std::uint32_t> triangles;    ///< 1 per vertex: the nearest cage triangle, or with
                                     ///< `ProjectionMode::nearestVertex` the first at the nearest vertex.
  Array<float> distances;            ///< 1 per vertex: the distance to it, or to that vertex, in units of the input.
  Array<std::uint32_t> segments;     ///< 1 per vertex: its segment. Segments are numbered by their first vertex.
  Array<SegmentStats> segmentStats;  ///< 1 per segment.
  Array<std::uint32_t> recovery;     ///< 1 per vertex, see `Recovery`, with `recheck` or `holes`;
                                     ///< else, and with `nearestVertex`, empty.
  Array<std::uint32_t> hiddenBy;     ///< 1 per vertex, see `Hiders::ofVertex`, if anything is in `hiders`; else empty.
  Array<std::uint32_t> hiders;       ///< With `recheck` and not `nearestVertex`: `Hiders::records`.
  Array<HoleShare> holeShares;       ///< 1 per hole and segment near it, with `holes` and not
                                     ///< `nearestVertex`; ordered by hole.
  Timings timings;
  /// Peak memory of the workspace during the call, and the size of the results, in bytes; with gaps, which depend on
  /// earlier calls with the workspace. Without the caller's inputs, and what the call takes besides (`Workspace`).
  std::uint64_t peakBytes = 0;

  [[nodiscard]] ProjectionView view() const noexcept {
    return {visibility, segments, segmentStats, recovery, holeShares, {hiddenBy, hiders}};
  }
};

/// The result of `classify`: steps 5, 8 and 11, and what step 10 says of segments and holes.
struct Zones {
  Array<Zone> zones;                      ///< 1 per target vertex.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per target triangle: 1 if it may be painted; see `partialTriangles`.
  Array<CulledBy> culledBy;               ///< 1 per segment.
  Array<Ratios> ratios;                   ///< 1 per segment.
  /// 1 per hole, up to the last one in `holeShares`: 1 if a culled segment lies behind it and explains it.
  Array<std::uint8_t> explainedHoles;
};

/// The result of `transfer`.
struct TransferResult {
  Projection projection;  ///< With `culledBy` and `ratios` of each segment set.
  Zones zones;

  /// Sets `culledBy` and `ratios` of each segment in `projection` as `classify` found them.
  void setVerdicts() noexcept {
    for (std::size_t s = 0; s < projection.segmentStats.size(); ++s) {
      projection.segmentStats[s].culledBy = zones.culledBy[s];
      projection.segmentStats[s].ratios = zones.ratios[s];
    }
  }
};

}  // namespace cagecast
