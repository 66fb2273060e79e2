#include "steps.hpp"

namespace cagecast {

bool markOccluded(const Points& points, const Cage& cage, const RayTree& target, const Units& units, Scratch& scratch,
                  PointResults& results) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* rays = scratch.take<Ray>(points.count);
  auto* hit = scratch.take<bool>(points.count);
  if (scratch.failed()) return false;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const float* p = points.at(i);
    rays[i] = {{p[0], p[1], p[2]}, &cage.triangles[results.triangles[i]].normal};
  }
  // Triangles at the point itself are hit at distance 0, exactly, and so do not count.
  if (!findHits(target, rays, points.count, kRayStart * units.diagonal, scratch, hit)) return false;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (hit[i]) results.zones[i] = Zone::occluded;
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
