#include "steps/project.hpp"

#include <algorithm>

#include "base/tolerances.hpp"
#include "geometry/closest_point.hpp"
#include "search/closest_point_search.hpp"

namespace cagecast {

void projectPoints(const Scene& scene, PointData& data) noexcept {
  const Points points = data.points;
  const Cage cage = scene.cage;
  const Units& units = scene.units;
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* found = arena.allocate<std::uint32_t>(cage.count);
  auto* candidates = arena.allocate<Candidate>(cage.count);
  // Interior samples are rounded to floats before the search. With the size of the scene added to the diagonal, the
  // search's tolerance is larger than that rounding.
  const double diagonal = units.diagonal + (points.positionLow == nullptr ? 0 : static_cast<double>(units.sceneSize));
  ClosestPointSearch search(scene.cageTree, diagonal, arena);
  if (arena.failed()) return;

  const auto nearestOfSeveral = [&](std::uint32_t member, Vec3 p) {
    const std::uint32_t count = search.candidates(member, found);
    for (std::uint32_t c = 0; c < count; ++c)
      candidates[c] = {found[c], closestPointOnTriangle(cage.triangles[found[c]], p)};
    return nearestOf(candidates, count, units.diagonal);
  };
  const PointData out = data;  // A copy on the stack: its pointers need no reload after each store.
  const double start = scene.length(kRayStart);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t member = i % ClosestPointSearch::kGroup;
    if (member == 0 && arena.failed()) return;  // The work has run out.
    if (member == 0) search.search(points.at(i), std::min(ClosestPointSearch::kGroup, points.count - i));
    const Vec3 p = points.exactly(i);
    const std::uint32_t only = search.onlyCandidate(member);
    const Candidate nearest = only == ClosestPointSearch::kSeveral
                                  ? nearestOfSeveral(member, p)
                                  : Candidate{only, closestPointOnTriangle(cage.triangles[only], p)};

    const ClosestPoint& q = nearest.point;
    const Uv uv = uvAt(cage.triangles[nearest.cageTriangle], q);
    out.uvs[2 * std::size_t{i}] = static_cast<float>(uv.u);
    out.uvs[2 * std::size_t{i} + 1] = static_cast<float>(uv.v);
    out.distances[i] = static_cast<float>(q.distance);
    out.cageTriangles[i] = nearest.cageTriangle;
    // Strictly inside its triangle, q = p − height · n, so the point's ray meets the cage at −height.
    out.meetsCage[i] = q.inside && -q.height > -start;
    if (out.cageDistances != nullptr) out.cageDistances[i] = std::max(0.0, -q.height);
  }
  std::fill(out.visibility, out.visibility + points.count, Visibility::covered);
}

}  // namespace cagecast
