// What must not change the answer: the order of vertices and triangles, the unit, the place, and earlier calls.

#include <cmath>
#include <functional>
#include <map>

#include "checks.hpp"
#include "variants.hpp"

using namespace cagecast;
using scenes::Point;
using scenes::Scene;

namespace {

std::vector<Scene> someScenes(std::uint64_t seed) {
  return {scenes::strewn(seed, 300), scenes::crowdedHead(12, 0.06f), scenes::stairs()};
}

/// Calls for each preset.
template <typename Call>
void eachPreset(Call call) {
  for (const TransferOptions& options : {TransferOptions::paper(), TransferOptions{}}) call(options);
}

Scene mappedScene(const Scene& scene, const std::function<Point(Point)>& map) {
  return {scene.name, mapped(scene.cage, map), mapped(scene.target, map)};
}

std::function<Point(Point)> times(float factor) {
  return [factor](Point p) { return Point{p[0] * factor, p[1] * factor, p[2] * factor}; };
}

/// How many vertices have another zone than the reference's, where that is firm.
std::size_t otherZones(const reference::Result& expected, const TransferResult& result) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < expected.zones.size(); ++v)
    count += expected.stable[v] != 0 && result.zones.zones[v] != expected.zones[v];
  return count;
}

}  // namespace

TEST_CASE("the order of the target's vertices and triangles does not matter, to the bit", "[invariance]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 3; ++seed) {
    for (const Scene& scene : someScenes(seed)) {
      scenes::Random random(seed);
      std::vector<std::uint32_t> order;
      const scenes::Mesh target = scenes::shuffled(scene.target, random, order);
      for (const auto& [name, options] : variants()) {
        INFO(scene.name << ", " << name << ", CAGECAST_SEED=" << seed);
        const TransferResult before = transferred(scene.cage.view(), scene.target.view(), options);
        const TransferResult after = transferred(scene.cage.view(), target.view(), options);
        std::map<std::uint32_t, std::uint32_t> segmentOf;
        std::size_t differences = 0;
        for (std::size_t v = 0; v < order.size(); ++v) {
          const Projection &now = after.projection, &then = before.projection;
          const std::uint32_t old = order[v];
          const std::uint32_t s = now.segments[v];
          const bool isSame = after.zones.zones[v] == before.zones.zones[old] &&
                              now.triangles[v] == then.triangles[old] && now.distances[v] == then.distances[old] &&
                              now.uvs[2 * v] == then.uvs[2 * old] && now.uvs[2 * v + 1] == then.uvs[2 * old + 1] &&
                              segmentOf.try_emplace(then.segments[old], s).first->second == s;
          differences += !isSame;
          const SegmentStats &a = now.segmentStats[s], &b = then.segmentStats[then.segments[old]];
          differences += a.area != b.area || a.exposedArea != b.exposedArea || a.coveredArea != b.coveredArea ||
                         a.depth != b.depth;
        }
        CHECK(differences == 0);
      }
    }
  }
}

TEST_CASE("the order of the cage's vertices and triangles changes no firm zone", "[invariance]") {
  // Where two triangles are equally near and their planes equally far, the lower index decides: that may change.
  for (const Scene& scene : someScenes(firstSeed())) {
    scenes::Random random(firstSeed());
    std::vector<std::uint32_t> order;
    const scenes::Mesh cage = scenes::shuffled(scene.cage, random, order);
    eachPreset([&](const TransferOptions& options) {
      INFO(scene.name << ", CAGECAST_SEED=" << firstSeed());
      requireSameAsReference(scene.name, cage.view(), scene.target.view(), options);
      const reference::Result expected = reference::transfer(cage.view(), scene.target.view(), options);
      CHECK(otherZones(expected, transferred(scene.cage.view(), scene.target.view(), options)) == 0);
    });
  }
}

TEST_CASE("another unit changes not a bit by a power of two, and no firm zone by any factor", "[invariance]") {
  for (const Scene& scene : someScenes(firstSeed())) {
    eachPreset([&](const TransferOptions& options) {
      const TransferResult before = transferred(scene.cage.view(), scene.target.view(), options);
      const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view(), options);
      for (const float factor : {0x1p-40f, 0.125f, 0x1p30f, 1e-3f, 0.0254f, 1e5f}) {
        const Scene scaled = mappedScene(scene, times(factor));
        const TransferResult after = transferred(scaled.cage.view(), scaled.target.view(), options);
        INFO(scene.name << " times " << factor << ", CAGECAST_SEED=" << firstSeed());
        int exponent = 0;
        if (std::frexp(factor, &exponent) != 0.5f) {
          CHECK(otherZones(expected, after) == 0);
          continue;
        }
        CHECK(copied(after.zones.zones) == copied(before.zones.zones));
        CHECK(copied(after.projection.uvs) == copied(before.projection.uvs));
        CHECK(copied(after.projection.cornerUvs) == copied(before.projection.cornerUvs));
        CHECK(copied(after.projection.triangles) == copied(before.projection.triangles));
        CHECK(copied(after.projection.segments) == copied(before.projection.segments));
        std::vector<float> distances = copied(before.projection.distances);
        for (float& distance : distances) distance *= factor;
        CHECK(copied(after.projection.distances) == distances);
      }
    });
  }
}

TEST_CASE("moving cage and target together changes no firm zone", "[invariance]") {
  for (const Scene& given : someScenes(firstSeed())) {
    // On a grid of 1/1024, so that moving is exact.
    const Scene scene = mappedScene(given, [](Point p) {
      for (float& x : p) x = std::round(x * 1024) / 1024;
      return p;
    });
    const Scene moved = mappedScene(scene, [](Point p) { return Point{p[0] + 512, p[1] - 1024, p[2] + 256}; });
    eachPreset([&](const TransferOptions& options) {
      const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view(), options);
      CHECK(otherZones(expected, transferred(moved.cage.view(), moved.target.view(), options)) == 0);
    });
  }
}
