#include "steps.hpp"

namespace cagecast {

void markUncovered(const Points& points, const Cage& cage, const CageTree& tree, const Units& units,
                   PointResults& results) noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (results.zones[i] != Zone::cosmetic || results.meetsCage[i]) continue;
    const RayDirection& normal = cage.triangles[results.triangles[i]].normal;
    if (!hits(tree.rays, points.at(i), normal, -kRayStart * units.diagonal)) results.zones[i] = Zone::uncovered;
  }
}

}  // namespace cagecast
