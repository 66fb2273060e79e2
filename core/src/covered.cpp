#include "steps.hpp"

namespace cagecast {

bool markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept {
  const auto asks = [&](std::uint32_t i) { return results.zones[i] == Zone::cosmetic && !results.meetsCage[i]; };
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) count += asks(i);
  const Scratch::Mark mark = scratch.mark();
  auto* rays = scratch.take<Ray>(count);
  auto* ofRay = scratch.take<std::uint32_t>(count);
  auto* hit = scratch.take<bool>(count);
  if (scratch.failed()) return false;
  count = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (!asks(i)) continue;
    const float* p = points.at(i);
    ofRay[count] = i;
    rays[count++] = {{p[0], p[1], p[2]}, &cage.triangles[results.triangles[i]].normal};
  }
  if (!findHits(tree.rays, rays, count, -kRayStart * units.diagonal, scratch, hit)) return false;
  for (std::uint32_t r = 0; r < count; ++r) {
    if (!hit[r]) results.zones[ofRay[r]] = Zone::uncovered;
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
