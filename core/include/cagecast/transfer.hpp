#pragma once

#include <cstdint>

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
  culled = 3,     ///< NCZ: too little of its segment is covered.
};

/// How a target vertex finds its place on the cage.
enum class ProjectionMode : std::uint8_t {
  nearestPoint,   ///< The nearest point of the cage's surface: the method.
  nearestVertex,  ///< The nearest vertex of the cage, nothing filtered: the classical baseline, for comparison.
};

/// Options of the costly part. The defaults are the method of the poster.
struct ProjectOptions {
  ProjectionMode projection = ProjectionMode::nearestPoint;
  float weldTolerance = 0.0f;  ///< Vertices nearer than this share of the target's diagonal are one point; 0..0.01.
};

/// Options of the decision per segment.
struct ClassifyOptions {
  float threshold = 0.5f;  ///< A segment passes if at least this share of its exposed area is covered; 0..1.
};

struct TransferOptions : ProjectOptions, ClassifyOptions {};

/// CPU time of each step in milliseconds; wall time in WebAssembly, which has no other clock.
struct Timings {
  double weld = 0;      ///< Checking the input and welding the target's vertices.
  double build = 0;     ///< Building the search trees of cage and target.
  double project = 0;   ///< Step 1: the nearest point of the cage for every point of the target.
  double occluded = 0;  ///< Step 2: self-intersection.
  double covered = 0;   ///< Step 3: cage intersection.
  double segments = 0;  ///< Step 4: connected components, and their areas.
  double classify = 0;  ///< Step 5: the threshold, and writing the answer out to vertices and triangles.
  double total = 0;     ///< All of it, from raw arrays to zones.
};

/// What is known of one connected component of the target. Areas are in squared units of the input.
struct SegmentStats {
  std::uint32_t points = 0;  ///< Welded points.
  bool culled = false;       ///< Too little of it is covered: none of it may be painted.
  double area = 0;           ///< A: its whole area.
  double exposedArea = 0;    ///< E: area of the points that the target does not occlude.
  double coveredArea = 0;    ///< C: area of the points that the cage covers as well.

  /// F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed.
  [[nodiscard]] double coverage() const noexcept { return exposedArea > 0 ? coveredArea / exposedArea : 0; }
};

/// The part of the answer that does not depend on the threshold: steps 1 to 4.
struct Projection {
  Array<float> uvs;                ///< 2 per target vertex: its place in the cage's texture, NCZ or not.
  Array<Zone> zones;               ///< 1 per vertex: cosmetic, occluded or uncovered; culled is decided later.
  Array<std::uint32_t> triangles;  ///< 1 per vertex: the nearest cage triangle.
  Array<float> distances;          ///< 1 per vertex: the distance to it, in units of the input.
  Array<std::uint32_t> segments;   ///< 1 per vertex: its segment. Segments are numbered by their first vertex.
  Array<SegmentStats> segmentStats;  ///< 1 per segment; `culled` is false until decided.
  Timings timings;
  std::uint64_t peakBytes = 0;     ///< Most memory in use at once during the call, beyond the caller's inputs.
};

/// The part of the answer that depends on the threshold: step 5.
struct Zones {
  Array<Zone> zones;                    ///< 1 per target vertex.
  Array<std::uint8_t> cosmeticTriangles;  ///< 1 per target triangle: 1 if all three corners are cosmetic.
  Array<std::uint8_t> culledSegments;   ///< 1 per segment: 1 if it falls below the threshold.
};

/// Everything about a transfer.
struct TransferResult {
  Projection projection;  ///< With `segmentStats[].culled` decided, and `timings` complete.
  Zones zones;
};

/// Finds, for every vertex of the target, its place on the cage and what lies over it: steps 1 to 4, threshold-free.
/// Cost: O((V + N + M) log(N + M)) for V vertices and N triangles of the target and M triangles of the cage.
Status project(const MeshView& cage, const MeshView& target, const ProjectOptions& options, Projection& out) noexcept;

/// Decides which segments pass the threshold, and so the zone of every vertex: step 5.
/// Takes microseconds; call it again for another threshold.
/// @param zones,segments  As in `Projection`, 1 per vertex.
/// @param stats           As in `Projection`, 1 per segment.
/// @param indices         The target's, 3 per triangle.
Status classify(std::span<const Zone> zones, std::span<const std::uint32_t> segments,
                std::span<const SegmentStats> stats, std::span<const std::uint32_t> indices,
                const ClassifyOptions& options, Zones& out) noexcept;

/// Carries the cage's UVs to the target and finds its Non-Cosmetic Zones: `project`, then `classify`.
Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options,
                TransferResult& out) noexcept;

/// Frees the working memory that calls keep for the next call.
void releaseScratch() noexcept;

}  // namespace cagecast
