#pragma once

#include <algorithm>
#include <cstdint>

#include "cage.hpp"
#include "cagecast/transfer.hpp"
#include "check.hpp"
#include "kd_tree.hpp"
#include "scratch.hpp"
#include "weld.hpp"

/// The steps of the method, in order; each has a file of its own. All work on welded points, in scaled units.
namespace cagecast {

/// What is known of every point, one array per field.
struct PointResults {
  float* uvs = nullptr;                ///< 2 per point.
  float* distances = nullptr;          ///< To the nearest cage point, scaled.
  std::uint32_t* triangles = nullptr;  ///< The place of the nearest triangle in `Cage::triangles`.
  Zone* zones = nullptr;
  bool* meetsCage = nullptr;           ///< Step 1 knows already that step 3's ray hits.
  std::uint32_t* segments = nullptr;
};

/// The ray of docs/method.md, step 1: from the point, along the normal of its nearest cage triangle.
inline Ray rayOf(const Points& points, const Cage& cage, const PointResults& results, std::uint32_t point) {
  const float* p = points.at(point);
  return {{p[0], p[1], p[2]}, &cage.triangles[results.triangles[point]].normal};
}

/// All steps return false if memory ran out.

/// Step 1: finds, for every point, the nearest point of the cage, and blends its UVs.
bool projectPoints(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept;

/// Instead of step 1, for comparison: takes the UVs of the nearest cage vertex.
bool projectToVertices(const MeshView& cageMesh, const Points& points, const Cage& cage, const Units& units,
                       Scratch& scratch, PointResults& results) noexcept;

/// Step 2: marks the points over which the target itself lies.
bool markOccluded(const Points& points, const Cage& cage, const RayTree& target, const Units& units, Scratch& scratch,
                  PointResults& results) noexcept;

/// Step 3: marks the points left whose ray leaves through a hole of the cage.
bool markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept;

/// Step 4: finds the connected components, numbered by their first vertex, and adds up their areas for step 5.
bool findSegments(const Points& points, std::uint32_t vertexCount, const Units& units, Scratch& scratch,
                  PointResults& results, Array<SegmentStats>& stats) noexcept;

/// How far from its origin, as a share of the diagonal, a ray's hit begins to count (step 2), and how far behind it one
/// still does (step 3).
inline constexpr double kRayStart = 1e-5;

}  // namespace cagecast
