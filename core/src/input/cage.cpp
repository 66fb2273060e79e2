#include "input/cage.hpp"

#include <algorithm>

#include "geometry/triangle.hpp"
#include "simd/simd.hpp"

namespace cagecast {

bool gatherCage(const MeshView& cage, const Units& units, Arena& arena, Cage& out) noexcept {
  const std::size_t all = cage.indices.size() / 3;
  auto* triangles = arena.allocate<CageTriangle>(all);
  if (arena.failed()) return false;
  std::uint32_t count = 0;
  for (std::size_t t = 0; t < all; ++t) {
    CageTriangle& triangle = triangles[count];
    float* corners[3] = {triangle.a, triangle.b, triangle.c};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t v = cage.indices[3 * t + i];
      simd::store(corners[i], simd::load3(&cage.positions[3 * v]) * simd::splat(units.scale));
      std::copy_n(&cage.uvs[2 * v], 2, triangle.uvs + 2 * i);
    }
    const Vec3 normal = areaNormal(triangle.a, triangle.b, triangle.c);
    const double doubleArea = length(normal);
    if (!(doubleArea > 0)) continue;
    const Vec3 unit = 1 / doubleArea * normal;
    triangle.index = static_cast<std::uint32_t>(t);
    const Vec3 a = Vec3::from(triangle.a);
    triangle.gradientB = 1 / doubleArea * cross(unit, a - Vec3::from(triangle.c));
    triangle.gradientC = 1 / doubleArea * cross(unit, Vec3::from(triangle.b) - a);
    triangle.normal = RayDirection::along(unit);
    ++count;
  }
  out = {count, triangles};
  return true;
}

}  // namespace cagecast
