#include "steps/occluded.hpp"

#include <algorithm>

#include "base/tolerances.hpp"
#include "search/ray_search.hpp"
#include "steps/normal_ray.hpp"

namespace cagecast {

void markOccluded(const Scene& scene, PointData& data) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* rays = arena.allocate<Ray>(RaySearch::kMaxRays);
  auto* hit = arena.allocate<bool>(RaySearch::kMaxRays);
  // Triangles at the point itself are hit at distance 0, exactly, and so do not count.
  RaySearch search(scene.targetTree, scene.length(kRayStart), arena);
  if (arena.failed()) return;
  const double reach = scene.length(static_cast<double>(scene.options.occlusionReach));
  // Copies on the stack: their pointers need no reload after each store to a ray.
  const PointData of = data;
  const Cage cage = scene.cage;
  for (std::uint32_t begin = 0; begin < of.points.count; begin += RaySearch::kMaxRays) {
    const std::uint32_t count = std::min(RaySearch::kMaxRays, of.points.count - begin);
    for (std::uint32_t i = 0; i < count; ++i) {
      setNormalRay(rays[i], of, cage, begin + i);
      if (of.cageDistances != nullptr) rays[i].end = of.cageDistances[begin + i] + reach;
    }
    search.search(rays, count, hit, RaySearch::Find::any, of.occluders == nullptr ? nullptr : of.occluders + begin);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (hit[i]) of.visibility[begin + i] = Visibility::occluded;
    }
  }
}

}  // namespace cagecast
