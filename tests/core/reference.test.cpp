// The yardstick: that it says where it is unsure, nowhere else, and that a comparison finds differences.

#include <algorithm>

#include "checks.hpp"

using namespace cagecast;

namespace {

/// A small triangle under a large level cage, with a shade over it whose edge is `aside` from the first corner's ray.
scenes::Scene nearEdge(float aside) {
  scenes::Scene scene;
  const auto add = [](scenes::Mesh& mesh, scenes::Point a, scenes::Point b, scenes::Point c) {
    const std::uint32_t first = mesh.addVertex(a, 0, 0);
    mesh.addVertex(b, 1, 0);
    mesh.addVertex(c, 0, 1);
    mesh.addTriangle(first, first + 1, first + 2);
  };
  add(scene.cage, {-90, -90, 2}, {90, -90, 2}, {0, 90, 2});
  add(scene.target, {0, 0, 0}, {-1, 0.1f, 0}, {-1, -0.1f, 0});
  add(scene.target, {aside, -5, 1}, {5, 0, 1}, {aside, 5, 1});
  return scene;
}

}  // namespace

TEST_CASE("a vertex whose ray passes an edge by less than a nudge is unstable, by more it is not", "[reference]") {
  for (const float aside : {5e-5f, -5e-5f, 2e-4f, -2e-4f}) {
    const scenes::Scene scene = nearEdge(aside);
    const std::uint8_t isFirm = std::abs(aside) > 1e-4f;
    CHECK(reference::transfer(scene.cage.view(), scene.target.view()).stable ==
          std::vector<std::uint8_t>{isFirm, 1, 1, 1, 1, 1});
  }
}

TEST_CASE("if a segment's verdict hangs on an unstable vertex, its cosmetic vertices are unstable too", "[reference]") {
  scenes::Scene scene = nearEdge(5e-5f);  // The first corner may be occluded or not.
  scene.target.positions[5] = 2.5f;       // The second is outside the cage: uncovered. The third is covered.
  const auto stableWith = [&](float threshold) {
    TransferOptions options = TransferOptions::paper();
    options.threshold = threshold;
    const auto stable = reference::transfer(scene.cage.view(), scene.target.view(), options).stable;
    return std::vector<int>(stable.begin(), stable.begin() + 3);
  };
  // Two of three corners are covered, or one of two.
  CHECK(stableWith(0.4f) == std::vector<int>{0, 1, 1});
  CHECK(stableWith(0.6f) == std::vector<int>{0, 1, 0});
  CHECK(stableWith(0.7f) == std::vector<int>{0, 1, 1});
}

TEST_CASE("a comparison finds every kind of difference", "[reference]") {
  const scenes::Scene scene{"balls", scenes::ellipsoid({}, {1.2f, 1.1f, 1.3f}, 5),
                            scenes::ellipsoid({0.02f, 0.03f, -0.01f}, {1, 0.9f, 1}, 6)};
  const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view(), TransferOptions{});
  const auto found = [&](auto change) {
    TransferResult answer = transferred(scene.cage.view(), scene.target.view(), {});
    change(answer);
    return compare(expected, answer, scene.target.view());
  };
  REQUIRE(found([](TransferResult&) {}).total() == 0);
  const auto v =
      static_cast<std::size_t>(std::find(expected.stable.begin(), expected.stable.end(), 1) - expected.stable.begin());
  CHECK(found([&](auto& of) {
          of.zones.zones[v] = of.zones.zones[v] == Zone::occluded ? Zone::cosmetic : Zone::occluded;
        }).zones == 1);
  CHECK(found([&](auto& of) { of.projection.uvs[2 * v + 1] += 2e-5f; }).uvs == 1);
  CHECK(found([&](auto& of) { of.projection.distances[v] += 1e-4f; }).distances == 1);
  CHECK(found([&](auto& of) { ++of.projection.segments[v]; }).segments == 1);
  CHECK(found([&](auto& of) { ++of.projection.triangles[v]; }).triangles == 1);
  CHECK(found([&](auto& of) { of.projection.cornerUvs[0] += 1e-4f; }).corners == 1);
  CHECK(found([&](auto& of) { of.zones.cosmeticTriangles[0] ^= 1; }).painted == 1);
  for (double SegmentStats::*field :
       {&SegmentStats::area, &SegmentStats::exposedArea, &SegmentStats::coveredArea, &SegmentStats::depth})
    CHECK(found([&](auto& of) { of.projection.segmentStats[0].*field *= 1.001; }).stats == 1);
  for (double Ratios::*ratio : {&Ratios::threshold, &Ratios::floor, &Ratios::depth, &Ratios::hole})
    CHECK(found([&](auto& of) { of.projection.segmentStats[0].ratios.*ratio = 0.999; }).stats == 1);
  CHECK_THAT(found([&](auto& of) { ++of.projection.triangles[v]; }).details,
             Catch::Matchers::Contains("cage triangle"));
}
