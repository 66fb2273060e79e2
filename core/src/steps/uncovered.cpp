#include <limits>

#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// Sends the rays of the points that a predicate picks to the cage.
/// @param take  Takes a point and its ray, after it was sent, and whether it hit.
template <typename Picks, typename Take>
bool sendToCage(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, HitSearch::Find find,
                Arena& arena, const PointResults& results, Picks picks, Take take) {
  const Arena::Mark mark = arena.mark();
  auto* rays = arena.allocate<Ray>(HitSearch::kMostRays);
  auto* ofRay = arena.allocate<std::uint32_t>(HitSearch::kMostRays);
  auto* hit = arena.allocate<bool>(HitSearch::kMostRays);
  HitSearch search(tree.rays, -kRayStart * units.diagonal, arena);
  if (arena.failed()) return false;
  std::uint32_t count = 0;
  const auto send = [&] {
    search.search(rays, count, hit, find);
    for (std::uint32_t r = 0; r < count; ++r) take(ofRay[r], rays[r], hit[r]);
    count = 0;
  };
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (!picks(i)) continue;
    ofRay[count] = i;
    setRay(rays[count++], points, cage, results, i);
    if (count == HitSearch::kMostRays) send();
  }
  send();
  arena.rewind(mark);
  return true;
}

}  // namespace

bool findCageDistances(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Arena& arena,
                       PointResults& results) noexcept {
  return sendToCage(
      points, cage, tree, units, HitSearch::Find::nearest, arena, results,
      [&](std::uint32_t i) { return !results.meetsCage[i]; },
      [&](std::uint32_t i, const Ray& ray, bool hit) {
        results.meetsCage[i] = hit;
        results.cageDistances[i] = hit ? std::max(0.0, ray.end) : std::numeric_limits<double>::infinity();
      });
}

bool markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const BoundaryLoops& loops,
                   const Units& units, double pokeThrough, Arena& arena, PointResults& results) noexcept {
  const auto pokesThrough = [&](std::uint32_t i) {
    const std::uint32_t slot = results.triangles[i];
    const CageTriangle& t = cage.triangles[slot];
    const Vec3 p = points.exactly(i);
    const ClosestPoint place = closestPointOnTriangle(t, p);
    return place.distance <= pokeThrough && place.height > 0 &&
           loops.at(t, slot, positionOf(t, place), units.diagonal) == BoundaryLoops::kNone;
  };
  const auto mark = [&](std::uint32_t i, bool hit) {
    if (!hit && !(pokeThrough > 0 && pokesThrough(i))) results.zones[i] = Zone::uncovered;
  };
  if (results.cageDistances != nullptr) {  // The rays have been sent.
    for (std::uint32_t i = 0; i < points.count; ++i) {
      if (results.zones[i] == Zone::cosmetic) mark(i, results.meetsCage[i]);
    }
    return true;
  }
  return sendToCage(
      points, cage, tree, units, HitSearch::Find::any, arena, results,
      [&](std::uint32_t i) { return results.zones[i] == Zone::cosmetic && !results.meetsCage[i]; },
      [&](std::uint32_t i, const Ray&, bool hit) { mark(i, hit); });
}

}  // namespace cagecast
