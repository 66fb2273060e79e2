#include "steps.hpp"

namespace cagecast {

void markOccluded(const Points& points, const Cage& cage, const RayTree& target, const Units& units,
                  PointResults& results) noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    // Triangles at the point itself are hit at distance 0, exactly, and so do not count.
    const RayDirection& normal = cage.triangles[results.triangles[i]].normal;
    if (hits(target, points.at(i), normal, kRayStart * units.diagonal)) results.zones[i] = Zone::occluded;
  }
}

}  // namespace cagecast
