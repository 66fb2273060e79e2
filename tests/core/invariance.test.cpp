// What must not change the answer: the order of vertices and triangles, the unit, the place, vertices that nothing uses
// or that are there twice, and, of single vertices, how finely the target is divided.

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

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

/// A scene on a grid of 1/1024, so that moving and halving are exact.
Scene onGrid(const Scene& scene) {
  return mappedScene(scene, [](Point p) {
    for (float& x : p) x = std::round(x * 1024) / 1024;
    return p;
  });
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

/// How many vertices are elsewhere on the cage, or have other zones or segments, than those that they were.
/// @param order  For each vertex of the new target, the old one, or none of them.
std::size_t differences(const TransferResult& before, const TransferResult& after,
                        const std::vector<std::uint32_t>& order) {
  std::map<std::uint32_t, std::uint32_t> segmentOf;
  const Projection &now = after.projection, &then = before.projection;
  std::size_t count = 0;
  for (std::size_t v = 0; v < order.size(); ++v) {
    const std::uint32_t old = order[v], s = now.segments[v];
    if (old >= then.segments.size()) continue;
    const bool isSame = after.zones.zones[v] == before.zones.zones[old] && now.triangles[v] == then.triangles[old] &&
                        now.distances[v] == then.distances[old] && now.uvs[2 * v] == then.uvs[2 * old] &&
                        now.uvs[2 * v + 1] == then.uvs[2 * old + 1] &&
                        segmentOf.try_emplace(then.segments[old], s).first->second == s;
    count += !isSame;
  }
  return count;
}

/// How many segments of vertices have other areas or depths than those that they were.
std::size_t otherStats(const TransferResult& before, const TransferResult& after,
                       const std::vector<std::uint32_t>& order) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < order.size(); ++v) {
    const SegmentStats& a = after.projection.segmentStats[after.projection.segments[v]];
    const SegmentStats& b = before.projection.segmentStats[before.projection.segments[order[v]]];
    count += a.area != b.area || a.exposedArea != b.exposedArea || a.coveredArea != b.coveredArea || a.depth != b.depth;
  }
  return count;
}

/// The same triangles, each with corners of its own.
/// @param vertexOrder  Receives, for each new vertex, the old one.
scenes::Mesh torn(const scenes::Mesh& mesh, std::vector<std::uint32_t>& vertexOrder) {
  scenes::Mesh out;
  vertexOrder = mesh.indices;
  for (const std::uint32_t v : mesh.indices)
    out.addVertex(mesh.vertex(v), mesh.uvs[2 * v], mesh.uvs[2 * v + 1], mesh.groups[v]);
  for (std::uint32_t i = 0; i < mesh.indices.size(); i += 3) out.addTriangle(i, i + 1, i + 2);
  return out;
}

/// Each triangle as four, or as three around a place in its inside. New vertices come last.
/// @param segments  Per vertex. New vertices are of other groups than old ones, and those of two segments of different
/// ones: where
///   they lie on others, they must not join segments.
scenes::Mesh divided(const scenes::Mesh& mesh, bool atEdges, const Array<std::uint32_t>& segments) {
  scenes::Mesh out = mesh;
  out.indices.clear();
  // Exact on the grid.
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Point p = mesh.vertex(a);
    for (std::size_t k = 0; k < 3; ++k) p[k] = p[k] / 2 + mesh.vertex(b)[k] / 4 + mesh.vertex(c)[k] / 4;
    return out.addVertex(p, 0, 0, 1000 + segments[a]);
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    if (atEdges) {
      const std::uint32_t ab = add(a, b, b), bc = add(b, c, c), ca = add(c, a, a);
      for (const auto& [x, y, z] : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        out.addTriangle(x, y, z);
      continue;
    }
    const std::uint32_t inside = add(a, b, c);
    for (const auto& [x, y] : {std::array{a, b}, {b, c}, {c, a}}) out.addTriangle(x, y, inside);
  }
  return out;
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
        CHECK(differences(before, after, order) == 0);
        CHECK(otherStats(before, after, order) == 0);
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
    const Scene scene = onGrid(given);
    const Scene moved = mappedScene(scene, [](Point p) { return Point{p[0] + 512, p[1] - 1024, p[2] + 256}; });
    eachPreset([&](const TransferOptions& options) {
      const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view(), options);
      CHECK(otherZones(expected, transferred(moved.cage.view(), moved.target.view(), options)) == 0);
    });
  }
}

TEST_CASE("vertices that are there twice are one, and those that nothing uses are none, to the bit", "[invariance]") {
  for (const Scene& scene : someScenes(firstSeed())) {
    std::vector<std::uint32_t> corners, ofCage, order(scene.target.vertexCount());
    const scenes::Mesh target = torn(scene.target, corners), cage = torn(scene.cage, ofCage);
    Scene more = scene;
    more.cage.addVertex(scene.cage.vertex(0), 0.25f, 0.75f);
    more.cage.addVertex({100, 100, 100});
    more.target.addVertex(scene.target.centroid(0));
    std::iota(order.begin(), order.end(), 0u);
    for (const auto& [name, options] : variants()) {
      INFO(scene.name << ", " << name << ", CAGECAST_SEED=" << firstSeed());
      const TransferResult before = transferred(scene.cage.view(), scene.target.view(), options);
      for (const auto& [after, of] : {std::pair{transferred(scene.cage.view(), target.view(), options), corners},
                                      {transferred(cage.view(), scene.target.view(), options), order},
                                      {transferred(more.cage.view(), more.target.view(), options), order}}) {
        CHECK(differences(before, after, of) == 0);
        CHECK(otherStats(before, after, of) == 0);
        CHECK(copied(after.projection.cornerUvs) == copied(before.projection.cornerUvs));
        CHECK(copied(after.zones.cosmeticTriangles) == copied(before.zones.cosmeticTriangles));
      }
    }
  }
}

TEST_CASE("dividing the target's triangles moves no vertex on the cage, and hides and uncovers none", "[invariance]") {
  // What asks for areas and neighbours goes by what the vertices are: a segment's shares (and so whether it is culled),
  // outer borders and explained holes, and where the recheck spreads. All else is of a point and a surface, which stay.
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 3; ++seed) {
    for (const Scene& given : someScenes(seed)) {
      const Scene scene = onGrid(given);
      for (auto [name, options] : variants()) {
        options.threshold = options.minCovered = 0;
        options.steps.interiorSamples = options.steps.recheck = options.steps.holes = options.steps.floor = false;
        const TransferResult before = transferred(scene.cage.view(), scene.target.view(), options);
        for (const bool atEdges : {true, false}) {
          INFO(scene.name << ", " << name << (atEdges ? ", at edges" : ", inside") << ", CAGECAST_SEED=" << seed);
          const scenes::Mesh target = divided(scene.target, atEdges, before.projection.segments);
          const TransferResult after = transferred(scene.cage.view(), target.view(), options);
          std::vector<std::uint32_t> order(target.vertexCount());
          std::iota(order.begin(), order.end(), 0u);
          CHECK(differences(before, after, order) == 0);
          for (std::size_t s = 0; s < before.projection.segmentStats.size(); ++s)
            CHECK(after.projection.segmentStats[s].area ==
                  Approx(before.projection.segmentStats[s].area).epsilon(1e-6).margin(1e-9));
        }
      }
    }
  }
}
