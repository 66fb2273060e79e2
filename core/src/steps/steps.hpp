#pragma once

#include <algorithm>
#include <cstdint>

#include "base/arena.hpp"
#include "cage/boundary_loops.hpp"
#include "cagecast/transfer.hpp"
#include "input/cage.hpp"
#include "input/validate.hpp"
#include "input/weld.hpp"
#include "search/kd_tree.hpp"

/// The steps of the method, in order; each has a file of its own. All work on welded points, in scaled units.
namespace cagecast {

/// What is known of every point, one array per field.
struct PointResults {
  float* uvs = nullptr;                ///< 2 per point.
  float* distances = nullptr;          ///< To the nearest cage point, scaled.
  std::uint32_t* triangles = nullptr;  ///< The place of the nearest triangle in `Cage::triangles`.
  Zone* zones = nullptr;
  bool* meetsCage = nullptr;  ///< Step 1 knows already that step 3's ray hits.
  double* cageDistances =
      nullptr;  ///< How far along the ray the cage is, from 0; infinity: nowhere. Only with step 2′.
  std::uint32_t* segments = nullptr;
};

/// Big triangles of small segments, in order, each with four places inside it whose zones count instead of the
/// corners'.
struct InteriorSamples {
  std::uint32_t count = 0;
  const std::uint32_t* triangles = nullptr;  ///< In `Points::triangles`.
  Points points;                             ///< 4 per triangle.
  PointResults results;                      ///< Of these points.
};

/// Makes the ray of docs/method.md, step 1: from the point, along the normal of its nearest cage triangle, without end.
inline void setRay(Ray& ray, const Points& points, const Cage& cage, const PointResults& results, std::uint32_t point) {
  // In place, field by field: a ray that is copied as a whole right after it was written stalls.
  static constexpr float kNothing[3] = {};
  ray.direction = &cage.triangles[results.triangles[point]].normal;
  ray.startAt(points.at(point), points.rests == nullptr ? kNothing : points.rests + std::size_t{3} * point);
  ray.end = std::numeric_limits<double>::infinity();
}

/// All steps return false if memory ran out.

/// Step 1: finds, for every point, the nearest point of the cage, and blends its UVs.
bool projectPoints(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Arena& arena,
                   PointResults& results) noexcept;

/// Instead of step 1, for comparison: takes the UVs of the nearest cage vertex.
bool projectToVertices(const MeshView& cageMesh, const Points& points, const Cage& cage, const Units& units,
                       Arena& arena, PointResults& results) noexcept;

/// Before step 2′: finds how far along its ray the cage is, for the points of which step 1 does not know it.
bool findCageDistances(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Arena& arena,
                       PointResults& results) noexcept;

/// Step 2: marks the points over which the target itself lies; with distances to the cage only up to `reach` beyond it.
/// @param reach  Scaled.
bool markOccluded(const Points& points, const Cage& cage, const RayTree& target, const Units& units, double reach,
                  Arena& arena, PointResults& results) noexcept;

/// Step 3: marks the points left whose ray leaves through a hole of the cage, but for those that step 3′ lets poke
/// through.
/// @param pokeThrough  Scaled; 0: none.
bool markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const BoundaryLoops& loops,
                   const Units& units, double pokeThrough, Arena& arena, PointResults& results) noexcept;

/// Step 4: finds the connected components, numbered by their first vertex. Of `stats` the points and groups are filled
/// in.
/// @param groups  1 per vertex, or none.
bool findSegments(const Points& points, std::uint32_t vertexCount, std::span<const std::uint32_t> groups, Arena& arena,
                  PointResults& results, Array<SegmentStats>& stats) noexcept;

/// Step 4′: finds the triangles that vote from within, and the places inside them, not yet judged.
bool findInteriorSamples(const Points& points, const BoundaryLoops& loops, const Units& units,
                         const PointResults& results, const Array<SegmentStats>& stats, const TransferOptions& options,
                         Arena& arena, InteriorSamples& out) noexcept;

/// Areas of the points, as whole numbers of an `AreaUnit`.
struct PointAreas {
  const std::int64_t* all = nullptr;              ///< A third of each triangle at the point.
  const std::int64_t* interiorSamples = nullptr;  ///< The same without the triangles that vote from within.
};

/// Adds up the areas of the points, in memory of `arena`, and those of the segments for step 5.
bool addUpAreas(const Points& points, const InteriorSamples& samples, const Units& units, const PointResults& results,
                Arena& arena, PointAreas& areas, Array<SegmentStats>& stats) noexcept;

/// Step 5′: finds how much of what is covered lies no deeper than its neighbours.
bool findDepthWeightedAreas(const Points& points, const Cage& cage, const HalfEdges& edges,
                            const InteriorSamples& samples, const PointAreas& areas, const Units& units,
                            const PointResults& results, Arena& arena, Array<SegmentStats>& stats) noexcept;

/// Step 5′: finds which segments are copies of others.
bool findTwins(const Points& points, const PointResults& results, Arena& arena, Array<SegmentStats>& stats) noexcept;

/// Step 6: finds the occluded points that are seen from elsewhere, in the segments of which anything is covered: others
/// pass at a threshold of 0 without a floor alone, or by a lock, and are taken as they are.
/// @param[out] recovery  1 per point: set to `Recovery::always` for those.
bool recheckOccluded(const Points& points, const Cage& cage, const CageTree& cageTree, const RayTree& targetTree,
                     const Units& units, const PointResults& results, const PointAreas& areas,
                     const Array<SegmentStats>& stats, const TransferOptions& options, Arena& arena,
                     std::uint32_t* recovery) noexcept;

/// Step 7: finds what brings each uncovered point back, and what the segments have at each hole.
/// @param[out] recovery  1 per point: set for those.
bool assignHoles(const Points& points, const Cage& cage, const BoundaryLoops& loops, const Units& units,
                 const PointResults& results, const PointAreas& areas, const Array<SegmentStats>& stats, Arena& arena,
                 std::uint32_t* recovery, Array<HoleShare>& shares) noexcept;

/// Step 8: marks the triangles that may be painted.
/// @param[out] cosmetic  1 per triangle.
void markCosmetic(const Array<Zone>& zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept;

/// How far from its origin, as a share of the diagonal, a ray's hit begins to count (step 2), and how far behind it one
/// still does (step 3).
inline constexpr double kRayStart = 1e-5;

}  // namespace cagecast
