#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "search/kd_tree.hpp"

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::mask4;
using simd::splat;

/// The sine of the angle between a ray and a plane under which the ray lies in the plane: less cannot be told from
/// nothing in double precision between vertices that are floats. (In exact arithmetic such a ray has edge functions of
/// 0 and is turned away by their sum; this is for what rounding leaves of them. No test has needed it yet.)
constexpr double kParallel = 1e-10;

/// The rounding of an edge function in float, for a ray that comes into the leaf's box, as a share of the scene's reach
/// R times the size E of that box: corners are moved and sheared with errors up to 11 · 2^-24 R, of which 4 are for an
/// origin between floats, then lie within 2 E of the ray; of their products four are off by as much, which is less than
/// 0.7 · 2^-17 R E. (Of triangles beyond the leaf's own it may say too little: they have their leaf.)
constexpr float kEdgeRounding = 0x1p-17f;

/// The same of a triangle whose corners are known to lie within s of the ray, and within d of its origin along it:
/// corners are moved and sheared with errors up to (4 R + 7 d + 2 s) · 2^-24, which makes (20 R + 35 d + 13 s) · 2^-24
/// s. What R is multiplied by,
constexpr float kOriginRounding = 0x1p-19f;
/// and d + s.
constexpr float kShearRounding = 0x1p-18f;

/// The rounding of a distance times the sum of the edge functions: three times that of an edge function, times a
/// corner's depth along the ray (at most the reach), times the stretch of the shear (less than 2),
constexpr float kDistanceRounding = 8.0f;
/// and as a share of the reach times that sum, the rounding of depthWeighting and of what is done with them: some
/// 2^-21, which is less than the former where the depth is the reach.
constexpr float kDepthRounding = 0x1p-19f;

/// The most that the edge functions of a ray that comes into a leaf's box add up to, in squares of the box's size.
constexpr float kMostSum = 24.0f;

/// Axes in a row: from each of them on the next two follow.
constexpr std::uint32_t kAxes[] = {0, 1, 2, 0, 1};

/// The distance of a ray that hits nothing, and the end of one that need not look any further.
constexpr double kNowhere = -std::numeric_limits<double>::infinity();

/// An end in float that is not before the exact one.
float looseEnd(double end) { return static_cast<float>(end + 1e-6 * std::abs(end)); }
/// What makes one that is not behind it of that, if it is not less than 0.
constexpr float kStrictEnd = 0.999996f;

}  // namespace

/// Four triangles side by side, put so when rays come to them: a leaf is visited by a few rays at a time, and three
/// times as large as what it is made from.
struct RayLeaf {
  static constexpr int kRow = 5;  ///< x, y, z, x, y: from each axis on the next two follow.
  float corner[kRow][3][4];       ///< corner[axis in a row][a, b, c][lane].
  float rounding;                 ///< What the edge functions of a ray that hits may be off in float.
  float nearest;  ///< The least that the distance of such a hit, times the sum of these functions, may come out at.

  /// @param size    Of the leaf's box: its sides together.
  /// @param before  `nearest` without rounding, of a box of size 1.
  RayLeaf(const RayTree& tree, std::uint32_t child, float size, float before)
      : rounding(size * kEdgeRounding * tree.reach),
        nearest(size * size * before - rounding * kDistanceRounding * tree.reach) {
    const std::uint32_t* index = tree.corners + std::size_t{3} * firstOf(child);
    for (int i = 0; i < 3; ++i) {
      const auto row = [&](int lane) { return load(tree.positions + std::size_t{4} * index[3 * lane + i]); };
      f32x4 rows[4] = {row(0), row(1), row(2), row(3)};
      simd::transpose(rows[0], rows[1], rows[2], rows[3]);
      for (int k = 0; k < kRow; ++k) simd::store(corner[k][i], rows[k % 3]);
    }
  }
};

namespace {

/// At what distance a ray hits a triangle, or `kNowhere`, decided in double: the watertight edge test of Woop, Benthin,
/// Wald (2013). A corner is moved to the ray's origin and sheared so that the ray is the z-axis; the signs of the three
/// edge functions then say on which side of each edge the ray runs. Two triangles that share an edge compute the same
/// number with opposite signs, and 0 counts for both, so a ray cannot slip between them. Few triangles come to it:
/// inlined it would only take registers from `mightHit`, of which WebAssembly has few.
[[gnu::noinline]] double hitDistance(const RayLeaf& leaf, int lane, const Ray& ray) {
  const RayDirection& direction = *ray.direction;
  const auto corner = [&](int i) {
    return Vec3{static_cast<double>(leaf.corner[0][i][lane]), static_cast<double>(leaf.corner[1][i][lane]),
                static_cast<double>(leaf.corner[2][i][lane])};
  };
  const Vec3 a = corner(0);
  const Vec3 normal = cross(corner(1) - a, corner(2) - a);
  const double slope = dot(normal, direction.exact);
  if (slope * slope <= kParallel * kParallel * dot(normal, normal)) return kNowhere;
  const double d[3] = {direction.exact.x, direction.exact.y, direction.exact.z};
  const std::uint32_t axes[3] = {(direction.rough.z + 1) % 3, (direction.rough.z + 2) % 3, direction.rough.z};
  double x[3];
  double y[3];
  double z[3];
  for (int i = 0; i < 3; ++i) {
    const auto offset = [&](std::uint32_t axis) {
      return static_cast<double>(leaf.corner[axis][i][lane]) - ray.origin(axis);
    };
    z[i] = offset(axes[2]) / d[axes[2]];
    x[i] = offset(axes[0]) - z[i] * d[axes[0]];
    y[i] = offset(axes[1]) - z[i] * d[axes[1]];
  }
  const double u = x[2] * y[1] - y[2] * x[1];
  const double v = x[0] * y[2] - y[0] * x[2];
  const double w = x[1] * y[0] - y[1] * x[0];
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kNowhere;
  const double sum = u + v + w;
  return sum != 0 ? (u * z[0] + v * z[1] + w * z[2]) / sum : kNowhere;
}

/// What the test of `hitDistance` comes to in float, for four triangles.
struct Estimate {
  f32x4 x[3], y[3], z[3];  ///< From the corners to the ray's origin, z along the ray.
  f32x4 least, most;       ///< Of the three edge functions.
  f32x4 sum;               ///< Of them.
  f32x4 depthWeighting;    ///< 0 at the ray's origin, exactly.
  f32x4 distances;         ///< Times the size of `sum`: so there is no division.
};

inline Estimate estimate(const RayLeaf& leaf, const RoughRay& ray) {
  const f32x4 shearX = splat(ray.shearX);
  const f32x4 shearY = splat(ray.shearY);
  const f32x4 originZ = splat(ray.origin[0]);
  const f32x4 originX = splat(ray.origin[1]);
  const f32x4 originY = splat(ray.origin[2]);
  const float(*corner)[3][4] = leaf.corner + ray.axis;
  // From the corners to the origin: in this order a processor subtracts while it loads. The edge functions do not mind.
  Estimate of;
  auto& [x, y, z, least, most, sum, depthWeighting, distances] = of;
  for (int i = 0; i < 3; ++i) {
    z[i] = originZ - load(corner[0][i]);
    x[i] = simd::multiplyAdd(z[i], shearX, originX - load(corner[1][i]));
    y[i] = simd::multiplyAdd(z[i], shearY, originY - load(corner[2][i]));
  }
  const f32x4 u = x[2] * y[1] - y[2] * x[1];
  const f32x4 v = x[0] * y[2] - y[0] * x[2];
  const f32x4 w = x[1] * y[0] - y[1] * x[0];
  // The distance is −(u·z0 + v·z1 + w·z2)·scale / (u + v + w).
  least = simd::min(u, simd::min(v, w));
  most = simd::max(u, simd::max(v, w));
  sum = u + v + w;
  depthWeighting = simd::multiplyAdd(w, z[2], simd::multiplyAdd(v, z[1], u * z[0]));
  const f32x4 scaled = depthWeighting * splat(ray.scaleZ);
  distances = simd::select(sum < splat(0), splat(0) - scaled, scaled);
  return of;
}

/// Which triangles the ray might hit, as far as float can tell.
/// @param nowhere  What the size of the distance has to be more than: 0 if a hit at distance 0 is none, else less.
inline unsigned mightHit(const RayLeaf& leaf, const Estimate& of, f32x4 nowhere) {
  // None is negative, or none is positive.
  const mask4 through = simd::min(splat(0) - of.least, of.most) <= splat(leaf.rounding);
  // Where hits count from is nearer than distances are exact.
  const mask4 beyond = splat(leaf.nearest) <= of.distances;
  // Triangles at the origin itself come out at 0 exactly; they are many, and no hits if hits begin beyond 0.
  return simd::bits(through & beyond & (nowhere < simd::abs(of.depthWeighting)));
}

/// What is known of four triangles that a ray might hit: a bit each.
struct Verdict {
  unsigned hit;   ///< It does, whatever rounding did: double would say the same.
  unsigned open;  ///< Double has to say.
};

/// Looks at an estimate again. Most triangles are near the ray, where less is lost than `mightHit` allows for.
/// @param loose,strict  Hits beyond the one are worth deciding, beyond the other they count, in double as well.
/// @param end           Hits behind it do not.
inline Verdict judge(const Estimate& of, float reach, float loose, float strict, float end) {
  const auto most = [](const f32x4(&a)[3]) {
    return simd::max(simd::abs(a[0]), simd::max(simd::abs(a[1]), simd::abs(a[2])));
  };
  const f32x4 depth = most(of.z);
  const f32x4 width = simd::max(most(of.x), most(of.y));
  const f32x4 rounding =
      width * simd::multiplyAdd(depth + width, splat(kShearRounding), splat(kOriginRounding * reach));
  const f32x4 size = simd::abs(of.sum);
  const f32x4 slack =
      simd::multiplyAdd(depth * rounding, splat(kDistanceRounding), size * splat(kDepthRounding * reach));
  const f32x4 inside = simd::max(of.least, splat(0) - of.most);
  const mask4 isHit = (rounding < inside) & (splat(strict) * size + slack <= of.distances) &
                      (of.distances <= splat(end) * size - slack);
  const mask4 isOpen = (splat(0) - rounding <= inside) & (splat(loose) * size - slack <= of.distances);
  return {simd::bits(isHit), simd::bits(isOpen)};
}

}  // namespace

HitSearch::HitSearch(const RayTree& tree, double from, Arena& arena) noexcept
    : tree_(tree),
      from_(from),
      boxFrom_(static_cast<float>(from)),
      loose_(static_cast<float>(from > 0 ? from / 2 : from * 2)),
      strict_(static_cast<float>(from > 0 ? from * 2 : from / 2)),
      zero_(from > 0 ? 0.0f : -1.0f),
      rough_(arena.allocate<RoughRay>(kMostRays)),
      lists_(arena.allocate<std::uint16_t>(kListRoom)) {}

void HitSearch::search(Ray* rays, std::uint32_t count, bool* hit, Find find) noexcept {
  rays_ = rays;
  hit_ = hit;
  find_ = find;
  RoughRay* const rough = rough_;  // In variables of this function, as nothing that is written changes them.
  std::uint16_t* const list = lists_;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Ray& ray = rays[i];
    const RayDirection::Rough& direction = ray.direction->rough;
    RoughRay& to = rough[i];
    for (int k = 0; k < 3; ++k) {
      to.inverse[k] = direction.inverse[k];
      to.offset[k] = -ray.position[k] * direction.inverse[k];
    }
    to.end = looseEnd(ray.end);
    to.shearX = direction.shearX;
    to.shearY = direction.shearY;
    to.scaleZ = direction.scaleZ;
    to.axis = direction.z;
    for (std::uint32_t k = 0; k < 3; ++k) to.origin[k] = ray.position[kAxes[direction.z + k]];
    hit[i] = false;
    list[i] = static_cast<std::uint16_t>(i);
  }
  if (count > 0) enter(tree_.nodes[0], lists_, count, lists_ + count + 1);
}

/// Sends rays into a node. `free`, behind the rays and room for one more, is where lists may be put.
void HitSearch::enter(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* free) noexcept {
  const std::ptrdiff_t room = lists_ + kListRoom - kLastRoom - free;
  if (count > 1 && room < 4 * static_cast<std::ptrdiff_t>(count + 1)) {
    enter(node, rays + count / 2, count - count / 2, free);
    enter(node, rays, count / 2, free);
    return;
  }
  // Once a child is done with, the lists of the next one's children may lie over its own.
  const std::uint32_t size = count + 1;
  std::uint16_t* lists[4] = {free + 3 * size, free + 2 * size, free + size, free};
  std::uint32_t counts[4];
  testBoxes(node, rays, count, free, counts);
  // Rays that are neighbours go the same way: long lists are pushed together, for the levels to come.
  if (count >= kLong) {
    for (int i = 3; i-- > 0;) {
      std::uint16_t* const list = lists[i + 1] + counts[i + 1] + 1;
      std::memmove(list, lists[i], counts[i] * sizeof *list);
      lists[i] = list;
    }
  }
  // Unrolled, as no two children are alike: each has branches of its own, which are guessed apart.
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    if (counts[i] == 0) continue;
    if (node.child[i] & kLeafBit) {
      testLeaf(node, i, lists[i], counts[i]);
    } else {
      enter(tree_.nodes[node.child[i]], lists[i], counts[i], lists[i] + counts[i] + 1);
    }
  }
}

/// Lists, for each of four boxes, the rays that enter it at a distance that is not less than `from`, before their end.
/// The lists are put one behind the other, the last first, with room for all rays and one more each.
void HitSearch::testBoxes(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* lists,
                          std::uint32_t (&counts)[4]) const noexcept {
  f32x4 low[3];
  f32x4 high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = load(node.low[k]);
    high[k] = load(node.high[k]);
  }
  const f32x4 from = splat(boxFrom_);
  const std::uint32_t room = count + 1;
  simd::u32x4 ends = simd::of(3 * room, 2 * room, room, 0u);  // Of the lists.
  for (const std::uint16_t* next = rays; next < rays + count; ++next) {
    const std::uint16_t ray = *next;
    const RoughRay& rough = rough_[ray];
    f32x4 first = from;
    f32x4 last = splat(rough.end);
    for (int axis = 0; axis < 3; ++axis) {
      // Rays of all directions go together: which side is the near one shows only now.
      const f32x4 inverse = splat(rough.inverse[axis]);
      const f32x4 offset = splat(rough.offset[axis]);
      const f32x4 toLow = simd::multiplyAdd(low[axis], inverse, offset);
      const f32x4 toHigh = simd::multiplyAdd(high[axis], inverse, offset);
      first = simd::max(first, simd::min(toLow, toHigh));
      last = simd::min(last, simd::max(toLow, toHigh));
    }
    // Put down at the end of every list, but only counted where it belongs: no branch.
    lists[simd::lane<0>(ends)] = ray;
    lists[simd::lane<1>(ends)] = ray;
    lists[simd::lane<2>(ends)] = ray;
    lists[simd::lane<3>(ends)] = ray;
    ends = simd::countTrue(ends, first <= last);
  }
  counts[0] = simd::lane<0>(ends) - 3 * room;
  counts[1] = simd::lane<1>(ends) - 2 * room;
  counts[2] = simd::lane<2>(ends) - room;
  counts[3] = simd::lane<3>(ends);
}

/// Tries rays with the four triangles from the first of a leaf on. The list of rays is used up.
void HitSearch::testLeaf(const Node& node, int child, std::uint16_t* rays, std::uint32_t count) noexcept {
  const auto side = [&](int k) { return node.high[k][child] - node.low[k][child]; };
  const RayLeaf leaf(tree_, node.child[child], side(0) + side(1) + side(2), std::min(loose_, 0.0f) * kMostSum);
  const float soonest = loose_;
  const f32x4 zero = splat(zero_);
  // No branch on what is a coin toss: a ray that surely hits nothing is written over by the next.
  static_assert(kMostRays <= 1u << 12);  // So four bits are left beside what names a ray.
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint16_t ray = rays[i];
    const RoughRay& rough = rough_[ray];
    if (rough.end < soonest) continue;
    const unsigned close = mightHit(leaf, estimate(leaf, rough), zero);
    rays[left] = static_cast<std::uint16_t>(unsigned{ray} << 4 | close);
    left += close != 0;
  }
  if (left > 0) decide(leaf, rays, left);
}

/// Decides which rays hit a leaf's triangles.
/// @param rays  With the triangles that they might hit: a bit each.
void HitSearch::decide(const RayLeaf& leaf, const std::uint16_t* rays, std::uint32_t count) noexcept {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t id = rays[i] >> 4;
    Ray& ray = rays_[id];
    RoughRay& rough = rough_[id];
    unsigned open = rays[i] & 15;
    if (find_ == Find::any) {
      const Verdict verdict = judge(estimate(leaf, rough), tree_.reach, loose_, strict_, kStrictEnd * rough.end);
      if (verdict.hit != 0) {
        hit_[id] = true;
        rough.end = static_cast<float>(kNowhere);
        continue;
      }
      open &= verdict.open;
    }
    for (; open != 0; open &= open - 1) {
      const double distance = hitDistance(leaf, std::countr_zero(open), ray);
      if (!(distance > from_ && distance <= ray.end)) continue;
      hit_[id] = true;
      ray.end = distance;
      rough.end = find_ == Find::any ? static_cast<float>(kNowhere) : looseEnd(distance);
    }
  }
}

}  // namespace cagecast
