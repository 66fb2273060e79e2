#include <algorithm>

#include "checks.hpp"

using namespace cagecast;

// The yardstick is measured first: that it says where it is unsure, nowhere else, and that a comparison finds differences.

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
  add(scene.target, {aside, -5, 1}, {5, 0, 1}, {aside, 5, 1});  // One unit above.
  return scene;
}

}  // namespace

TEST_CASE("a vertex whose ray passes an edge by less than a nudge is unstable, by more it is not", "[reference]") {
  const auto stableAt = [](float aside) {
    const scenes::Scene scene = nearEdge(aside);
    return reference::transfer(scene.cage.view(), scene.target.view()).stable;
  };
  CHECK(stableAt(5e-5f) == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 1});
  CHECK(stableAt(-5e-5f) == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 1});
  CHECK(stableAt(2e-4f) == std::vector<std::uint8_t>(6, 1));
  CHECK(stableAt(-2e-4f) == std::vector<std::uint8_t>(6, 1));
}

TEST_CASE("if a segment's verdict hangs on an unstable vertex, its cosmetic vertices are unstable too", "[reference]") {
  scenes::Scene scene = nearEdge(5e-5f);  // The first corner may be occluded or not.
  scene.target.positions[5] = 2.5f;       // The second is outside the cage: uncovered. The third is covered.
  TransferOptions options;
  const auto stableWith = [&](float threshold) {
    options.threshold = threshold;
    const auto stable = reference::transfer(scene.cage.view(), scene.target.view(), options).stable;
    return std::vector<int>(stable.begin(), stable.begin() + 3);
  };
  REQUIRE(reference::transfer(scene.cage.view(), scene.target.view()).zones[1] == Zone::uncovered);
  // Two of three corners are covered, or one of two.
  CHECK(stableWith(0.4f) == std::vector<int>{0, 1, 1});
  CHECK(stableWith(0.6f) == std::vector<int>{0, 1, 0});
  CHECK(stableWith(0.7f) == std::vector<int>{0, 1, 1});
}

TEST_CASE("a comparison finds every kind of difference", "[reference]") {
  const scenes::Scene scene = scenes::head(10);
  const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view());
  TransferResult answer = transferred(scene.cage.view(), scene.target.view());
  const auto differences = [&] { return compare(expected, answer, scene.target.view()); };
  REQUIRE(differences().total() == 0);
  const auto vertex = static_cast<std::size_t>(std::find(expected.stable.begin(), expected.stable.end(), 1) - expected.stable.begin());
  Zone& zone = answer.zones.zones[vertex];
  zone = zone == Zone::cosmetic ? Zone::occluded : Zone::cosmetic;
  CHECK(differences().zones == 1);
  answer.projection.uvs[vertex * 2 + 1] += 2e-5f;
  CHECK(differences().uvs == 1);
  answer.projection.distances[vertex] += 1e-4f;
  CHECK(differences().distances == 1);
  ++answer.projection.segments[vertex];
  CHECK(differences().segments == 1);
  answer.projection.segmentStats[0].coveredArea *= 1.001;
  CHECK(differences().stats == 1);
  ++answer.projection.triangles[vertex];
  CHECK(differences().triangles == 1);
  CHECK_THAT(differences().details, Catch::Matchers::Contains("zone") && Catch::Matchers::Contains("cage triangle"));
}
