// Step 10: what lies beyond an outer border of the cage.

#include <algorithm>
#include <cmath>

#include "cagecast/clip.hpp"
#include "checks.hpp"

using namespace cagecast;
using scenes::append;
using scenes::box;
using scenes::Mesh;
using scenes::Point;

namespace {

constexpr float kNeck = 0.9f;  // Where the cage ends.

/// A head with a body of one piece with it, as wide as its neck is long below the cage.
/// @param length  Of what lies below the cage.
Mesh figure(float length) {
  return scenes::mapped(box({}, {1, 1, 2}, 14), [=](Point p) {
    if (p[2] > 1) return Point{p[0], p[1], p[2]};
    const float down = (1 - p[2]) / 3;  // 0 at the head, 1 at the feet.
    const float width = down < 0.3f || length < 1 ? 0.5f : 1.5f;
    return Point{width * p[0], width * p[1], 1 - down * (length + 1 - kNeck)};
  });
}

Mesh headCage() {
  const Mesh closed = scenes::mapped(box({0, 0, 1.5f}, {1.05f, 1.05f, 0.6f}, 8), [](Point p) {
    return p[2] < 0.95f ? Point{0.55f * p[0], 0.55f * p[1], kNeck} : p;
  });
  return scenes::without(closed, [](Point p) { return p[2] < kNeck + 0.001f; });
}

}  // namespace

TEST_CASE("what lies beyond an outer border is not painted, and counts for nothing", "[region]") {
  const Mesh cage = headCage();
  for (const float length : {0.3f, 3.0f, 8.0f}) {
    Mesh target = figure(length);
    const std::size_t skin = target.vertexCount();
    if (length > 1) append(target, box({0, 0, 0.5f - length}, {1.6f, 1.6f, 0.4f}, 6));  // Shoes.
    const TransferResult result = transferred(cage.view(), target.view(), {});
    const SegmentStats& stats = result.projection.segmentStats[0];
    INFO(length << ": beyond " << stats.beyondArea << " of " << stats.area);
    CHECK((stats.beyondArea > 0) == (length > 1));
    CHECK_FALSE(stats.culled());
    for (std::size_t v = 0; v < target.vertexCount(); ++v) {
      const Zone zone = result.zones.zones[v];
      const float z = target.vertex(v)[2];
      if (v < skin && z > 1) CHECK(zone == Zone::cosmetic);
      if (z < 0.7f) CHECK(zone != Zone::cosmetic);
    }
    requireSameAsReference("a figure", cage.view(), target.view(), {});

    CutTarget cut;
    const DecidedTarget decided{target.view(), result.zones.zones, result.projection.segments, result.zones.culledBy};
    REQUIRE(cutBorders(cage.view(), decided, {}, testWorkspace(), cut).ok());
    for (std::size_t v = 0; v < skin; ++v) {
      if (target.vertex(v)[2] < 0.7f) CHECK(cut.zones[v] != Zone::cosmetic);
    }
  }
  TransferOptions options;
  options.steps.holes = false;
  const Mesh target = figure(8);
  CHECK(transferred(cage.view(), target.view(), options).projection.segmentStats[0].beyondArea == 0);
}

TEST_CASE("a hand beside the face lies beyond the neck that joins it to the head, and so does its glove", "[region]") {
  // An arm that leaves the body and rises beside the head: its closest points are on no loop.
  Mesh target = figure(3);
  const std::uint32_t first = static_cast<std::uint32_t>(target.vertexCount());
  std::uint32_t shoulder[2] = {};
  for (std::uint32_t v = 0; v < first; ++v) {
    const Point p = target.vertex(v);
    if (p[0] > 1.4f && p[2] > -1.5f && p[2] < 0) shoulder[p[1] > 0] = v;
  }
  for (int step = 0; step <= 10; ++step) {
    const float z = -1 + 0.3f * static_cast<float>(step);
    for (const float y : {-0.2f, 0.2f}) target.addVertex({1.5f, y, z});
  }
  for (std::uint32_t v = first; v + 3 < target.vertexCount(); v += 2) {
    target.addTriangle(v, v + 1, v + 2);
    target.addTriangle(v + 1, v + 3, v + 2);
  }
  target.addTriangle(shoulder[0], shoulder[1], first);
  append(target, box({1.6f, 0, 1.9f}, {0.1f, 0.3f, 0.2f}, 3));  // A glove.
  const Mesh cage = headCage();
  const Projection projection = transferred(cage.view(), target.view(), {}).projection;
  for (std::size_t v = first; v < target.vertexCount(); ++v) CHECK(projection.visibility[v] == Visibility::beyond);
  requireSameAsReference("a figure with an arm", cage.view(), target.view(), {});
}

TEST_CASE("an eye that bulges out of its hole by half lies at a hole, not beyond a border", "[region]") {
  const Mesh cage = scenes::without(
      box({}, {1, 1, 1}, 8), [](Point p) { return p[2] > 0.99f && std::abs(p[0]) < 0.25f && std::abs(p[1]) < 0.25f; });
  for (const bool isFused : {false, true}) {
    Mesh target = box({}, {0.97f, 0.97f, 0.97f}, 40);
    if (isFused) {
      target = scenes::mapped(target, [](Point p) {
        const float square = 0.0625f - p[0] * p[0] - p[1] * p[1];
        return p[2] > 0.9f && square > 0 ? Point{p[0], p[1], p[2] + 4 * square} : p;
      });
    } else {
      append(target, scenes::ellipsoid({0, 0, 1}, {0.25f, 0.25f, 0.25f}, 10));
    }
    const TransferResult result = transferred(cage.view(), target.view(), {});
    for (const SegmentStats& stats : result.projection.segmentStats) CHECK(stats.beyondArea == 0);
    requireSameAsReference("an eye", cage.view(), target.view(), {});
  }
}
