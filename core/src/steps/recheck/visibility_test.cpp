#include "steps/recheck/visibility_test.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <new>

#include "base/tolerances.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 9: how far above its point a ray begins, as a share of the diagonal.
constexpr double kLift = 1e-4;

/// docs/method.md, step 9: the directions, spread evenly over the hemisphere about z by the golden angle:
/// z = 1 − (k + 0.5) / 12, azimuth k · 2.399963229728653. Those that are clear most often come first (k = 4, 5, 8, 9,
/// 10), so that many points need no others.
constexpr double kDirections[][3] = {
    {-0.7686917180988453, -0.13597074143449128, 0.625},
    {0.7092551110048801, -0.4511700452553088, 0.5416666666666667},
    {0.8984796285317633, 0.3281233193008084, 0.29166666666666663},
    {-0.9040634576660739, 0.37318425306420056, 0.20833333333333337},
    {0.42052166140780717, -0.8986303646588055, 0.125},
    {0.28565227501671, 0.0, 0.9583333333333334},
    {-0.3569771731011225, 0.32702033252495366, 0.875},
    {0.05341303173720899, -0.6086139473669074, 0.7916666666666666},
    {0.42948366578740593, 0.5601853886979745, 0.7083333333333333},
    {-0.23073121154526574, 0.8583086062567528, 0.45833333333333337},
    {-0.4272722474213815, -0.8226867122930099, 0.375},
    {0.2990239565674109, 0.9533354930388671, 0.04166666666666663},
};

}  // namespace

VisibilityTest::VisibilityTest(const Scene& scene, const Facing& facing) noexcept
    : points_(scene.points),
      facing_(facing),
      lift_(scene.length(kLift)),
      pastTarget_(scene.targetTree, scene.length(kRayStart), scene.arena),
      toCage_(scene.cageTree.rays, -scene.length(kRayStart), scene.arena),
      tests_(scene.arena.allocate<Test>(kMaxTests)),
      directions_(scene.arena.allocate<RayDirection>(RaySearch::kMaxRays)),
      rays_(scene.arena.allocate<Ray>(RaySearch::kMaxRays)),
      testOfRay_(scene.arena.allocate<std::uint16_t>(RaySearch::kMaxRays)),
      hit_(scene.arena.allocate<bool>(RaySearch::kMaxRays)),
      numbers_(scene.arena.allocate<std::uint8_t>(RaySearch::kMaxRays)),
      hitsAt_(scene.arena.allocate<std::uint32_t>(RaySearch::kMaxRays)),
      clear_(scene.arena.allocate<std::uint32_t>(RaySearch::kMaxRays)) {
  static_assert(std::size(kDirections) == kDirectionCount);
}

void VisibilityTest::add(std::uint32_t point, bool isTurned) noexcept {
  tests_[count_++] = {point, isTurned, 0, 0, 0};
  if (facing_.isTwoSided[point]) tests_[count_++] = {point, !isTurned, 0, 0, 0};
}

void VisibilityTest::block(std::uint32_t ray) noexcept {
  Test& test = tests_[testOfRay_[ray]];
  test.blocked = static_cast<std::uint16_t>(test.blocked | 1u << numbers_[ray]);
}

void VisibilityTest::sendRays(const std::uint32_t* segments) noexcept {
  std::uint32_t rayCount = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const unsigned more = *std::upper_bound(std::begin(kStages), std::end(kStages), tests_[i].sent) - tests_[i].sent;
    if (rayCount + more > RaySearch::kMaxRays) break;
    rayCount += setRays(i, more, rayCount);
  }
  pastTarget_.search(rays_, rayCount, hit_, RaySearch::Find::any, hitsAt_);
  std::uint32_t passed = 0;
  for (std::uint32_t r = 0; r < rayCount; ++r) {
    if (hit_[r]) {
      if (segments[hitsAt_[r]] == segments[tests_[testOfRay_[r]].point]) block(r);
      continue;
    }
    testOfRay_[passed] = testOfRay_[r];
    numbers_[passed] = numbers_[r];
    rays_[passed++] = rays_[r];
  }
  toCage_.search(rays_, passed, hit_);
  for (std::uint32_t r = 0; r < passed; ++r) {
    Test& test = tests_[testOfRay_[r]];
    test.clear = static_cast<std::uint8_t>(test.clear + hit_[r]);
    if (!hit_[r]) block(r);
  }
}

std::uint32_t VisibilityTest::listClear(const std::uint32_t* segments, SegmentHits& hits) noexcept {
  std::uint32_t rayCount = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const std::uint32_t more = setRays(i, kDirectionCount, rayCount);
    std::fill_n(hits.own + rayCount, more, segments[tests_[i].point]);
    rayCount += more;
  }
  pastTarget_.search(rays_, rayCount, hit_, hits);
  std::uint32_t passed = 0;
  for (std::uint32_t r = 0; r < rayCount; ++r) {
    if (hit_[r]) continue;
    clear_[passed] = r;
    rays_[passed++] = rays_[r];
  }
  toCage_.search(rays_, passed, hit_);
  std::uint32_t count = 0;
  for (std::uint32_t r = 0; r < passed; ++r) {
    if (!hit_[r]) continue;
    testOfRay_[count] = testOfRay_[clear_[r]];
    clear_[count++] = clear_[r];
  }
  return count;
}

std::uint32_t VisibilityTest::setRays(std::uint32_t of, unsigned more, std::uint32_t firstRay) noexcept {
  Test& test = tests_[of];
  const Vec3 normal = (test.isTurned ? -1 : 1) * facing_.normals[test.point];
  const Vec3 across = cross(normal, std::abs(normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 t1 = 1 / length(across) * across;
  const Vec3 t2 = cross(normal, t1);
  float position[Points::kStride];
  float positionLow[3];
  Points::split(points_.exactly(test.point) + lift_ * normal, position, positionLow);
  std::uint32_t r = firstRay;
  for (const unsigned end = test.sent + more; test.sent < end; ++test.sent) {
    if ((test.blocked >> test.sent & 1u) != 0) continue;
    const double(&d)[3] = kDirections[test.sent];
    // Made in place: a direction that is copied right after it was written waits for those writes.
    new (&directions_[r]) RayDirection(RayDirection::along(d[2] * normal + (d[0] * t1 + d[1] * t2)));
    Ray& ray = rays_[r];
    ray.startAt(position, positionLow);
    ray.direction = &directions_[r];
    ray.end = std::numeric_limits<double>::infinity();
    testOfRay_[r] = static_cast<std::uint16_t>(of);
    numbers_[r++] = test.sent;
  }
  return r - firstRay;
}

}  // namespace cagecast
