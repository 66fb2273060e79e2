#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include "checks.hpp"
#include "hash.hpp"
#include "scenes/traps.hpp"

using namespace cagecast;

namespace {

/// The preset without its seams, which have tests of their own.
TransferOptions preset() {
  TransferOptions options = TransferOptions{};
  options.seams = Seams::vertex;
  return options;
}

struct Step {
  const char* name;
  void (*take)(TransferOptions&);
};

/// Each step of the preset, as something to add to `paper`.
constexpr Step kSteps[] = {
    {"occlusion reach", [](TransferOptions& o) { o.occlusionReach = preset().occlusionReach; }},
    {"poke-through", [](TransferOptions& o) { o.pokeThrough = preset().pokeThrough; }},
    {"interior samples", [](TransferOptions& o) { o.steps.interiorSamples = true; }},
    {"interior samples at far loops", [](TransferOptions& o) { o.steps.interiorSamples = o.steps.farLoops = true; }},
    {"the floor of area", [](TransferOptions& o) { o.steps.floor = Floor::area; }},
    {"the floor of depth", [](TransferOptions& o) { o.steps.floor = Floor::depth, o.steps.depthWeighting = true; }},
    {"twins", [](TransferOptions& o) { o.steps.floor = Floor::depth, o.steps.depthWeighting = o.steps.twins = true; }},
    {"hole contents", [](TransferOptions& o) { o.steps.holes = o.steps.holeContents = true; }},
    {"recheck", [](TransferOptions& o) { o.steps.recheck = true; }},
    {"recheck to both sides", [](TransferOptions& o) { o.steps.recheck = o.steps.bothSides = true; }},
    {"recheck by the exposed side", [](TransferOptions& o) { o.steps.recheck = o.steps.exposedSide = true; }},
    {"holes", [](TransferOptions& o) { o.steps.holes = true; }},
    {"partial triangles", [](TransferOptions& o) { o.steps.partialTriangles = true; }},
};

/// The preset, and each of its steps alone.
std::vector<std::pair<std::string, TransferOptions>> variants() {
  std::vector<std::pair<std::string, TransferOptions>> all{{"the preset", preset()}};
  for (const Step& step : kSteps) {
    TransferOptions options = TransferOptions::paper();
    step.take(options);
    all.emplace_back(step.name, options);
  }
  return all;
}

/// A scene in which every step has something to do: a head in a cage that is too small at one side, with panes of two
/// triangles in front of its holes.
scenes::Scene crowdedHead(int cells, float shift) {
  scenes::Scene scene = scenes::head(cells);
  const auto pane = [&](scenes::Point centre, float half) {
    const auto corner = [&](float x, float y) {
      return scenes::Point{centre[0] + half * x, centre[1] + half * y, centre[2]};
    };
    const std::uint32_t group = static_cast<std::uint32_t>(scene.target.vertexCount());
    const std::uint32_t first = scene.target.addVertex(corner(-1, -1), 0, 0, group);
    scene.target.addVertex(corner(1, -1), 0, 0, group);
    scene.target.addVertex(corner(1, 1), 0, 0, group);
    scene.target.addVertex(corner(-1, 1), 0, 0, group);
    scene.target.addTriangle(first, first + 1, first + 2);
    scene.target.addTriangle(first, first + 2, first + 3);
  };
  pane({0.35f, 0.25f, 0.9f}, 0.2f);
  pane({-0.35f, 0.25f, 0.8f}, 0.25f);
  pane({0, -0.4f, 0.9f}, 0.18f);
  scene.cage = mapped(scene.cage, [&](scenes::Point p) { return scenes::Point{p[0] + shift, p[1], p[2] - shift / 2}; });
  scene.name += " crowded";
  return scene;
}

}  // namespace

TEST_CASE("the preset is the reference's on strewn triangles, as a whole and step by step", "[default]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 12; ++seed) {
    const scenes::Scene scene = scenes::strewn(seed, seed % 4 == 0 ? 800 : 60);
    INFO("CAGECAST_SEED=" << seed);
    for (const auto& [name, options] : variants()) {
      INFO(name);
      requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
    }
  }
}

TEST_CASE("any choice of the preset's steps and constants is the reference's on random scenes", "[default]") {
  std::size_t vertices = 0, unstable = 0, bared = 0;
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 400; ++seed) {
    scenes::Random random(seed);
    const auto flip = [&] { return random.below(2) == 0; };
    TransferOptions options = TransferOptions::paper();
    options.threshold =
        random.between(0.01f, 1);  // At 0 without a floor the library does not look where nothing is covered.
    options.seams = flip() ? Seams::corner : Seams::vertex;
    if (flip()) options.weldTolerance = random.between(0, 0.01f);
    if (flip()) options.occlusionReach = random.between(0, 0.1f);
    if (flip()) options.pokeThrough = random.between(0, 0.02f);
    options.steps.interiorSamples = flip();
    options.steps.farLoops = flip();
    options.steps.floor = std::array{Floor::none, Floor::area, Floor::depth}[random.below(3)];
    options.steps.depthWeighting = flip();
    options.minCovered = random.between(0, 1);
    options.steps.minOfAll = random.between(0, 0.05f);
    options.steps.maxUncovered = random.between(0, 1);
    options.steps.twins = flip();
    options.steps.recheck = flip();
    options.steps.bothSides = flip();
    options.steps.exposedSide = flip();
    options.steps.holes = flip();
    options.steps.holeContents = flip();
    options.steps.partialTriangles = flip();
    const int triangles = 10 + static_cast<int>(random.below(50));
    scenes::Scene scene = flip() ? scenes::strewn(seed, triangles) : scenes::gridded(seed, triangles);
    if (flip()) {
      // A copy of every triangle in reverse winding, so that normals cancel out.
      for (std::size_t t = 0, count = scene.target.triangleCount(); t < count; ++t) {
        const std::uint32_t a = scene.target.indices[3 * t], b = scene.target.indices[3 * t + 1],
                            c = scene.target.indices[3 * t + 2];
        scene.target.addTriangle(a, c, b);
      }
    }
    INFO("CAGECAST_SEED=" << seed);
    const auto found = requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
    vertices += found.vertices;
    unstable += found.unstable;
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), options);
    bared += static_cast<std::size_t>(
        std::count(result.zones.culledBy.begin(), result.zones.culledBy.end(), CulledBy::hole));
  }
  INFO(unstable << " of " << vertices << " vertices are unstable");
  CHECK(unstable * 10 <= vertices);
  CHECK(bared > 0);
}

TEST_CASE("the preset is the reference's at any threshold, every triangle a segment of its own", "[default]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 3; ++seed) {
    const scenes::Scene scene = scenes::strewn(seed, 200);
    scenes::Mesh apart;
    for (const std::uint32_t index : scene.target.indices)
      apart.addVertex(scene.target.vertex(index), 0, 0, static_cast<std::uint32_t>(apart.vertexCount() / 3));
    for (std::uint32_t i = 0; i < apart.vertexCount(); i += 3) apart.addTriangle(i, i + 1, i + 2);
    INFO("CAGECAST_SEED=" << seed);
    for (auto& [name, options] : variants()) {
      for (const float threshold : {0.0f, 0.3f, 0.5f, 1.0f}) {
        INFO(name << ", threshold " << threshold);
        options.threshold = threshold;
        // The library looks again only where something is covered, which the floor asks of a segment too.
        if (threshold == 0 && options.steps.recheck && options.steps.floor == Floor::none)
          options.steps.floor = Floor::area;
        requireSameAsReference(scene.name, scene.cage.view(), apart.view(), options);
      }
    }
  }
}

TEST_CASE("the preset is the reference's where everything lies on a grid", "[default]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 8; ++seed) {
    const scenes::Scene scene = scenes::gridded(seed, seed % 2 == 0 ? 60 : 300);
    INFO("CAGECAST_SEED=" << seed);
    for (const auto& [name, options] : variants()) {
      INFO(name);
      requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
    }
    const std::array<int, 4> turn{3, 1, -2, 1};
    requireSameAsReference(scene.name + " rotated", rotated(scene.cage, turn).view(),
                           rotated(scene.target, turn).view(), preset());
  }
}

TEST_CASE("the preset is the reference's on heads, as a whole and step by step", "[default]") {
  for (const float shift : {0.0f, 0.06f, -0.1f}) {
    const scenes::Scene scene = crowdedHead(16, shift);
    for (const auto& [name, options] : variants()) {
      INFO(name << ", shift " << shift);
      const auto found = requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
      CHECK(found.unstable * 50 <= found.vertices);
    }
  }
}

TEST_CASE("the preset is the reference's on models made to be difficult, as a whole and step by step", "[default]") {
  for (const scenes::Trap& trap : scenes::traps()) {
    for (const auto& [name, options] : variants()) {
      INFO(name);
      requireSameAsReference(trap.scene.name, trap.scene.cage.view(), trap.scene.target.view(), options);
    }
    for (const float threshold : {0.3f, 0.8f}) {
      TransferOptions options = preset();
      options.threshold = threshold;
      requireSameAsReference(trap.scene.name, trap.scene.cage.view(), trap.scene.target.view(), options);
    }
  }
}

TEST_CASE("the preset is the reference's on all fixed scenes", "[default]") {
  for (const scenes::Scene& scene : scenes::golden())
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), preset());
}

TEST_CASE("the preset is the reference's far from the origin of coordinates", "[default]") {
  const auto moved = [](scenes::Point p) {
    for (float& x : p) x = std::round(x * 1024) / 1024;
    return scenes::Point{p[0] + 512, p[1] - 1024, p[2] + 256};
  };
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 300), crowdedHead(14, 0.06f)})
    requireSameAsReference(scene.name, mapped(scene.cage, moved).view(), mapped(scene.target, moved).view(), preset());
}

TEST_CASE("the preset is the reference's thousands of diagonals from the origin of coordinates", "[default]") {
  // So far away that a point and the start of its rays above it are often the same in floats.
  for (const float offset : {10000.0f, 100000.0f, 2000000.0f}) {
    const auto moved = [&](scenes::Point p) { return scenes::Point{p[0] + offset, p[1] + offset, p[2] + offset}; };
    for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 30; ++seed) {
      const scenes::Scene scene = scenes::strewn(seed, 60);
      INFO("offset " << offset << ", CAGECAST_SEED=" << seed);
      requireSameAsReference(scene.name, mapped(scene.cage, moved).view(), mapped(scene.target, moved).view(),
                             preset());
    }
  }
}

TEST_CASE("no step of the preset depends on the order of the target's vertices and triangles", "[default]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 4; ++seed) {
    for (const scenes::Scene& scene : {scenes::strewn(seed, 400), crowdedHead(14, 0.06f), scenes::stairs()}) {
      scenes::Random random(seed);
      std::vector<std::uint32_t> order;
      const scenes::Mesh target = scenes::shuffled(scene.target, random, order);
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      for (const auto& [name, options] : variants()) {
        INFO(name);
        const TransferResult before = transferred(scene.cage.view(), scene.target.view(), options);
        const TransferResult after = transferred(scene.cage.view(), target.view(), options);
        std::size_t zones = 0;
        for (std::size_t v = 0; v < order.size(); ++v) zones += after.zones.zones[v] != before.zones.zones[order[v]];
        CHECK(zones == 0);
        std::multiset<std::array<double, 3>> areas[2];
        for (const TransferResult* result : {&before, &after}) {
          for (const SegmentStats& s : result->projection.segmentStats)
            areas[result == &after].insert({s.area, s.exposedArea, s.coveredArea});
        }
        CHECK(areas[0] == areas[1]);
      }
    }
  }
}

TEST_CASE("a new threshold gives the result of a new transfer", "[default]") {
  const scenes::Scene scene = crowdedHead(20, 0.06f);
  TransferOptions options = preset();
  const TransferResult first = transferred(scene.cage.view(), scene.target.view(), options);
  for (const float threshold : {0.0f, 0.2f, 0.9f, 1.0f}) {
    options.threshold = threshold;
    Zones again;
    REQUIRE(classify(first.projection.view(), scene.target.indices, options, again).ok());
    const TransferResult anew = transferred(scene.cage.view(), scene.target.view(), options);
    CHECK(copied(again.zones) == copied(anew.zones.zones));
    CHECK(copied(again.cosmeticTriangles) == copied(anew.zones.cosmeticTriangles));
  }
}

TEST_CASE("a lock overrides the verdict on its segment", "[default]") {
  const scenes::Scene scene = crowdedHead(16, 0);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), preset());
  const std::size_t segments = result.projection.segmentStats.size();
  REQUIRE(segments > 3);
  const auto decided = [&](std::size_t segment, Lock lock) {
    const LockEntry locks[] = {{static_cast<std::uint32_t>(segment), lock}};
    TransferOptions options = preset();
    options.locks.segments = locks;
    Zones zones;
    REQUIRE(classify(result.projection.view(), scene.target.indices, options, zones).ok());
    return zones;
  };
  for (std::size_t s = 0; s < segments; ++s) {
    INFO("segment " << s);
    const Zones kept = decided(s, Lock::keep), excluded = decided(s, Lock::exclude);
    CHECK(kept.culledBy[s] == CulledBy::none);
    CHECK(excluded.culledBy[s] == CulledBy::lock);
    CHECK((result.zones.scores[s] < 1) == (result.zones.culledBy[s] != CulledBy::none));
    CHECK(copied(kept.scores) == copied(result.zones.scores));
    for (std::size_t v = 0; v < scene.target.vertexCount(); ++v) {
      if (result.projection.segments[v] != s) continue;
      if (result.projection.zones[v] == Zone::cosmetic) {
        CHECK(kept.zones[v] == Zone::cosmetic);
        CHECK(excluded.zones[v] == Zone::culled);
      } else {
        CHECK(excluded.zones[v] == result.projection.zones[v]);
      }
    }
  }
}

TEST_CASE("a small part bare under a hole is culled, unless it is kept or another part explains the hole",
          "[default]") {
  const scenes::Trap trap = scenes::aside();
  const TransferResult result = transferred(trap.scene.cage.view(), trap.scene.target.view(), preset());
  REQUIRE(result.projection.segmentStats.size() == 3);
  const auto decided = [&](const TransferOptions& options) {
    Zones zones;
    REQUIRE(classify(result.projection.view(), trap.scene.target.indices, options, zones).ok());
    return zones;
  };
  for (std::size_t eye = 1; eye < 3; ++eye) {
    CHECK(result.projection.segmentStats[eye].coverage() > 0.6);
    CHECK(result.zones.culledBy[eye] == CulledBy::hole);
    CHECK(result.zones.scores[eye] < 1);
    CHECK(result.zones.explainedHoles[result.projection.holeShares[0].hole] == 1);
  }
  CHECK(result.zones.culledBy[0] == CulledBy::none);

  TransferOptions options = preset();
  options.steps.holeContents = false;
  using enum CulledBy;
  CHECK(copied(decided(options).culledBy) == std::vector{none, none, none});
  options.steps.holeContents = true;
  const LockEntry kept[] = {{1, Lock::keep}};
  options.locks.segments = kept;
  CHECK(copied(decided(options).culledBy) == std::vector{none, none, hole});
  const LockEntry excluded[] = {{0, Lock::exclude}};
  options.locks.segments = excluded;  // The skin beside the eyes lies nearest to the loops, too.
  CHECK(copied(decided(options).culledBy) == std::vector{CulledBy::lock, none, hole});
}

TEST_CASE("a point overhangs a small hole by a share of the hole, not of the model", "[default]") {
  // A hole whose loop measures 0.0417 of the diagonal: points in it may be 0.0071 from its edge, not 0.017.
  const scenes::Mesh cage = scenes::without(scenes::box({}, {1, 1, 1}, 20), [](scenes::Point p) {
    return p[0] > 0 && p[0] < 0.1f && p[1] > 0 && p[1] < 0.1f && p[2] > 0.9f;
  });
  scenes::Mesh target = scenes::box({}, {0.98f, 0.98f, 0.98f}, 1);
  const auto addTriangle = [&](float x) {
    const std::uint32_t first = target.addVertex({x, 0.05f, 0.99f});
    target.addVertex({x - 0.02f, 0.04f, 0.99f});
    target.addVertex({x - 0.02f, 0.06f, 0.99f});
    target.addTriangle(first, first + 1, first + 2);
    return first;
  };
  const std::uint32_t atEdge = addTriangle(0.006f), farther = addTriangle(0.012f);
  requireSameAsReference("a small hole", cage.view(), target.view(), preset());
  const TransferResult result = transferred(cage.view(), target.view(), preset());
  const auto recoveryOf = [&](std::uint32_t v) { return result.projection.recovery[v]; };
  CHECK(result.projection.zones[atEdge] == Zone::uncovered);
  CHECK(recoveryOf(atEdge) == Recovery::always);
  CHECK(recoveryOf(farther) >= Recovery::throughHole);
}

TEST_CASE("the preset is the reference's where hundreds of triangles are in one cell of the curve", "[default]") {
  scenes::Mesh target = scenes::box({}, {1, 1, 1}, 4);
  append(target, scenes::ellipsoid({1.5f, 0.5f, 0.3f}, {0.004f, 0.004f, 0.003f}, 9));
  append(target, scenes::box({0, 0, 2}, {0.5f, 0.5f, 0.5f}, 3));
  requireSameAsReference("a crowded cell", scenes::ellipsoid({}, {5, 5, 5}, 5).view(), target.view(), preset());
}

TEST_CASE("two parts of equal shape are twins, be they the largest", "[default]") {
  scenes::Mesh target = scenes::box({}, {0.2f, 0.2f, 0.2f}, 1);
  append(target, scenes::ellipsoid({1, 0, 0}, {0.3f, 0.3f, 0.3f}, 4));
  append(target, scenes::ellipsoid({-1, 0, 0}, {0.3f, 0.3f, 0.3f}, 4));
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  const TransferResult result = transferred(cage.view(), target.view(), preset());
  REQUIRE(result.projection.segmentStats.size() == 3);
  CHECK(result.projection.segmentStats[0].twinOf == 0);
  CHECK(result.projection.segmentStats[1].twinOf == 1);
  CHECK(result.projection.segmentStats[2].twinOf == 1);
}

TEST_CASE("twins are found over seven kinds of other shape, not over eight", "[default]") {
  const scenes::Mesh cage = scenes::box({}, {20, 20, 20}, 1);
  for (const int others : {7, 8}) {
    // Sheets of nearly equal area, each a little larger than the one before, and longer; the last is like the first.
    scenes::Mesh target;
    for (int i = 0; i <= others + 1; ++i) {
      const float length = i > others ? 1.0f : 1 + 0.2f * static_cast<float>(i);
      const float width = (1 + 1e-4f * static_cast<float>(i)) / length, z = static_cast<float>(i);
      const std::uint32_t a = target.addVertex({0, 0, z}), b = target.addVertex({length, 0, z});
      const std::uint32_t c = target.addVertex({length, width, z}), d = target.addVertex({0, width, z});
      target.addTriangle(a, b, c), target.addTriangle(a, c, d);
    }
    const TransferResult result = transferred(cage.view(), target.view(), preset());
    const auto last = static_cast<std::uint32_t>(others + 1);
    INFO(others << " kinds between");
    CHECK(result.projection.segmentStats[last].twinOf == (others == 7 ? 0 : last));
  }
}

TEST_CASE("a corner behind something small is seen past it, be it the only one", "[default]") {
  scenes::Mesh target;
  const auto addTriangle = [&](scenes::Point at, float size) {
    const std::uint32_t first = target.addVertex({at[0] - size, at[1] - size, at[2]});
    target.addVertex({at[0] + size, at[1] - size, at[2]});
    target.addVertex({at[0], at[1] + size, at[2]});
    target.addTriangle(first, first + 1, first + 2);
  };
  addTriangle({0, 0, 1.5f}, 1);
  addTriangle({-1, -1, 1.6f}, 0.04f);
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  requireSameAsReference("something small", cage.view(), target.view(), preset());
  const TransferResult result = transferred(cage.view(), target.view(), preset());
  CHECK(result.projection.zones[0] == Zone::occluded);
  CHECK(result.zones.zones[0] == Zone::cosmetic);
}

TEST_CASE("the preset is the reference's in a cage that is a thousand times as large", "[default]") {
  scenes::Mesh target = scenes::box({}, {1, 1, 1}, 4);
  append(target, scenes::ellipsoid({3, 1, 0}, {0.5f, 1, 0.5f}, 4));
  const scenes::Mesh cage = scenes::ellipsoid({100, 0, 0}, {4000, 3000, 3000}, 6);
  requireSameAsReference("a large cage", cage.view(), target.view(), preset());
}

TEST_CASE("an excluded segment explains the hole it lies under, a kept one does not", "[default]") {
  const scenes::Scene scene = crowdedHead(16, 0);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), preset());
  const auto recovered = [&](Lock lock) {
    // All but the skin, which has most points, are locked.
    std::vector<LockEntry> locks;
    std::uint32_t skin = 0;
    for (std::uint32_t s = 0; s < result.projection.segmentStats.size(); ++s) {
      locks.push_back({s, lock});
      if (result.projection.segmentStats[s].points > result.projection.segmentStats[skin].points) skin = s;
    }
    locks[skin].lock = Lock::keep;
    TransferOptions options = preset();
    options.locks.segments = locks;
    Zones zones;
    REQUIRE(classify(result.projection.view(), scene.target.indices, options, zones).ok());
    std::size_t explained = 0;
    for (const std::uint8_t hole : zones.explainedHoles) explained += hole;
    return explained;
  };
  CHECK(recovered(Lock::exclude) > 0);
  CHECK(recovered(Lock::keep) == 0);
}

TEST_CASE("a segment knows the group of its first vertex", "[default]") {
  const scenes::Scene scene = scenes::head(10);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  for (std::size_t v = scene.target.vertexCount(); v-- > 0;) {
    const std::uint32_t s = result.projection.segments[v];
    if (std::find(result.projection.segments.begin(), result.projection.segments.begin() + v, s) ==
        result.projection.segments.begin() + v)
      CHECK(result.projection.segmentStats[s].group == scene.target.groups[v]);
  }
}

// As for `paper`: the same file is asserted in every build.
TEST_CASE("the preset's answer on fixed scenes has the golden hash", "[default][golden]") {
  Hash hash;
  for (const scenes::Scene& scene : scenes::golden())
    hash.add(transferred(scene.cage.view(), scene.target.view(), preset()));
  for (const float shift : {0.0f, 0.06f, -0.1f}) {
    const scenes::Scene scene = crowdedHead(18, shift);
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), preset());
    hash.add(result);
    hash.add(result.zones.cosmeticTriangles);
    hash.add(result.projection.recovery);
  }
  std::ifstream file(CAGECAST_GOLDEN_DEFAULT);
  std::string expected;
  file >> expected;
  CHECK(hash.text() == expected);
}
