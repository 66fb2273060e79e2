#include "steps/holes/region.hpp"

#include <algorithm>
#include <limits>

#include "base/area_unit.hpp"
#include "base/union_find.hpp"
#include "steps/cage_place.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 10: a loop is an outer border if what lies beyond it has more than this many times the area
/// that it encloses. A ball that bulges out of a hole by half has twice that area.
constexpr double kMuch = 3;

/// The plane through a boundary loop.
struct LoopPlane {
  Vec3 centre{0, 0, 0};  ///< Of the edges, weighted by their lengths.
  Vec3 area{0, 0, 0};    ///< As long as the enclosed area, on the cage's outer side.
  double perimeter = 0;
};

/// @param[out] planes  1 per loop, as constructed before.
void findPlanes(const Scene& scene, LoopPlane* planes) {
  const BoundaryLoops& loops = scene.loops;
  const auto eachEdge = [&](auto call) {
    for (std::uint32_t t = 0; t < scene.cage.count; ++t) {
      if (!loops.touches(t)) continue;
      const CageTriangle& triangle = scene.cage.triangles[t];
      const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t loop = loops.loopOf[std::size_t{6} * t + k];
        if (loop != BoundaryLoops::kNone) call(planes[loop], corners[k], corners[(k + 1) % 3]);
      }
    }
  };
  eachEdge([](LoopPlane& plane, Vec3 a, Vec3 b) {
    const double size = length(b - a);
    plane.centre = plane.centre + 0.5 * size * (a + b);
    plane.perimeter += size;
  });
  for (std::uint32_t loop = 0; loop < loops.count; ++loop)
    planes[loop].centre = 1 / planes[loop].perimeter * planes[loop].centre;
  eachEdge([](LoopPlane& plane, Vec3 a, Vec3 b) {
    plane.area = plane.area - 0.5 * cross(a - plane.centre, b - plane.centre);
  });
}

bool meetsCage(const PointData& data, std::uint32_t point) {
  return data.cageDistances[point] < std::numeric_limits<double>::infinity();
}

/// Finds the loops with much of the target beyond them.
/// @return Whether there is any.
bool findOuterBorders(const Scene& scene, const PointData& data, const std::uint32_t* loopOf, bool* isOuter) {
  const Arena::Scope scope(scene.arena);
  const std::uint32_t loopCount = scene.loops.count;
  auto* planes = scene.arena.allocate<LoopPlane>(loopCount);
  auto* beyond = scene.arena.allocate<std::int64_t>(loopCount);
  auto* areas = scene.arena.allocate<std::int64_t>(data.points.count);
  if (scene.arena.failed()) return false;
  std::fill(planes, planes + loopCount, LoopPlane{});
  std::fill(beyond, beyond + loopCount, 0);
  findPlanes(scene, planes);
  const Points& points = data.points;
  const AreaUnit unit(points.triangleCount);
  for (std::uint32_t p = 0; p < points.count; ++p) {
    const std::uint32_t loop = loopOf[p];
    areas[p] = loop != BoundaryLoops::kNone && !meetsCage(data, p) &&
               dot(points.exactly(p) - planes[loop].centre, planes[loop].area) > 0;
  }
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = points.triangles[std::size_t{3} * t + static_cast<std::size_t>(k)];
      if (areas[p] != 0) beyond[loopOf[p]] += unit.third(points.doubleAreas[t]);
    }
  }
  for (std::uint32_t loop = 0; loop < loopCount; ++loop)
    isOuter[loop] = unit.area(beyond[loop]) > kMuch * length(planes[loop].area);
  return std::find(isOuter, isOuter + loopCount, true) != isOuter + loopCount;
}

/// Whether a point lies sideways from an outer border.
bool isBesideBorder(const Scene& scene, const PointData& data, std::uint32_t point, const bool* isOuter) {
  if (!scene.loops.touches(data.cageTriangles[point])) return false;
  const CagePlace place(scene, data, point);
  return place.loop != BoundaryLoops::kNone && isOuter[place.loop] && !place.isSlight(scene);
}

}  // namespace

void markBeyond(const Scene& scene, PointData& data, bool* isOuter) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const Points& points = data.points;
  std::fill(isOuter, isOuter + scene.loops.count, false);
  auto* loopOf = arena.allocate<std::uint32_t>(points.count);
  auto* isOut =
      arena.allocate<bool>(points.count);  // Beside an outer border, or outside the cage where it has no loop.
  auto* isBeyond = arena.allocate<bool>(points.count);
  auto* parents = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed()) return;
  for (std::uint32_t p = 0; p < points.count; ++p) {
    loopOf[p] = scene.loops.touches(data.cageTriangles[p]) ? CagePlace(scene, data, p).loop : BoundaryLoops::kNone;
  }
  if (!findOuterBorders(scene, data, loopOf, isOuter)) return;

  for (std::uint32_t p = 0; p < points.count; ++p) {
    const bool misses = data.visibility[p] != Visibility::covered && !meetsCage(data, p);
    if (isBesideBorder(scene, data, p, isOuter)) data.visibility[p] = Visibility::beyond;
    isOut[p] = data.visibility[p] == Visibility::beyond || (loopOf[p] == BoundaryLoops::kNone && misses);
  }
  UnionFind sets(parents, points.count);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = corner[k], b = corner[(k + 1) % 3];
      if (isOut[a] && isOut[b]) sets.join(a, b);
    }
  }
  sets.flatten(points.count);
  // A set is beyond if any of it is beside a border, or if nothing of the target is joined to it.
  std::fill(isBeyond, isBeyond + points.count, true);  // By the sets' roots.
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    if (isOut[corner[0]] && isOut[corner[1]] && isOut[corner[2]]) continue;
    for (int k = 0; k < 3; ++k) isBeyond[parents[corner[k]]] = false;
  }
  for (std::uint32_t p = 0; p < points.count; ++p) {
    if (data.visibility[p] == Visibility::beyond) isBeyond[parents[p]] = true;
  }
  for (std::uint32_t p = 0; p < points.count; ++p) {
    if (isOut[p] && isBeyond[parents[p]]) data.visibility[p] = Visibility::beyond;
  }
}

void markSamplesBeyond(const Scene& scene, PointData& samples, const bool* isOuter) noexcept {
  if (scene.arena.failed()) return;
  for (std::uint32_t i = 0; i < samples.points.count; ++i) {
    if (isBesideBorder(scene, samples, i, isOuter)) samples.visibility[i] = Visibility::beyond;
  }
}

}  // namespace cagecast
