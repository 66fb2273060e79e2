#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "checks.hpp"
#include "scenes/traps.hpp"

using namespace cagecast;

// The yardstick is measured first: that it says where it is unsure, nowhere else, and that a comparison finds
// differences.

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

using reference::Options;

/// A level triangle at a height, under a large level cage two units up (or over it).
scenes::Scene levelAt(float height) {
  scenes::Scene scene = nearEdge(9);
  for (std::size_t v = 0; v < 3; ++v) scene.target.positions[v * 3 + 2] = height;
  return scene;
}

std::vector<Zone> zonesOf(const scenes::Scene& scene, const Options& options) {
  return reference::transfer(scene.cage.view(), scene.target.view(), options).zones;
}

/// How well a trap is met, as shares of the area of what is to be left bare, and of what is to be painted.
struct Score {
  double suppressed = 0, kept = 0;
};

Score scoreOf(const scenes::Trap& trap, const std::vector<Zone>& zones) {
  using Corner = std::array<double, 3>;
  std::map<scenes::Wanted, double> all, right;
  const auto& target = trap.scene.target;
  for (std::size_t t = 0; t < target.indices.size(); t += 3) {
    std::array<Corner, 3> p{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k)
        p[c][k] = static_cast<double>(target.positions[target.indices[t + c] * 3 + k]);
    const auto edge = [&](std::size_t c, std::size_t k) { return p[c][k] - p[0][k]; };
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const double n = edge(1, i) * edge(2, j) - edge(1, j) * edge(2, i);
      square += n * n;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = target.indices[t + c];
      all[trap.truth[v]] += std::sqrt(square);
      if ((zones[v] == Zone::cosmetic) == (trap.truth[v] == scenes::Wanted::painted))
        right[trap.truth[v]] += std::sqrt(square);
    }
  }
  const auto share = [&](scenes::Wanted wanted) { return all[wanted] > 0 ? right[wanted] / all[wanted] : 1; };
  return {share(scenes::Wanted::bare), share(scenes::Wanted::painted)};
}

/// The groups that are painted anywhere.
std::set<std::uint32_t> paintedGroups(const scenes::Trap& trap, const std::vector<Zone>& zones) {
  std::set<std::uint32_t> groups;
  for (std::size_t v = 0; v < zones.size(); ++v)
    if (zones[v] == Zone::cosmetic) groups.insert(trap.scene.target.groups[v]);
  return groups;
}

std::size_t unlikeTwins(const scenes::Trap& trap, const std::vector<Zone>& zones) {
  const auto painted = paintedGroups(trap, zones);
  std::size_t count = 0;
  for (std::size_t i = 0; i < trap.twins.size(); i += 2)
    if (painted.contains(trap.twins[i]) != painted.contains(trap.twins[i + 1])) ++count;
  return count;
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
  TransferOptions options = TransferOptions::paper();
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
  const auto vertex =
      static_cast<std::size_t>(std::find(expected.stable.begin(), expected.stable.end(), 1) - expected.stable.begin());
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

TEST_CASE("a surface beyond the cage hides a point only within occlusionReach", "[reference]") {
  // The shade is moved over the first triangle; the diagonal of it all is about 12 units, the reach about 0.36.
  const auto zoneUnder = [](float height, bool ends) {
    scenes::Scene scene = nearEdge(-1);
    for (std::size_t v = 3; v < 6; ++v) scene.target.positions[v * 3 + 2] = height;
    Options options;
    options.endOfSelfRay = ends;
    return zonesOf(scene, options)[0];
  };
  CHECK(zoneUnder(2.2f, true) == Zone::occluded);
  CHECK(zoneUnder(3.0f, true) == Zone::cosmetic);
  CHECK(zoneUnder(3.0f, false) == Zone::occluded);
}

TEST_CASE("a point that pokes through the cage by very little is covered", "[reference]") {
  Options options;
  options.pokes = true;  // By up to 0.03 units here.
  CHECK(zonesOf(levelAt(2.02f), options)[0] == Zone::cosmetic);
  CHECK(zonesOf(levelAt(2.2f), options)[0] == Zone::uncovered);
  CHECK(zonesOf(levelAt(2.02f), Options::paper())[0] == Zone::uncovered);
}

TEST_CASE("a window of two triangles is judged inside, not at its frame", "[reference]") {
  scenes::Scene scene;
  scene.cage = without(scenes::box({}, {6, 6, 1}, 12),
                       [](scenes::Point p) { return p[2] > 0.9f && std::abs(p[0]) < 2 && std::abs(p[1]) < 2; });
  append(scene.target, scenes::box({}, {5.8f, 5.8f, 0.8f}, 6));
  scenes::Mesh window;
  for (const auto& [x, y] : {std::pair{-2.1f, -2.1f}, {2.1f, -2.1f}, {2.1f, 2.1f}, {-2.1f, 2.1f}})
    window.addVertex({x, y, 0.9f});
  window.addTriangle(0, 1, 2);
  window.addTriangle(0, 2, 3);
  append(scene.target, window);
  Options options = Options::standard();
  CHECK(zonesOf(scene, options).back() == Zone::culled);
  options.interiorSamples = false;
  CHECK(zonesOf(scene, options).back() == Zone::cosmetic);
}

TEST_CASE("on difficult models, what must stay bare does and the rest is painted", "[reference]") {
  for (const scenes::Trap& trap : scenes::traps()) {
    INFO(trap.scene.name);
    for (const double threshold : {0.3, 0.5, 0.8}) {
      INFO("threshold " << threshold);
      Options options = Options::standard();
      options.threshold = threshold;
      options.stability = threshold == 0.5;
      const auto result = reference::transfer(trap.scene.cage.view(), trap.scene.target.view(), options);
      const Score score = scoreOf(trap, result.zones);
      CHECK(score.suppressed >= 0.998);
      CHECK(score.kept >= 0.998);
      CHECK(unlikeTwins(trap, result.zones) == 0);
      const auto unstable = std::count(result.stable.begin(), result.stable.end(), 0);
      CHECK(static_cast<std::size_t>(unstable) * 100 <= result.stable.size());
    }
  }
}

TEST_CASE("difficult models are difficult: an earlier version of the rules fails on each", "[reference]") {
  for (const scenes::Trap& trap : scenes::traps()) {
    if (trap.scene.name == "twins 1") continue;  // Its twins happen to fall on the same side.
    if (trap.scene.name == "wrapped" || trap.scene.name == "domed") continue;  // They ask for other steps, see below.
    Options options = Options::earlier();
    options.stability = false;
    const auto zones = zonesOf(trap.scene, options);
    INFO(trap.scene.name);
    const Score score = scoreOf(trap, zones);
    CHECK((score.kept < 0.995 || score.suppressed < 0.995 || unlikeTwins(trap, zones) > 0));
  }
}

TEST_CASE(
    "panes under far loops need interior samples there, a brim nearest to the cage above it the side of what is "
    "exposed, small eyes aside or behind glasses the holes over them",
    "[reference]") {
  const auto scoreWithout = [](const scenes::Trap& trap, bool Options::*step) {
    Options options = Options::standard();
    options.stability = false;
    options.*step = false;
    return scoreOf(trap, zonesOf(trap.scene, options));
  };
  CHECK(scoreWithout(scenes::glazed(), &Options::farLoops).suppressed == 0);
  CHECK(scoreWithout(scenes::hatted(), &Options::exposedSide).kept < 0.8);
  CHECK(scoreWithout(scenes::aside(), &Options::holeContents).suppressed < 0.6);
  CHECK(scoreWithout(scenes::bespectacled(), &Options::holeContents).suppressed < 0.6);
}

TEST_CASE("a cage of the skin's own vertices needs the poke-through, a dome over all the end of the self ray",
          "[reference]") {
  const auto keptWithout = [](const scenes::Trap& trap, bool Options::*step) {
    Options options = Options::standard();
    options.stability = false;
    options.*step = false;
    return scoreOf(trap, zonesOf(trap.scene, options)).kept;
  };
  CHECK(keptWithout(scenes::wrapped(), &Options::pokes) < 0.1);
  CHECK(keptWithout(scenes::domed(), &Options::endOfSelfRay) < 0.1);
}

TEST_CASE("a triangle is painted if a corner is cosmetic and none is uncovered or culled", "[reference]") {
  const scenes::Scene scene = scenes::head(12);
  const auto result = reference::transfer(scene.cage.view(), scene.target.view(), Options::standard());
  std::size_t partly = 0;
  for (std::size_t t = 0; t < result.cosmeticTriangles.size(); ++t) {
    std::multiset<Zone> corners;
    for (std::size_t c = 0; c < 3; ++c) corners.insert(result.zones[scene.target.indices[t * 3 + c]]);
    const bool painted =
        corners.contains(Zone::cosmetic) && !corners.contains(Zone::uncovered) && !corners.contains(Zone::culled);
    REQUIRE((result.cosmeticTriangles[t] != 0) == painted);
    partly += painted && corners.contains(Zone::occluded);
  }
  CHECK(partly > 0);
}

TEST_CASE("the corners of a triangle lie on one chart of the texture", "[reference]") {
  const scenes::Scene scene = scenes::head(12);  // Its cage has six islands, in three columns and two rows.
  const auto result = reference::transfer(scene.cage.view(), scene.target.view(), Options::standard());
  const auto fits = [](const auto& uvAt) {
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 2; ++row) {
        bool inside = true;
        for (std::size_t c = 0; c < 3; ++c) {
          const float x = uvAt(c, 0) * 3 - static_cast<float>(column), y = uvAt(c, 1) * 2 - static_cast<float>(row);
          inside = inside && x > -1e-4f && x < 1.0001f && y > -1e-4f && y < 1.0001f;
        }
        if (inside) return true;
      }
    return false;
  };
  std::size_t across = 0;
  for (std::size_t t = 0; t < scene.target.triangleCount(); ++t) {
    across += !fits([&](std::size_t c, std::size_t k) { return result.uvs[scene.target.indices[t * 3 + c] * 2 + k]; });
    REQUIRE(fits([&](std::size_t c, std::size_t k) { return result.cornerUvs[(t * 3 + c) * 2 + k]; }));
  }
  CHECK(across > 0);
}
