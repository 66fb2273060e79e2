#include "steps/uncovered.hpp"

#include <algorithm>
#include <limits>

#include "base/tolerances.hpp"
#include "search/ray_search.hpp"
#include "steps/cage_place.hpp"
#include "steps/normal_ray.hpp"

namespace cagecast {
namespace {

/// Sends the rays of some points to the cage.
/// @param isChosen  Takes a point.
/// @param take      Takes a point, its ray after the search, and whether the ray hit the cage.
template <typename IsChosen, typename Take>
void sendToCage(const Scene& scene, const PointData& data, RaySearch::Find find, IsChosen isChosen, Take take) {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* rays = arena.allocate<Ray>(RaySearch::kMaxRays);
  auto* pointOfRay = arena.allocate<std::uint32_t>(RaySearch::kMaxRays);
  auto* hit = arena.allocate<bool>(RaySearch::kMaxRays);
  RaySearch search(scene.cageTree.rays, -scene.length(kRayStart), arena);
  if (arena.failed()) return;
  std::uint32_t count = 0;
  const auto send = [&] {
    search.search(rays, count, hit, find);
    for (std::uint32_t r = 0; r < count; ++r) take(pointOfRay[r], rays[r], hit[r]);
    count = 0;
  };
  for (std::uint32_t i = 0; i < data.points.count; ++i) {
    if (!isChosen(i)) continue;
    pointOfRay[count] = i;
    setNormalRay(rays[count++], data, scene.cage, i);
    if (count == RaySearch::kMaxRays) send();
  }
  send();
}

/// Step 6: whether a point is a little outside the cage, and not at a boundary loop.
bool pokesThrough(const Scene& scene, const PointData& data, std::uint32_t point) {
  const CagePlace place(scene, data, point);
  return place.closest.distance <= scene.length(static_cast<double>(scene.options.pokeThrough)) &&
         place.closest.height > 0 && place.loop == BoundaryLoops::kNone;
}

}  // namespace

void findCageDistances(const Scene& scene, PointData& data) noexcept {
  if (data.cageDistances == nullptr || scene.arena.failed()) return;
  sendToCage(
      scene, data, RaySearch::Find::nearest, [&](std::uint32_t i) { return !data.meetsCage[i]; },
      [&](std::uint32_t i, const Ray& ray, bool hit) {
        data.meetsCage[i] = hit;
        data.cageDistances[i] = hit ? std::max(0.0, ray.end) : std::numeric_limits<double>::infinity();
      });
}

void markUncovered(const Scene& scene, PointData& data) noexcept {
  if (scene.arena.failed()) return;
  const bool canPoke = scene.options.pokeThrough > 0;
  const auto mark = [&](std::uint32_t i, bool hit) {
    if (!hit && !(canPoke && pokesThrough(scene, data, i))) data.visibility[i] = Visibility::uncovered;
  };
  if (data.cageDistances != nullptr) {  // `findCageDistances` has sent the rays.
    for (std::uint32_t i = 0; i < data.points.count; ++i) {
      if (data.visibility[i] == Visibility::covered) mark(i, data.meetsCage[i]);
    }
    return;
  }
  sendToCage(
      scene, data, RaySearch::Find::any,
      [&](std::uint32_t i) { return data.visibility[i] == Visibility::covered && !data.meetsCage[i]; },
      [&](std::uint32_t i, const Ray&, bool hit) { mark(i, hit); });
}

}  // namespace cagecast
