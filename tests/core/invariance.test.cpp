#include <algorithm>
#include <cmath>

#include "checks.hpp"

using namespace cagecast;

TEST_CASE("the order of the target's vertices and triangles does not matter", "[invariance]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    for (const scenes::Scene& scene : {scenes::strewn(seed, 400), scenes::head(14), scenes::stairs()}) {
      scenes::Random random(seed);
      std::vector<std::uint32_t> order;
      const scenes::Mesh target = scenes::shuffled(scene.target, random, order);
      const TransferResult before = transferred(scene.cage.view(), scene.target.view());
      const TransferResult after = transferred(scene.cage.view(), target.view());
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      std::size_t zones = 0, triangles = 0, uvs = 0, distances = 0, segments = 0;
      std::vector<std::uint32_t> segmentOf(before.projection.segmentStats.size(), UINT32_MAX);
      for (std::size_t v = 0; v < order.size(); ++v) {
        const std::uint32_t old = order[v];
        zones += after.zones.zones[v] != before.zones.zones[old];
        triangles += after.projection.triangles[v] != before.projection.triangles[old];
        distances += after.projection.distances[v] != before.projection.distances[old];
        for (std::size_t k = 0; k < 2; ++k)
          uvs += after.projection.uvs[v * 2 + k] != before.projection.uvs[old * 2 + k];
        std::uint32_t& renamed = segmentOf[before.projection.segments[old]];
        if (renamed == UINT32_MAX) renamed = after.projection.segments[v];
        segments += renamed != after.projection.segments[v];
      }
      CHECK(zones == 0);
      CHECK(triangles == 0);
      CHECK(uvs == 0);
      CHECK(distances == 0);
      CHECK(segments == 0);
    }
  }
}

TEST_CASE("the order of the cage's vertices and triangles does not matter", "[invariance]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    for (const scenes::Scene& scene : {scenes::strewn(seed, 400), scenes::head(14)}) {
      scenes::Random random(seed);
      std::vector<std::uint32_t> order;
      const scenes::Mesh cage = scenes::shuffled(scene.cage, random, order);
      const TransferResult before = transferred(scene.cage.view(), scene.target.view());
      const TransferResult after = transferred(cage.view(), scene.target.view());
      // Where two triangles are equally near and their planes equally far, the lower index decides: that may change.
      const reference::Result expected = reference::transfer(cage.view(), scene.target.view());
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      CHECK(compare(expected, after, scene.target.view()).total() == 0);
      std::size_t zones = 0;
      for (std::size_t v = 0; v < scene.target.vertexCount(); ++v)
        zones += expected.stable[v] != 0 && after.zones.zones[v] != before.zones.zones[v];
      CHECK(zones == 0);
    }
  }
}

TEST_CASE("another unit changes nothing: not a bit by a power of two", "[invariance]") {
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 400), scenes::head(14), scenes::stairs()}) {
    const TransferResult before = transferred(scene.cage.view(), scene.target.view());
    for (const float factor : {0x1p-40f, 0.125f, 2.0f, 0x1p30f}) {
      const auto scale = [&](scenes::Point p) { return scenes::Point{p[0] * factor, p[1] * factor, p[2] * factor}; };
      const TransferResult after = transferred(mapped(scene.cage, scale).view(), mapped(scene.target, scale).view());
      INFO(scene.name << " times " << factor);
      CHECK(copied(after.zones.zones) == copied(before.zones.zones));
      CHECK(copied(after.projection.uvs) == copied(before.projection.uvs));
      CHECK(copied(after.projection.triangles) == copied(before.projection.triangles));
      CHECK(copied(after.projection.segments) == copied(before.projection.segments));
      std::vector<float> distances = copied(before.projection.distances);
      for (float& distance : distances) distance *= factor;
      CHECK(copied(after.projection.distances) == distances);
    }
  }
}

TEST_CASE("another unit changes no firm zone by any factor", "[invariance]") {
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 400), scenes::head(14)}) {
    const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view());
    for (const float factor : {1e-3f, 0.0254f, 3.0f, 1e5f}) {
      const auto scale = [&](scenes::Point p) { return scenes::Point{p[0] * factor, p[1] * factor, p[2] * factor}; };
      const scenes::Mesh cage = mapped(scene.cage, scale), target = mapped(scene.target, scale);
      INFO(scene.name << " times " << factor);
      requireSameAsReference(scene.name, cage.view(), target.view());
      const TransferResult after = transferred(cage.view(), target.view());
      std::size_t zones = 0;
      for (std::size_t v = 0; v < target.vertexCount(); ++v)
        zones += expected.stable[v] != 0 && after.zones.zones[v] != expected.zones[v];
      CHECK(zones == 0);
    }
  }
}

TEST_CASE("moving cage and target together changes no firm zone", "[invariance]") {
  // On a grid of 1/1024, so that moving is exact.
  const auto onGrid = [](scenes::Point p) {
    for (float& x : p) x = std::round(x * 1024) / 1024;
    return p;
  };
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 400), scenes::head(14)}) {
    const scenes::Mesh cage = mapped(scene.cage, onGrid), target = mapped(scene.target, onGrid);
    const reference::Result expected = reference::transfer(cage.view(), target.view());
    const auto move = [](scenes::Point p) { return scenes::Point{p[0] + 512, p[1] - 1024, p[2] + 256}; };
    const scenes::Mesh movedCage = mapped(cage, move), movedTarget = mapped(target, move);
    const reference::Differences found =
        compare(expected, transferred(movedCage.view(), movedTarget.view()), target.view());
    INFO(scene.name << '\n' << found.details);
    CHECK(found.zones == 0);
    CHECK(found.triangles == 0);
    CHECK(found.segments == 0);
    requireSameAsReference(scene.name + " moved", movedCage.view(), movedTarget.view());
  }
}

TEST_CASE("the same call gives the same bits again, whatever was called in between", "[invariance]") {
  const scenes::Scene large = scenes::head(20), small = scenes::strewn(firstSeed(), 50);
  const TransferResult first = transferred(small.cage.view(), small.target.view());
  (void)transferred(large.cage.view(), large.target.view());
  const TransferResult second = transferred(small.cage.view(), small.target.view());
  testWorkspace().release();
  const TransferResult third = transferred(small.cage.view(), small.target.view());
  for (const TransferResult* again : {&second, &third}) {
    CHECK(copied(again->zones.zones) == copied(first.zones.zones));
    CHECK(copied(again->projection.uvs) == copied(first.projection.uvs));
    CHECK(copied(again->projection.distances) == copied(first.projection.distances));
    CHECK(copied(again->projection.triangles) == copied(first.projection.triangles));
    CHECK(copied(again->projection.segments) == copied(first.projection.segments));
  }
}
