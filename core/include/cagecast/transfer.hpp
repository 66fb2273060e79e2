#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/mesh.hpp"

/// Cage-based texture transfer with geometric filtering.
///
/// Carries the UVs of a cage to the vertices of a target mesh and finds the target's Non-Cosmetic Zones (NCZ), the
/// vertices that must not be painted. The method is the one of *Cage-based Texture Transfer with Geometric Filtering*
/// (Zhou, Ng, Lim, Griffin, Baghernezhad; SIGGRAPH Posters '26, DOI 10.1145/3799825.3818741).
///
/// Single-threaded and deterministic: the same bits on every platform, at every optimisation level.
namespace cagecast {

/// Why a vertex may, or may not, be painted.
enum class Zone : std::uint8_t {
  cosmetic = 0,   ///< May be painted.
  occluded = 1,   ///< NCZ: the target itself lies over it.
  uncovered = 2,  ///< NCZ: the cage has a hole over it, or it lies outside the cage.
  culled = 3,     ///< NCZ: too little of its segment is covered, or a hole of the cage is meant for it.
};

/// How a target vertex finds its place on the cage.
enum class ProjectionMode : std::uint8_t {
  nearestPoint,   ///< The nearest point of the cage's surface: the method.
  nearestVertex,  ///< The nearest vertex of the cage, nothing filtered: the classical baseline, for comparison.
};

/// Where UVs are kept.
enum class Seams : std::uint8_t {
  vertex,  ///< Per vertex alone: a triangle across a seam of the cage's texture stretches over the charts.
  corner,  ///< Per triangle corner as well, in `Projection::cornerUvs`: no triangle does.
};

/// Options of the costly part. The defaults are the method of the poster: `paper()`. Lengths are shares of the target's
/// diagonal.
struct ProjectOptions {
  ProjectionMode projection = ProjectionMode::nearestPoint;
  float weldTolerance = 0.0f;  ///< Vertices nearer than this are one point; 0..0.01.
  Seams seams = Seams::vertex;
  /// Step 2′: the target occludes a point only up to so far beyond the cage. At least 0; infinity: however far.
  float occlusionReach = std::numeric_limits<float>::infinity();
  /// Step 3′: a point up to so far outside the cage, not at one of its open borders, is covered; 0..1, 0 is off.
  float pokeThrough = 0.0f;
  /// Step 4′: in small segments near a hole, big triangles vote with what is found inside them, not at their corners.
  bool interiorSamples = false;
  /// Step 4′: a hole is near a segment if it is no farther than the cage itself; else only within 0.01.
  bool farLoops = false;
  /// Step 5′: measures how deep under the cage lies what is covered of each segment, and which segments are copies of
  /// others.
  bool depthWeighting = false;
  /// Step 6: occluded points that are seen from the cage in another direction are restored, if their segment passes and
  /// anything of it is covered.
  bool secondLook = false;
  /// Step 6: points whose triangles all have copies in reverse winding look to both sides; else such points stay as
  /// they are.
  bool bothSides = false;
  /// Step 6: to which side a segment's points look is decided by those that are not occluded; else by all.
  bool exposedSide = false;
  /// Step 7: uncovered points are restored unless the hole over them is meant for them.
  bool holes = false;

  /// The literal method.
  static constexpr ProjectOptions paper() noexcept { return {}; }
  /// The preset `default`.
  static constexpr ProjectOptions standard() noexcept {
    ProjectOptions options;
    options.seams = Seams::corner;
    options.occlusionReach = 0.03f;
    options.pokeThrough = 0.0025f;
    options.interiorSamples = options.farLoops = options.depthWeighting = true;
    options.secondLook = options.bothSides = options.exposedSide = options.holes = true;
    return options;
  }
};

/// What a segment needs besides its share of exposed area that is covered, so that no leak is taken for skin: step 5′.
enum class Floor : std::uint8_t {
  none,   ///< Nothing.
  area,   ///< Some covered area, and C ≥ `minCovered` · A.
  depth,  ///< Some covered area, and, of what lies no deeper than its neighbours, enough of itself or of all: see
          ///< `minOfAll`.
};

/// What the user of a model has said about a segment.
enum class Lock : std::uint8_t {
  automatic,  ///< Nothing: its areas decide.
  keep,       ///< It passes, whatever its areas. Points inside it, or under a hole that is meant for them, stay NCZ.
  exclude,    ///< It does not pass, whatever its areas; like any such segment it explains the holes it lies under.
};

/// Options of the decision per segment. The defaults are the method of the poster: `paper()`.
struct ClassifyOptions {
  float threshold = 0.5f;  ///< A segment passes if at least this share of its exposed area is covered; 0..1.
  Floor floor = Floor::none;
  float minCovered = 0.2f;  ///< With a floor: the least C, or X with `Floor::depth`, as a share of A; 0..1.
  /// With `Floor::depth` the least X = D · F as a share of the covered area of all segments: that is enough as well;
  /// 0..1.
  float minOfAll = 0.005f;
  float maxUncovered =
      0.25f;  ///< What `minOfAll` lets pass is uncovered in at most this share of its exposed area; 0..1.
  /// Step 5′: copies of one part that are within a factor of two of the limit are judged together. Needs a floor.
  bool twins = false;
  /// Step 5″: a small part does not pass if a hole is meant for it, because nothing else explains the hole, or much of
  /// the part lies hidden under it. Needs `holes`.
  bool holeContents = false;
  /// Step 8: a triangle is cosmetic if one corner is and the others are that or occluded; else if all three are.
  bool partialTriangles = false;
  std::span<const Lock> locks = {};  ///< 1 per segment, or none: the last word about it.

  /// The literal method.
  static constexpr ClassifyOptions paper() noexcept { return {}; }
  /// The preset `default`.
  static constexpr ClassifyOptions standard() noexcept {
    ClassifyOptions options;
    options.floor = Floor::depth;
    options.twins = options.holeContents = options.partialTriangles = true;
    return options;
  }
};

struct TransferOptions : ProjectOptions, ClassifyOptions {
  /// The literal method.
  static constexpr TransferOptions paper() noexcept { return {}; }
  /// The preset `default`.
  static constexpr TransferOptions standard() noexcept {
    return {ProjectOptions::standard(), ClassifyOptions::standard()};
  }
};

/// CPU time of each step in milliseconds; wall time in WebAssembly, which has no other clock.
struct Timings {
  double weld = 0;      ///< Checking the input and welding the target's vertices.
  double build = 0;     ///< Building the search trees of cage and target.
  double project = 0;   ///< Step 1: the nearest point of the cage for every point of the target.
  double occluded = 0;  ///< Step 2: self-intersection.
  double covered = 0;   ///< Step 3: cage intersection.
  double segments =
      0;  ///< Step 4: connected components, and their areas; with step 4′ what interiorSamples from within.
  double secondLook = 0;  ///< Step 6: the occluded points that are seen from elsewhere.
  double holes = 0;       ///< Step 7: what lies under the holes of the cage.
  double seams = 0;       ///< UVs per triangle corner, if asked for.
  double classify = 0;    ///< Step 5: the threshold, and writing the answer out to vertices and triangles.
  double total = 0;       ///< All of it, from raw arrays to zones.
};

/// What is known of one connected component of the target. Areas are in squared units of the input.
struct SegmentStats {
  std::uint32_t points = 0;  ///< Welded points.
  bool culled = false;       ///< Too little of it is covered, or a hole is meant for it: none of it may be painted.
  double area = 0;           ///< A: its whole area.
  double exposedArea = 0;    ///< E: area of the points that the target does not occlude.
  double coveredArea = 0;    ///< C: area of the points that the cage covers as well.
  std::uint32_t group = 0;   ///< Of its first vertex: which part of the model it is of.
  std::uint32_t twinOf =
      0;  ///< The first of the segments that it is a copy of, maybe itself; itself without `depthWeighting`.
  double depthWeightedArea =
      0;  ///< D: C, less where it lies deeper under the cage than what else lies there; C without `depthWeighting`.

  /// F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed.
  [[nodiscard]] double coverage() const noexcept { return exposedArea > 0 ? coveredArea / exposedArea : 0; }
};

/// Whether a vertex that is not cosmetic becomes so if its segment passes: `never`, `always`, or, from `throughHole`
/// on, if the hole with that number (counted from 0, added to `throughHole`) is explained by what fails behind it.
struct Recovery {
  static constexpr std::uint32_t never = 0;
  static constexpr std::uint32_t always = 1;
  static constexpr std::uint32_t throughHole = 2;
};

/// What of a segment lies nearest to the loop of a hole. Areas are in squared units of the input, and such that the sum
/// of any of them is exact.
struct HoleShare {
  std::uint32_t hole = 0;  ///< A connected component of the cage's open edges.
  std::uint32_t segment = 0;
  double exposedArea = 0;    ///< Of points that the target does not occlude.
  double uncoveredArea = 0;  ///< Of those of them that the cage does not cover.
  /// Of points that the target occludes, and over which the cage is not either; with an `occlusionReach`, and of
  /// segments of which anything is covered.
  double hiddenArea = 0;
};

/// What `classify` needs to know, seen but not owned.
struct ProjectionView {
  std::span<const Zone> zones;  ///< The fields are those of `Projection`.
  std::span<const std::uint32_t> segments;
  std::span<const SegmentStats> segmentStats;
  std::span<const std::uint32_t> recovery = {};
  std::span<const HoleShare> holeShares = {};
};

/// The part of the answer that does not depend on the threshold: steps 1 to 4, and what 5 to 7 need.
struct Projection {
  Array<float> uvs;        ///< 2 per target vertex: its place in the cage's texture, NCZ or not.
  Array<float> cornerUvs;  ///< 2 per target index, with `Seams::corner` and nearest points; else empty. Those of
                           ///< the vertices, but where a seam of the cage's texture runs through a triangle.
  Array<Zone> zones;       ///< 1 per vertex: cosmetic, occluded or uncovered; culled is decided later.
  Array<std::uint32_t> triangles;    ///< 1 per vertex: the nearest cage triangle.
  Array<float> distances;            ///< 1 per vertex: the distance to it, in units of the input.
  Array<std::uint32_t> segments;     ///< 1 per vertex: its segment. Segments are numbered by their first vertex.
  Array<SegmentStats> segmentStats;  ///< 1 per segment; `culled` is false until decided.
  Array<std::uint32_t> recovery;     ///< 1 per vertex, of `Recovery`, with `secondLook` or `holes`; else empty.
  Array<HoleShare> holeShares;  ///< 1 per hole and segment that has something there, with `holes`, ordered by hole.
  Timings timings;
  std::uint64_t peakBytes = 0;  ///< Most memory in use at once during the call, beyond the caller's inputs.

  [[nodiscard]] ProjectionView view() const noexcept { return {zones, segments, segmentStats, recovery, holeShares}; }
};

/// The part of the answer that depends on the threshold: step 5, and what follows from it.
struct Zones {
  Array<Zone> zones;                      ///< 1 per target vertex.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per target triangle: 1 if it may be painted; see `partialTriangles`.
  /// 1 per segment: 0 if it passes; else 1, or `kBared` if by its areas it does, but a hole is meant for it.
  Array<std::uint8_t> culledSegments;
  static constexpr std::uint8_t kBared = 2;
  /// 1 per segment: how many times what is asked of it, or of it and its twins, it reaches. It passes from 1 on, but
  /// for locks; infinity: nothing is asked.
  Array<double> scores;
  Array<std::uint8_t>
      explainedHoles;  ///< 1 per hole up to the last of `holeShares`: 1 if it is meant for what fails there.
};

/// Everything about a transfer.
struct TransferResult {
  Projection projection;  ///< With `segmentStats[].culled` decided, and `timings` complete.
  Zones zones;
};

/// Finds, for every vertex of the target, its place on the cage and what lies over it: steps 1 to 4, threshold-free.
/// Cost: O((V + N + M) log(N + M)) for V vertices and N triangles of the target and M triangles of the cage.
Status project(const MeshView& cage, const MeshView& target, const ProjectOptions& options, Projection& out) noexcept;

/// Decides which segments pass, and so the zone of every vertex: step 5, and the outcome of 6 to 8.
/// Takes microseconds; call it again for another threshold.
/// @param projection  Of any options; `Projection::view()`.
/// @param indices     The target's, 3 per triangle.
Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices,
                const ClassifyOptions& options, Zones& out) noexcept;

/// Carries the cage's UVs to the target and finds its Non-Cosmetic Zones: `project`, then `classify`.
Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options,
                TransferResult& out) noexcept;

/// Frees the working memory that calls keep for the next call.
void releaseArena() noexcept;

}  // namespace cagecast
