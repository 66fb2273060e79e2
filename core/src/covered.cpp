#include "steps.hpp"

namespace cagecast {

bool markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* rays = scratch.take<Ray>(HitSearch::kMostRays);
  auto* ofRay = scratch.take<std::uint32_t>(HitSearch::kMostRays);
  auto* hit = scratch.take<bool>(HitSearch::kMostRays);
  HitSearch search(tree.rays, -kRayStart * units.diagonal, scratch);
  if (scratch.failed()) return false;
  std::uint32_t count = 0;
  const auto send = [&] {
    search.search(rays, count, hit);
    for (std::uint32_t r = 0; r < count; ++r) {
      if (!hit[r]) results.zones[ofRay[r]] = Zone::uncovered;
    }
    count = 0;
  };
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (results.zones[i] != Zone::cosmetic || results.meetsCage[i]) continue;
    ofRay[count] = i;
    rays[count++] = rayOf(points, cage, results, i);
    if (count == HitSearch::kMostRays) send();
  }
  send();
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
