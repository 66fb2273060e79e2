#include "steps/steps.hpp"

namespace cagecast {

bool markOccluded(const Points& points, const Cage& cage, const RayTree& target, const Units& units, double reach,
                  Arena& arena, PointResults& results) noexcept {
  const Arena::Mark mark = arena.mark();
  auto* rays = arena.allocate<Ray>(HitSearch::kMostRays);
  auto* hit = arena.allocate<bool>(HitSearch::kMostRays);
  // Triangles at the point itself are hit at distance 0, exactly, and so do not count.
  HitSearch search(target, kRayStart * units.diagonal, arena);
  if (arena.failed()) return false;
  // In variables of this function: a ray that is written might change all else, as far as a compiler knows.
  const Points from = points;
  const Cage onto = cage;
  const PointResults of = results;
  for (std::uint32_t begin = 0; begin < points.count; begin += HitSearch::kMostRays) {
    const std::uint32_t count = std::min(HitSearch::kMostRays, points.count - begin);
    for (std::uint32_t i = 0; i < count; ++i) {
      setRay(rays[i], from, onto, of, begin + i);
      if (of.cageDistances != nullptr) rays[i].end = of.cageDistances[begin + i] + reach;
    }
    search.search(rays, count, hit);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (hit[i]) results.zones[begin + i] = Zone::occluded;
    }
  }
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
