#include "search/ray_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace cagecast {
namespace {

using simd::f32x4;
using simd::load;
using simd::splat;

/// x and y are repeated so that the next two axes follow each axis.
constexpr std::uint32_t kAxes[] = {0, 1, 2, 0, 1};

/// The end of a ray that needs no further tests.
constexpr auto kDone = -std::numeric_limits<float>::infinity();

/// An end in single precision that is not before the exact one.
float looseEnd(double end) { return static_cast<float>(end + 1e-6 * std::abs(end)); }
/// Times a loose end of at least 0, an end that is not beyond the exact one.
constexpr float kStrictEnd = 0.999996f;

/// The work of a test in double precision, in tests of a leaf in single precision.
constexpr std::uint64_t kExactTest = 64;

}  // namespace

RaySearch::RaySearch(const RayTree& tree, double from, Arena& arena) noexcept
    : tree_(tree),
      arena_(arena),
      from_(from),
      boxFrom_(static_cast<float>(from)),
      limits_{static_cast<float>(from > 0 ? from / 2 : from * 2), static_cast<float>(from > 0 ? from * 2 : from / 2)},
      floatRays_(arena.allocate<FloatRay>(kMaxRays)),
      lists_(arena.allocate<std::uint16_t>(kListRoom)) {}

void RaySearch::search(Ray* rays, std::uint32_t count, bool* hit, SegmentHits& hits) noexcept {
  hits.restart(count);
  hits_ = &hits;
  search(rays, count, hit, Find::all);
}

void RaySearch::search(Ray* rays, std::uint32_t count, bool* hit, Find find, std::uint32_t* hitsAt) noexcept {
  rays_ = rays;
  hit_ = hit;
  find_ = find;
  hitsAt_ = hitsAt;
  // Copies of the pointers: the compiler would reload the members after each store.
  FloatRay* const floatRays = floatRays_;
  std::uint16_t* const list = lists_;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Ray& ray = rays[i];
    const RayDirection::Rough& direction = ray.direction->rough;
    FloatRay& to = floatRays[i];
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
    // Many triangles touch a ray's origin. `loose` is too small, next to rounding errors, to tell that they are hit
    // before the first distance that counts; but if that origin is a float, their depth is exactly 0.
    to.leastDepth = from_ > 0 && ray.isAtPosition() ? 0.0f : -1.0f;
    hit[i] = false;
    list[i] = static_cast<std::uint16_t>(i);
  }
  work_ = 0;
  if (count > 0 && !arena_.failed()) visit(tree_.nodes[0], lists_, count, lists_ + count + 1);
  arena_.spend(work_);
}

/// Traces rays through a node.
/// @param rays  A list of rays with room for one more. It may be overwritten.
/// @param free  Where lists may be written: after `rays`.
void RaySearch::visit(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* free) noexcept {
  work_ += count;
  if (work_ > arena_.workLeft()) return;
  const std::ptrdiff_t room = lists_ + kListRoom - kLastRoom - free;
  if (count > 1 && room < 4 * static_cast<std::ptrdiff_t>(count + 1)) {
    visit(node, rays + count / 2, count - count / 2, free);
    visit(node, rays, count / 2, free);
    return;
  }
  // The last child's list comes first in memory. So each child's own lists can overwrite those of children done before.
  const std::uint32_t size = count + 1;
  std::uint16_t* lists[4] = {free + 3 * size, free + 2 * size, free + size, free};
  std::uint32_t counts[4];
  testBoxes(node, rays, count, free, counts);
  // Neighbouring rays enter the same nodes, so most lists are short of `size`. Long ones are moved together, which
  // leaves room for the levels below.
  if (count >= kLong) {
    for (int i = 3; i-- > 0;) {
      std::uint16_t* const list = lists[i + 1] + counts[i + 1] + 1;
      std::memmove(list, lists[i], counts[i] * sizeof *list);
      lists[i] = list;
    }
  }
  // Unrolled so that each child has branches of its own, which are predicted better.
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    if (counts[i] == 0) continue;
    if (isLeaf(node.child[i])) {
      testLeaf(node, i, lists[i], counts[i]);
    } else {
      visit(tree_.nodes[node.child[i]], lists[i], counts[i], lists[i] + counts[i] + 1);
    }
  }
}

/// Lists, for each of four boxes, the rays that enter it at a distance between `from` and their end.
/// @param lists  The four lists are written here one after the other, the last one first, each with room for all rays
///               and one more.
void RaySearch::testBoxes(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* lists,
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
    const FloatRay& floatRay = floatRays_[ray];
    f32x4 first = from;
    f32x4 last = splat(floatRay.end);
    for (int axis = 0; axis < 3; ++axis) {
      const f32x4 inverse = splat(floatRay.inverse[axis]);
      const f32x4 offset = splat(floatRay.offset[axis]);
      const f32x4 toLow = simd::multiplyAdd(low[axis], inverse, offset);
      const f32x4 toHigh = simd::multiplyAdd(high[axis], inverse, offset);
      first = simd::max(first, simd::min(toLow, toHigh));
      last = simd::min(last, simd::max(toLow, toHigh));
    }
    // Without a branch, which could not be predicted: the ray is written to the end of every list, but only counted
    // in those of the boxes that it enters.
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

/// Tests rays against a leaf.
/// @param rays  The list is overwritten.
void RaySearch::testLeaf(const Node& node, int child, std::uint16_t* rays, std::uint32_t count) noexcept {
  const auto side = [&](int k) { return node.high[k][child] - node.low[k][child]; };
  const RayLeaf leaf(tree_, node.child[child], side(0) + side(1) + side(2), limits_.loose);
  const FloatRay* const floatRays = floatRays_;
  const float soonest = limits_.loose;
  // The list becomes one of the rays that may hit something, each with its possible hits in the lowest four bits.
  // Without a branch, which could not be predicted: a ray without possible hits is overwritten by the next.
  static_assert(kMaxRays <= 1u << 12);
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint16_t ray = rays[i];
    const FloatRay& floatRay = floatRays[ray];
    if (floatRay.end < soonest) continue;
    const unsigned possible = possibleHits(leaf, estimateHits(leaf, floatRay), floatRay.leastDepth);
    rays[left] = static_cast<std::uint16_t>(unsigned{ray} << 4 | possible);
    left += possible != 0;
  }
  if (left == 0) return;
  if (find_ == Find::all) {
    listSegments(leaf, firstOf(node.child[child]), rays, left);
  } else {
    decide(leaf, firstOf(node.child[child]), rays, left);
  }
}

/// Decides which rays hit a leaf's triangles.
/// @param first  The leaf's first triangle.
/// @param rays   Each with its possible hits, as `testLeaf` lists them.
void RaySearch::decide(const RayLeaf& leaf, std::uint32_t first, const std::uint16_t* rays,
                       std::uint32_t count) noexcept {
  const auto keep = [&](std::size_t ray, int lane) {
    if (hitsAt_ != nullptr) hitsAt_[ray] = tree_.corners[std::size_t{3} * (first + static_cast<std::uint32_t>(lane))];
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t id = rays[i] >> 4;
    Ray& ray = rays_[id];
    FloatRay& floatRay = floatRays_[id];
    unsigned open = rays[i] & 15u;
    if (find_ == Find::any) {
      const Verdict verdict = judge(leaf, floatRay, tree_.sceneSize, limits_, kStrictEnd * floatRay.end);
      if (verdict.hit != 0) {
        hit_[id] = true;
        floatRay.end = kDone;
        keep(id, std::countr_zero(verdict.hit));
        continue;
      }
      open &= verdict.open;
    }
    for (; open != 0; open &= open - 1) {
      work_ += kExactTest;
      const double distance = hitDistance(leaf, std::countr_zero(open), ray);
      if (!(distance > from_ && distance <= ray.end)) continue;
      hit_[id] = true;
      keep(id, std::countr_zero(open));
      ray.end = distance;
      floatRay.end = find_ == Find::any ? kDone : looseEnd(distance);
    }
  }
}

/// Lists the segments of a leaf's triangles that rays hit.
/// @param first,rays  As in `decide`.
void RaySearch::listSegments(const RayLeaf& leaf, std::uint32_t first, const std::uint16_t* rays,
                             std::uint32_t count) noexcept {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t id = rays[i] >> 4;
    Ray& ray = rays_[id];
    FloatRay& floatRay = floatRays_[id];
    const Verdict verdict = judge(leaf, floatRay, tree_.sceneSize, limits_, kStrictEnd * floatRay.end);
    for (unsigned left = rays[i] & 15u & (verdict.hit | verdict.open); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const std::uint32_t segment =
          hits_->segmentOf(tree_.corners[std::size_t{3} * (first + static_cast<std::uint32_t>(lane))]);
      if (hits_->has(id, segment)) continue;
      if ((verdict.hit >> lane & 1u) == 0) {
        work_ += kExactTest;
        const double distance = hitDistance(leaf, lane, ray);
        if (!(distance > from_ && distance <= ray.end)) continue;
      }
      if (segment != hits_->own[id]) {
        hits_->add(id, segment);
        continue;
      }
      hit_[id] = true;
      floatRay.end = kDone;
      break;
    }
  }
}

}  // namespace cagecast
