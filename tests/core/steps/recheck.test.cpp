// Steps 9 and 10 on small scenes with known answers.

#include <algorithm>
#include <cmath>

#include "cagecast/clip.hpp"
#include "checks.hpp"

using namespace cagecast;
using scenes::append;
using scenes::Mesh;
using scenes::Point;
using scenes::sheet;

namespace {

void addTriangle(Mesh& mesh, Point at, float size) {
  const std::uint32_t first = mesh.addVertex({at[0] - size, at[1] - size, at[2]});
  mesh.addVertex({at[0] + size, at[1] - size, at[2]});
  mesh.addVertex({at[0], at[1] + size, at[2]});
  mesh.addTriangle(first, first + 1, first + 2);
}

/// How many of the first vertices of a target are occluded.
std::size_t occludedOf(std::size_t count, const Mesh& cage, const Mesh& target, bool isRechecked) {
  TransferOptions options;
  options.steps.recheck = isRechecked;
  const TransferResult result = transferred(cage.view(), target.view(), options);
  return static_cast<std::size_t>(
      std::count(result.zones.zones.begin(), result.zones.zones.begin() + count, Zone::occluded));
}

}  // namespace

TEST_CASE("a corner behind something small is seen past it, be it the only one", "[recheck]") {
  Mesh target;
  addTriangle(target, {0, 0, 1.5f}, 1);
  addTriangle(target, {-1, -1, 1.6f}, 0.04f);
  const Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  CHECK(occludedOf(1, cage, target, false) == 1);
  CHECK(occludedOf(1, cage, target, true) == 0);
  requireSameAsReference("something small", cage.view(), target.view(), {});
}

TEST_CASE("occluded points of a part that the cage covers nowhere get no more rays", "[recheck]") {
  // A shelf beside the cage, half of it under a roof. From there, rays to the side pass under the roof to the cage.
  const auto shelf = [](float x) {
    Mesh target;
    for (const auto& [u, z] : {std::pair{0.0f, 0.0f}, {0.5f, 0.0f}, {0.75f, 0.0f}, {1.0f, 0.0f}, {0.45f, 0.2f}})
      for (const float y : {-0.5f, 0.5f}) target.addVertex({x + u, z > 0 ? 2 * y : y, z}, 0, 0, 1);
    for (const auto& [a, b] : {std::pair{0u, 2u}, {2u, 4u}, {4u, 6u}, {8u, 6u}}) {
      target.addTriangle(a, b, a + 1);
      target.addTriangle(b, b + 1, a + 1);
    }
    return target;
  };
  const Mesh cage = sheet({-2, -2, 1}, {4, 0, 0}, {0, 4, 0});
  const std::uint32_t kept[] = {1};
  TransferOptions options;
  options.steps.holes = false;
  options.parts.keep = kept;
  for (const float x : {1.25f, 2.25f}) {
    const TransferResult result = transferred(cage.view(), shelf(x).view(), options);
    const bool isLeft = result.zones.zones[2] == Zone::occluded && result.zones.zones[3] == Zone::occluded;
    CHECK(isLeft == (x > 2));
    // At a threshold of 0 and without a floor, such parts pass unlocked.
    TransferOptions loose = TransferOptions::paper();
    loose.threshold = 0;
    loose.steps.recheck = true;
    CHECK(requireSameAsReference("a shelf", cage.view(), shelf(x).view(), loose).unstable == 0);
  }
}

TEST_CASE("a sheet with two sides, between two others, is seen from where the reference sees it", "[recheck]") {
  const Mesh cage = scenes::box({0, 0, 0.1f}, {5, 5, 1.2f}, 4);
  std::size_t occluded = 0, left = 0;
  for (int step = 1; step <= 12; ++step) {
    Mesh target = sheet({-1.1f, -1, 0}, {2.8f, 0, 0}, {0, 2, 0}, 8);
    for (std::size_t t = 0, count = target.triangleCount(); t < count; ++t)
      target.addTriangle(target.indices[3 * t], target.indices[3 * t + 2], target.indices[3 * t + 1]);
    const float share = static_cast<float>(step) / 13;
    append(target, sheet({-3.1f, -3.2f, share * 0.4f}, {3.9f, 0, 0}, {0, 6.5f, 0}, 8));
    append(target, sheet({-3.2f, -3.3f, (share - 1) * 0.3f}, {4.03f, 0, 0}, {0, 6.4f, 0}, 8));
    occluded += occludedOf(81, cage, target, false);
    left += occludedOf(81, cage, target, true);
    requireSameAsReference("sheets", cage.view(), target.view(), {});
  }
  // Of 12 · 81 points.
  CHECK(occluded > 500);
  CHECK(left > 50);
  CHECK(left < 200);
}

TEST_CASE("a part that faces neither to the cage nor away from it is seen on the side of its normals", "[recheck]") {
  // An upright sheet beside a wall. A roof hides most of it from the cage above, and leaves one of its sides open.
  const Mesh cage = scenes::box({}, {5, 5, 2}, 4);
  for (const bool isTurned : {false, true}) {
    // The sheet's front looks away from the wall, or, turned, to it.
    Mesh target = isTurned ? sheet({0, -1, 0}, {0, 0, 1}, {0, 2, 0}, 8) : sheet({0, -1, 0}, {0, 2, 0}, {0, 0, 1}, 8);
    append(target, sheet({-0.5f, -3, 1.25f}, {1, 0, 0}, {0, 3.6f, 0}));
    append(target, sheet({-0.1f, -3, -1}, {0, 0, 2.25f}, {0, 6, 0}));
    const std::size_t once = occludedOf(81, cage, target, false);
    CHECK(once > 40);
    CHECK(occludedOf(81, cage, target, true) == (isTurned ? once : 0));
    requireSameAsReference("an upright sheet", cage.view(), target.view(), {});
  }
}

TEST_CASE("what stays unpainted hides nothing, also by a lock that is set later, and on a cut target", "[recheck]") {
  // Skin with strands of hair before it, outside the cage, and in it a groove, whose walls hide each other.
  const auto inGroove = [](Point p) { return p[0] > 0.2f && p[0] < 0.3f ? Point{p[0], p[1], p[2] - 0.02f} : p; };
  const Mesh cage = sheet({-1, -1, 0.01f}, {2, 0, 0}, {0, 2, 0}, 4);
  Mesh target = scenes::mapped(sheet({-0.9f, -0.9f, 0}, {1.8f, 0, 0}, {0, 1.8f, 0}, 24), inGroove);
  const std::size_t skin = target.vertexCount();
  for (int strand = 0; strand < 8; ++strand)
    append(target, sheet({-0.85f + 0.21f * static_cast<float>(strand), -1.1f, 0.03f}, {0.15f, 0, 0}, {0, 2.2f, 0}, 3));
  const auto occluded = [&](const Array<Zone>& zones) { return std::count(&zones[0], &zones[skin], Zone::occluded); };
  TransferOptions options;
  options.steps.recheck = false;
  CHECK(occluded(transferred(cage.view(), target.view(), options).zones.zones) > 300);
  options.steps.recheck = true;
  const TransferResult result = transferred(cage.view(), target.view(), options);
  CHECK(occluded(result.zones.zones) == 0);
  CHECK(requireSameAsReference("hair", cage.view(), target.view(), options).unstable == 0);

  const std::vector<std::uint32_t> segments = copied(result.projection.segments);
  CutTarget cut;
  const DecidedTarget decided{target.view(), result.zones.zones, segments, result.zones.culledBy};
  REQUIRE(cutBorders(cage.view(), decided, options, testWorkspace(), cut).ok());
  CHECK(occluded(cut.zones) == 0);

  // Hair that is painted hides what is behind it.
  std::vector<LockEntry> kept;
  for (std::uint32_t s = 1; s < result.projection.segmentStats.size(); ++s) kept.push_back({s, Lock::keep});
  options.locks = kept;
  Zones zones;
  REQUIRE(classify(result.projection.view(), target.indices, options, zones).ok());
  CHECK(occluded(zones.zones) > 50);
  CHECK(copied(zones.zones) == copied(transferred(cage.view(), target.view(), options).zones.zones));
}

TEST_CASE("what is seen past others is recovered, wherever the ray along its normal goes", "[recheck]") {
  // Skin under a small hole of the cage. A flap of its own hides the middle from the hole, and a sheet that stays bare
  // hides it from the cage on all sides.
  const Mesh cage = scenes::without(sheet({-2, -2, 1}, {4, 0, 0}, {0, 4, 0}, 40),
                                    [](Point p) { return std::abs(p[0]) < 0.1f && std::abs(p[1]) < 0.1f; });
  Mesh target = sheet({-2, -2, 0.97f}, {4, 0, 0}, {0, 4, 0}, 20);
  const auto at = [&](float x, float y) {
    std::uint32_t v = 0;
    while (scenes::distance(target.vertex(v), {x, y, 0.97f}) > 0.01f) ++v;
    return v;
  };
  const std::uint32_t middle = at(0, 0);
  const std::uint32_t tip = target.addVertex({0.02f, -0.02f, 0.98f});
  target.addVertex({0.02f, 0.02f, 0.98f});
  target.addTriangle(at(-0.2f, 0), tip, tip + 1);
  append(target, sheet({-0.9f, -0.9f, 1.03f}, {1.8f, 0, 0}, {0, 1.8f, 0}));
  const TransferResult result = transferred(cage.view(), target.view(), {});
  CHECK(result.projection.visibility[middle] == Visibility::occluded);
  CHECK(result.zones.zones[middle] == Zone::cosmetic);
  requireSameAsReference("under a flap", cage.view(), target.view(), {});
}

TEST_CASE("a point overhangs a small hole by a share of the hole, not of the model", "[holes]") {
  // A hole whose loop measures 0.0417 of the diagonal: points in it may be 0.0071 from its edge, not 0.017.
  const Mesh cage = scenes::without(scenes::box({}, {1, 1, 1}, 20), [](Point p) {
    return p[0] > 0 && p[0] < 0.1f && p[1] > 0 && p[1] < 0.1f && p[2] > 0.9f;
  });
  Mesh target = scenes::box({}, {0.98f, 0.98f, 0.98f}, 1);
  const auto atHole = [&](float x) {
    const std::uint32_t first = target.addVertex({x, 0.05f, 0.99f});
    target.addVertex({x - 0.02f, 0.04f, 0.99f});
    target.addVertex({x - 0.02f, 0.06f, 0.99f});
    target.addTriangle(first, first + 1, first + 2);
    return first;
  };
  const std::uint32_t atEdge = atHole(0.006f), farther = atHole(0.012f);
  requireSameAsReference("a small hole", cage.view(), target.view(), {});
  const Projection projection = transferred(cage.view(), target.view(), {}).projection;
  CHECK(projection.visibility[atEdge] == Visibility::uncovered);
  CHECK(projection.recovery[atEdge] == Recovery::always);
  CHECK(projection.recovery[farther] >= Recovery::throughHole);
}

TEST_CASE("an excluded segment explains the hole it lies under, a kept one does not", "[holes]") {
  const scenes::Scene scene = scenes::crowdedHead(16, 0);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), {});
  const auto& stats = result.projection.segmentStats;
  const auto isSmaller = [](const SegmentStats& a, const SegmentStats& b) { return a.points < b.points; };
  const auto skin = static_cast<std::size_t>(std::max_element(stats.begin(), stats.end(), isSmaller) - stats.begin());
  for (const Lock lock : {Lock::exclude, Lock::keep}) {
    std::vector<LockEntry> locks;
    for (std::uint32_t s = 0; s < stats.size(); ++s) locks.push_back({s, s == skin ? Lock::keep : lock});
    TransferOptions options;
    options.locks = locks;
    Zones zones;
    REQUIRE(classify(result.projection.view(), scene.target.indices, options, zones).ok());
    const auto explained = std::count(zones.explainedHoles.begin(), zones.explainedHoles.end(), 1);
    CHECK((explained > 0) == (lock == Lock::exclude));
  }
}
