#include "cage.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast {

RayDirection RayDirection::along(Vec3 unit) noexcept {
  const float d[3] = {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
  RayDirection ray{{}, unit};
  Rough& rough = ray.rough;
  // A component of 0 gives a large finite number, so that 0 · inverse is 0 and not NaN.
  const simd::f32x4 direction = simd::of(d[0], d[1], d[2], 1);
  const simd::f32x4 size = simd::splat(1) / simd::max(simd::abs(direction), simd::splat(1e-20f));
  simd::store(rough.inverse, simd::select(direction < simd::splat(0), simd::splat(0) - size, size));
  // No branch: nobody can guess where rays go.
  const float sizes[3] = {std::abs(d[0]), std::abs(d[1]), std::abs(d[2])};
  const auto second = static_cast<std::uint32_t>(sizes[1] > sizes[0]);
  rough.z = second + (2 - second) * static_cast<std::uint32_t>(sizes[2] > std::max(sizes[0], sizes[1]));
  rough.scaleZ = -rough.inverse[rough.z];
  rough.shearX = d[(rough.z + 1) % 3] * rough.scaleZ;
  rough.shearY = d[(rough.z + 2) % 3] * rough.scaleZ;
  return ray;
}

bool gatherCage(const MeshView& cage, const Units& units, Scratch& scratch, Cage& out) noexcept {
  const std::size_t all = cage.indices.size() / 3;
  auto* triangles = scratch.take<CageTriangle>(all);
  if (scratch.failed()) return false;
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
    const TwoVec3 edges = pointsAt(triangle.a, triangle.b) - pointsAt(triangle.c, triangle.a);
    triangle.gradients = simd::splatDouble(1 / doubleArea) * cross(twice(unit), edges);
    triangle.normal = RayDirection::along(unit);
    ++count;
  }
  out = {count, triangles};
  return true;
}

}  // namespace cagecast
