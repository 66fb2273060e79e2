#include <bit>
#include <cmath>
#include <utility>

#include "kd_tree.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// The sine of the angle between a ray and a plane under which the ray lies in the plane: less cannot be told from nothing
/// in double precision between vertices that are floats. (In exact arithmetic such a ray has edge functions of 0 and is turned
/// away by their sum; this is for what rounding leaves of them. No test has needed it yet.)
constexpr double kParallel = 1e-10;

/// The rounding of a distance in `mightHit`: three times that of an edge function, times a corner's distance from the ray's
/// origin (the reach), times the stretch of the shear (less than 2).
constexpr float kDistanceRounding = 8.0f;

/// The distance of a ray that hits nothing, and the end of one that need not look any further.
constexpr double kNowhere = -std::numeric_limits<double>::infinity();

/// An end in float that is not before the exact one.
float looseEnd(double end) { return static_cast<float>(end + 1e-6 * std::abs(end)); }

/// At what distance a ray hits a triangle, or `kNowhere`, decided in double: the watertight edge test of Woop, Benthin, Wald (2013).
/// A corner is moved to the ray's origin and sheared so that the ray is the z-axis; the signs of the three edge functions
/// then say on which side of each edge the ray runs. Two triangles that share an edge compute the same number with opposite
/// signs, and 0 counts for both, so a ray cannot slip between them.
double hitDistance(const RayLeaf& leaf, int lane, const Ray& ray) {
  const RayDirection& direction = *ray.direction;
  const auto corner = [&](int i) {
    return Vec3{static_cast<double>(leaf.corner[i][0][lane]), static_cast<double>(leaf.corner[i][1][lane]),
                static_cast<double>(leaf.corner[i][2][lane])};
  };
  const Vec3 a = corner(0);
  const Vec3 normal = cross(corner(1) - a, corner(2) - a);
  const double slope = dot(normal, direction.exact);
  if (slope * slope <= kParallel * kParallel * dot(normal, normal)) return kNowhere;
  const double d[3] = {direction.exact.x, direction.exact.y, direction.exact.z};
  double x[3];
  double y[3];
  double z[3];
  for (int i = 0; i < 3; ++i) {
    const auto offset = [&](std::uint32_t axis) {
      return static_cast<double>(leaf.corner[i][axis][lane]) -
             (static_cast<double>(ray.origin[axis]) + static_cast<double>(ray.rest[axis]));
    };
    z[i] = offset(direction.z) / d[direction.z];
    x[i] = offset(direction.x) - z[i] * d[direction.x];
    y[i] = offset(direction.y) - z[i] * d[direction.y];
  }
  const double u = x[2] * y[1] - y[2] * x[1];
  const double v = x[0] * y[2] - y[0] * x[2];
  const double w = x[1] * y[0] - y[1] * x[0];
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kNowhere;
  const double sum = u + v + w;
  return sum != 0 ? (u * z[0] + v * z[1] + w * z[2]) / sum : kNowhere;
}

}  // namespace

HitSearch::HitSearch(const RayTree& tree, double from, Scratch& scratch) noexcept
    : tree_(tree),
      from_(from),
      loose_(static_cast<float>(from > 0 ? from / 2 : from * 2)),
      zero_(from > 0 ? 0.0f : -1.0f),
      distanceRounding_(kDistanceRounding * tree.reach),
      slabs_(scratch.take<Slabs>(kMostRays)),
      lists_(scratch.take<std::uint16_t>(kMostRays * (std::size_t{4} * tree.levels + 1))) {}

void HitSearch::search(Ray* rays, std::uint32_t count, bool* hit, Find find) noexcept {
  rays_ = rays;
  hit_ = hit;
  find_ = find;
  const auto octant = [rays](std::uint32_t i) {
    const float* d = rays[i].direction->inverse;
    return unsigned{d[0] < 0} | unsigned{d[1] < 0} << 1 | unsigned{d[2] < 0} << 2;
  };
  std::uint32_t ends[8] = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    ++ends[octant(i)];
    for (int k = 0; k < 3; ++k) {
      slabs_[i].inverse[k] = rays[i].direction->inverse[k];
      slabs_[i].offset[k] = rays[i].origin[k] * rays[i].direction->inverse[k];
    }
    slabs_[i].end() = looseEnd(rays[i].end);
    hit[i] = false;
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& end : ends) sum += std::exchange(end, sum);
  for (std::uint32_t i = 0; i < count; ++i) lists_[ends[octant(i)]++] = static_cast<std::uint16_t>(i);
  std::uint32_t begin = 0;
  for (octant_ = 0; octant_ < 8; begin = ends[octant_++]) {
    if (ends[octant_] > begin) enter(0, lists_ + begin, ends[octant_] - begin, lists_ + count);
  }
}

/// Sends rays into a child. `free` is where lists may be put.
void HitSearch::enter(std::uint32_t child, const std::uint16_t* ids, std::uint32_t count, std::uint16_t* free) noexcept {
  if (child & kLeafBit) {
    testLeaf(tree_.leaves[child & ~kLeafBit], ids, count);
    return;
  }
  const Node& node = tree_.nodes[child];
  std::uint16_t* lists[4] = {free, free + count, free + 2 * count, free + 3 * count};
  std::uint32_t counts[4] = {};
  testBoxes(node, ids, count, lists, counts);
  for (int i = 0; i < 4; ++i) {
    if (counts[i] > 0) enter(node.child[i], lists[i], counts[i], free + 4 * count);
  }
}

/// Lists, for each of four boxes, the rays that enter it at a distance that is not less than `from`, before their end.
void HitSearch::testBoxes(const Node& node, const std::uint16_t* ids, std::uint32_t count, std::uint16_t* const (&lists)[4],
                          std::uint32_t (&counts)[4]) const noexcept {
  // All rays of a pass point to the same octant, so the near and far sides of the boxes are the same for all.
  f32x4 near[3];
  f32x4 far[3];
  for (unsigned k = 0; k < 3; ++k) {
    const bool backward = octant_ >> k & 1;
    near[k] = load(backward ? node.high[k] : node.low[k]);
    far[k] = load(backward ? node.low[k] : node.high[k]);
  }
  const f32x4 from = splat(static_cast<float>(from_));
  std::size_t c0 = 0;
  std::size_t c1 = 0;
  std::size_t c2 = 0;
  std::size_t c3 = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint16_t id = ids[i];
    const Slabs& ray = slabs_[id];
    const f32x4 inverse = load(ray.inverse);
    const f32x4 offset = load(ray.offset);
    const f32x4 inverses[3] = {simd::splatLane<0>(inverse), simd::splatLane<1>(inverse), simd::splatLane<2>(inverse)};
    const f32x4 offsets[3] = {simd::splatLane<0>(offset), simd::splatLane<1>(offset), simd::splatLane<2>(offset)};
    const auto distance = [&](const f32x4 (&sides)[3], int k) { return sides[k] * inverses[k] - offsets[k]; };
    const f32x4 first = simd::max(simd::max(distance(near, 0), distance(near, 1)), simd::max(distance(near, 2), from));
    const f32x4 last =
        simd::min(simd::min(distance(far, 0), distance(far, 1)), simd::min(distance(far, 2), simd::splatLane<3>(inverse)));
    const unsigned entered = simd::bits(first <= last);
    lists[0][c0] = lists[1][c1] = lists[2][c2] = lists[3][c3] = id;
    c0 += entered & 1;
    c1 += entered >> 1 & 1;
    c2 += entered >> 2 & 1;
    c3 += entered >> 3;
  }
  const std::size_t all[4] = {c0, c1, c2, c3};
  for (int i = 0; i < 4; ++i) counts[i] = static_cast<std::uint32_t>(all[i]);
}

void HitSearch::testLeaf(const RayLeaf& leaf, const std::uint16_t* ids, std::uint32_t count) noexcept {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint16_t id = ids[i];
    if (slabs_[id].end() < loose_) continue;
    Ray& ray = rays_[id];
    for (unsigned close = mightHit(leaf, ray); close != 0; close &= close - 1) {
      const double distance = hitDistance(leaf, std::countr_zero(close), ray);
      if (!(distance > from_ && distance <= ray.end)) continue;
      hit_[id] = true;
      if (find_ == Find::any) {
        slabs_[id].end() = static_cast<float>(kNowhere);
        break;
      }
      ray.end = distance;
      slabs_[id].end() = looseEnd(distance);
    }
  }
}

/// Which of four triangles the ray might hit: the test of `hitDistance` in float, with room for its rounding.
unsigned HitSearch::mightHit(const RayLeaf& leaf, const Ray& ray) const noexcept {
  const RayDirection& direction = *ray.direction;
  const f32x4 shearX = splat(direction.shearX);
  const f32x4 shearY = splat(direction.shearY);
  const f32x4 originX = splat(ray.origin[direction.x]);
  const f32x4 originY = splat(ray.origin[direction.y]);
  const f32x4 originZ = splat(ray.origin[direction.z]);
  f32x4 x[3];
  f32x4 y[3];
  f32x4 z[3];
  for (int i = 0; i < 3; ++i) {
    z[i] = load(leaf.corner[i][direction.z]) - originZ;
    x[i] = load(leaf.corner[i][direction.x]) - originX - shearX * z[i];
    y[i] = load(leaf.corner[i][direction.y]) - originY - shearY * z[i];
  }
  const f32x4 u = x[2] * y[1] - y[2] * x[1];
  const f32x4 v = x[0] * y[2] - y[0] * x[2];
  const f32x4 w = x[1] * y[0] - y[1] * x[0];
  const f32x4 rounding = load(leaf.rounding);
  const mask4 front = splat(0) - rounding <= simd::min(u, simd::min(v, w));
  const mask4 back = simd::max(u, simd::max(v, w)) <= rounding;
  // The distance is (u·z0 + v·z1 + w·z2)·scale / (u + v + w); multiplied by the square of the divisor there is no division.
  const f32x4 sum = u + v + w;
  const f32x4 distance = (u * z[0] + v * z[1] + w * z[2]) * splat(direction.scaleZ) * sum;
  const f32x4 slack = rounding * splat(distanceRounding_) * simd::max(sum, splat(0) - sum);
  const mask4 beyond = splat(loose_) * sum * sum <= distance + slack;
  // Triangles at the origin itself come out at 0 exactly; they are many, and no hits if hits begin beyond 0.
  const mask4 elsewhere = (distance < splat(0)) | (splat(zero_) < distance);
  return simd::bits((front | back) & beyond & elsewhere);
}

}  // namespace cagecast
