#include <limits>

#include "kd_tree.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// The sine of the angle between a ray and a plane under which they count as parallel: a float cannot tell on which side
/// of the plane such a ray runs. Aligned lattices give false hits without it.
constexpr double kParallel = 1e-6;

/// Which of four boxes a ray enters at a distance that is not less than `from`.
unsigned enters(const Node& node, const f32x4 (&origin)[3], const f32x4 (&inverse)[3], const RayDirection& direction, f32x4 from) {
  f32x4 near = from;
  f32x4 far = splat(std::numeric_limits<float>::infinity());
  for (int k = 0; k < 3; ++k) {
    const bool forward = direction.inverse[k] > 0;
    const f32x4 first = (load(forward ? node.low[k] : node.high[k]) - origin[k]) * inverse[k];
    const f32x4 last = (load(forward ? node.high[k] : node.low[k]) - origin[k]) * inverse[k];
    near = simd::max(near, first);
    far = simd::min(far, last);
  }
  return simd::bits(near <= far);
}

/// Which of four triangles the ray's line passes through: the watertight edge test of Woop, Benthin, Wald (2013).
/// A corner is moved to the ray's origin and sheared so that the ray is the z-axis; the signs of the three edge functions
/// then say on which side of each edge the ray runs. Two triangles that share an edge compute the same number with
/// opposite signs, and 0 counts for both, so a ray cannot slip between them.
unsigned crosses(const RayLeaf& leaf, const f32x4 (&origin)[3], const RayDirection& ray) {
  const f32x4 shearX = splat(ray.shearX);
  const f32x4 shearY = splat(ray.shearY);
  f32x4 x[3];
  f32x4 y[3];
  for (int i = 0; i < 3; ++i) {
    const f32x4 z = load(leaf.corner[i][ray.z]) - origin[ray.z];
    x[i] = load(leaf.corner[i][ray.x]) - origin[ray.x] - shearX * z;
    y[i] = load(leaf.corner[i][ray.y]) - origin[ray.y] - shearY * z;
  }
  const f32x4 u = x[2] * y[1] - y[2] * x[1];
  const f32x4 v = x[0] * y[2] - y[0] * x[2];
  const f32x4 w = x[1] * y[0] - y[1] * x[0];
  const f32x4 zero = splat(0);
  const mask4 front = zero <= simd::min(u, simd::min(v, w));
  const mask4 back = simd::max(u, simd::max(v, w)) <= zero;
  return simd::bits(front | back);
}

/// Whether the line crosses the triangle's plane, and beyond `from`: decided in double.
bool crossesBeyond(const RayLeaf& leaf, int lane, const float* origin, Vec3 direction, double from) {
  const auto corner = [&](int i) {
    return Vec3{static_cast<double>(leaf.corner[i][0][lane]), static_cast<double>(leaf.corner[i][1][lane]),
                static_cast<double>(leaf.corner[i][2][lane])};
  };
  const Vec3 a = corner(0);
  const Vec3 normal = cross(corner(1) - a, corner(2) - a);
  const double slope = dot(normal, direction);
  if (slope * slope <= kParallel * kParallel * dot(normal, normal)) return false;
  return dot(normal, a - Vec3::from(origin)) / slope > from;
}

}  // namespace

bool hits(const RayTree& tree, const float* origin, const RayDirection& direction, double from) noexcept {
  const f32x4 start[3] = {splat(origin[0]), splat(origin[1]), splat(origin[2])};
  const f32x4 inverse[3] = {splat(direction.inverse[0]), splat(direction.inverse[1]), splat(direction.inverse[2])};
  const f32x4 nearest = splat(static_cast<float>(from));
  std::uint32_t stack[kStackSize];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t child = stack[--depth];
    if (child & kLeafBit) {
      const RayLeaf& leaf = tree.leaves[child & ~kLeafBit];
      const unsigned crossed = crosses(leaf, start, direction);
      for (int i = 0; crossed >> i != 0; ++i) {
        if ((crossed >> i & 1) && crossesBeyond(leaf, i, origin, direction.exact, from)) return true;
      }
      continue;
    }
    const Node& node = tree.nodes[child];
    const unsigned entered = enters(node, start, inverse, direction, nearest);
    for (int i = 3; i >= 0; --i) {
      if (entered >> i & 1) stack[depth++] = node.child[i];
    }
  }
  return false;
}

}  // namespace cagecast
