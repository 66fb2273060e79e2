#include <algorithm>
#include <cmath>
#include <tuple>

#include "checks.hpp"

using namespace cagecast;

namespace {

/// A square in a plane of constant z, facing up or down, as two triangles with UVs that are its x and y.
void addSquare(scenes::Mesh& mesh, float halfSize, float z, bool up = true, std::uint32_t group = 0) {
  const float s = halfSize;
  const std::uint32_t a = mesh.addVertex({-s, -s, z}, -s, -s, group), b = mesh.addVertex({s, -s, z}, s, -s, group),
                      c = mesh.addVertex({s, s, z}, s, s, group), d = mesh.addVertex({-s, s, z}, -s, s, group);
  if (up) {
    mesh.addTriangle(a, b, c);
    mesh.addTriangle(a, c, d);
  } else {
    mesh.addTriangle(a, c, b);
    mesh.addTriangle(a, d, c);
  }
}

scenes::Mesh square(float halfSize, float z, bool up = true) {
  scenes::Mesh mesh;
  addSquare(mesh, halfSize, z, up);
  return mesh;
}

std::vector<int> zonesOf(const TransferResult& result) {
  std::vector<int> zones;
  for (const Zone zone : result.zones.zones) zones.push_back(static_cast<int>(zone));
  return zones;
}

}  // namespace

TEST_CASE("a point under the cage gets the UV of its foot on it", "[project]") {
  const scenes::Mesh cage = square(2, 1), target = square(0.5f, 0);
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(copied(result.projection.uvs) == std::vector<float>{-0.5f, -0.5f, 0.5f, -0.5f, 0.5f, 0.5f, -0.5f, 0.5f});
  CHECK(copied(result.projection.distances) == std::vector<float>(4, 1));
  CHECK(zonesOf(result) == std::vector<int>(4, 0));
  CHECK(copied(result.zones.cosmeticTriangles) == std::vector<std::uint8_t>{1, 1});
}

TEST_CASE("a point beside the cage gets the UV of the border, and the ray misses", "[project]") {
  scenes::Mesh target = square(0.5f, 0);
  target.positions[3] = 3;  // One corner under no triangle of the cage.
  const scenes::Mesh cage = square(2, 1);
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(result.projection.uvs[2] == 2);
  CHECK(result.projection.uvs[3] == -0.5f);
  CHECK(result.zones.zones[1] == Zone::uncovered);
}

TEST_CASE("whichever vertex is beside the cage is uncovered", "[uncovered]") {
  const scenes::Mesh cage = square(2, 1);
  TransferOptions withoutHoles;
  withoutHoles.steps.holes = false;
  for (const TransferOptions& options : {TransferOptions::paper(), withoutHoles}) {
    for (std::size_t v = 0; v < 4; ++v) {
      for (const float x : {-3.0f, 3.0f}) {
        scenes::Mesh target = square(0.5f, 0);
        target.positions[3 * v] = x;
        INFO("vertex " << v << " at " << x);
        CHECK(transferred(cage.view(), target.view(), options).zones.zones[v] == Zone::uncovered);
      }
    }
  }
}

TEST_CASE("of equally near triangles the one whose plane is farthest gives the ray", "[project]") {
  // Two triangles meet in the edge x = 0, z = 0, above the point (0, 0, -1): one is level, the other one steep.
  scenes::Mesh cage;
  const std::uint32_t a = cage.addVertex({0, -2, 0}), b = cage.addVertex({0, 2, 0});
  const std::uint32_t steep = cage.addVertex({-1, 0, 3}), level = cage.addVertex({2, 0, 0});
  scenes::Mesh target;
  for (const scenes::Point p : {scenes::Point{0, 0, -1}, {-0.1f, 0.5f, -1}, {-0.1f, -0.5f, -1}}) target.addVertex(p);
  target.addTriangle(0, 2, 1);
  SECTION("the level one last") { cage.addTriangle(a, b, steep), cage.addTriangle(a, level, b); }
  SECTION("the level one first") { cage.addTriangle(a, level, b), cage.addTriangle(a, b, steep); }
  const TransferResult result = transferred(cage.view(), target.view());
  const std::uint32_t chosen = result.projection.triangles[0];
  CHECK(cage.indices[chosen * 3 + 1] == level);
  requireSameAsReference("tie", cage.view(), target.view());
}

TEST_CASE("of equally near triangles in one plane the one with the lowest index is taken", "[project]") {
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 2);
  scenes::Mesh target;
  for (const scenes::Point p : {scenes::Point{1.5f, 0, 0}, {1.4f, 0.1f, 0}, {1.4f, 0, 0.1f}}) target.addVertex(p);
  target.addTriangle(0, 1, 2);
  const TransferResult result = transferred(cage.view(), target.view());
  std::uint32_t lowest = UINT32_MAX;
  for (std::uint32_t t = 0; t < cage.triangleCount(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      if (cage.vertex(cage.indices[t * 3 + c]) == scenes::Point{2, 0, 0}) lowest = std::min(lowest, t);
  REQUIRE(lowest != UINT32_MAX);
  CHECK(result.projection.triangles[0] == lowest);
}

TEST_CASE("what the target covers is occluded, from either side", "[occluded]") {
  for (const bool up : {true, false}) {
    scenes::Mesh target = square(0.5f, 0);
    addSquare(target, 1, 0.5f, up);
    const scenes::Mesh cage = square(4, 1);
    const TransferResult result = transferred(cage.view(), target.view());
    CHECK(zonesOf(result) == std::vector<int>{1, 1, 1, 1, 0, 0, 0, 0});
    CHECK(copied(result.zones.cosmeticTriangles) == std::vector<std::uint8_t>{0, 0, 1, 1});
  }
}

TEST_CASE("a surface that lies on the point does not occlude it", "[occluded]") {
  // A second square in the same place, as a group of its own: windows on a car are like that.
  scenes::Mesh target = square(0.5f, 0);
  addSquare(target, 0.5f, 0, true, 1);
  addSquare(target, 0.5f, 1e-6f, true, 2);
  const scenes::Mesh cage = square(4, 1);
  CHECK(zonesOf(transferred(cage.view(), target.view())) == std::vector<int>(12, 0));
}

TEST_CASE("degenerate triangles take no part", "[degenerate]") {
  scenes::Mesh target = square(0.5f, 0);
  // Over it: a point, a segment, three points in a row. Each would join or occlude something if it counted.
  const std::uint32_t a = target.addVertex({-3, 0, 0.5f}), b = target.addVertex({0, 0, 0.5f}),
                      c = target.addVertex({3, 0, 0.5f});
  target.addTriangle(a, a, a);
  target.addTriangle(a, c, a);
  target.addTriangle(a, b, c);
  target.addTriangle(0, 0, a);
  scenes::Mesh cage;
  cage.addVertex({0, 0, 0.1f}), cage.addVertex({1, 0, 0.1f});
  cage.addTriangle(0, 1, 1);
  append(cage, square(4, 1));
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(result.projection.triangles[0] == 1 + 1 * (cage.indices[3] != 2));
  CHECK(result.projection.segmentStats.size() == 4);  // The square, and three points in no triangle.
  CHECK(result.zones.zones[0] == Zone::cosmetic);
  CHECK(result.projection.segmentStats[1].points == 1);
  CHECK(result.projection.segmentStats[1].area == 0);
  requireSameAsReference("degenerate", cage.view(), target.view());
}

TEST_CASE("a point in no triangle is a segment of its own, of no area", "[segments]") {
  scenes::Mesh target = square(0.5f, 0);
  target.addVertex({0.1f, 0.2f, 0.3f});
  const scenes::Mesh cage = square(4, 1);
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(copied(result.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 1});
  CHECK(result.projection.segmentStats[1].area == 0);
  CHECK(result.projection.segmentStats[1].coverage() == 0);
  CHECK(result.zones.zones[4] == Zone::cosmetic);  // 0 < threshold · 0 does not hold.
}

TEST_CASE("segments are numbered by their first vertex", "[segments]") {
  scenes::Mesh target;
  addSquare(target, 1, 0);
  addSquare(target, 1, -3);
  addSquare(target, 1, -6);
  std::reverse(target.indices.begin(), target.indices.end());
  const scenes::Mesh cage = square(9, 1);
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(copied(result.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2});
}

TEST_CASE("equal positions are one point, minus zero too, except across groups", "[weld]") {
  scenes::Mesh target;
  const auto triangle = [&](scenes::Point a, scenes::Point b, scenes::Point c, std::uint32_t group) {
    const std::uint32_t first = target.addVertex(a, 0, 0, group);
    target.addVertex(b, 0, 0, group);
    target.addVertex(c, 0, 0, group);
    target.addTriangle(first, first + 1, first + 2);
  };
  triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  triangle({-0.0f, -0.0f, -0.0f}, {-1, 0, 0}, {0, -1, 0}, 0);
  triangle({0, 0, 0}, {2, 1, 0}, {1, 2, 0}, 1);
  const scenes::Mesh cage = square(9, 1);
  const TransferResult grouped = transferred(cage.view(), target.view());
  CHECK(copied(grouped.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 1, 1, 1});
  CHECK(grouped.projection.segmentStats[0].points == 5);
  target.groups.clear();
  const TransferResult ungrouped = transferred(cage.view(), target.view());
  CHECK(ungrouped.projection.segmentStats.size() == 1);
  CHECK(ungrouped.projection.segmentStats[0].points == 7);
}

TEST_CASE("the weld tolerance is a distance in double precision", "[weld]") {
  scenes::Random random(firstSeed());
  const scenes::Mesh cage = square(2, 2);
  std::size_t wrong = 0, joined = 0;
  for (int i = 0; i < 4000; ++i) {
    TransferOptions options = TransferOptions::paper();
    options.weldTolerance = random.between(0.005f, 0.01f);
    // Two vertices on either side of 0, as far from each other as floats allow to the tolerance.
    const double tolerance = static_cast<double>(options.weldTolerance) * std::sqrt(12.0);
    const float left = -random.between(0, 1) * static_cast<float>(tolerance);
    auto right = static_cast<float>(static_cast<double>(left) + tolerance);
    for (std::uint64_t steps = random.below(3); steps-- > 0;) right = std::nextafter(right, -1.0f);
    scenes::Mesh target;
    for (const scenes::Point p : {scenes::Point{-1, -1, -1}, {1, 1, 1}, {left, 0, 0}, {right, 0, 0}})
      target.addVertex(p);
    target.addTriangle(0, 1, 2);
    target.addTriangle(0, 1, 3);
    const TransferResult result = transferred(cage.view(), target.view(), options);
    std::size_t points = 0;
    for (const SegmentStats& segment : result.projection.segmentStats) points += segment.points;
    const double distance = static_cast<double>(right) - static_cast<double>(left);
    wrong += (points == 3) != (distance < tolerance);
    joined += points == 3;
  }
  INFO("CAGECAST_SEED=" << firstSeed());
  CHECK(wrong == 0);
  CHECK(joined > 400);
  CHECK(joined < 3600);
}

TEST_CASE("the weld tolerance joins what is nearer than its share of the diagonal", "[weld]") {
  scenes::Mesh target;
  const auto triangle = [&](float x, float shift) {
    const std::uint32_t first = target.addVertex({x + shift, shift, 0});
    target.addVertex({x + 1, 0, 0});
    target.addVertex({x, 1, 0});
    target.addTriangle(first, first + 1, first + 2);
  };
  triangle(0, 0);
  triangle(1, 1e-4f);
  triangle(-1, 3e-4f);
  // Triangle 1's first corner is beside triangle 0's second; triangle 2's second corner is triangle 0's first.
  const scenes::Mesh cage = square(9, 1);
  const auto segmentsWith = [&](float tolerance) {
    TransferOptions options = TransferOptions::paper();
    options.weldTolerance = tolerance;
    requireSameAsReference("tolerance", cage.view(), target.view(), options);
    return transferred(cage.view(), target.view(), options).projection.segmentStats.size();
  };
  CHECK(segmentsWith(0) == 2);
  CHECK(segmentsWith(1e-5f) == 2);
  CHECK(segmentsWith(1e-4f) == 1);
  target.groups.assign({0, 0, 0, 1, 1, 1, 2, 2, 2});
  CHECK(segmentsWith(1e-4f) == 3);
}

TEST_CASE("areas of many triangles add up without a bias", "[segments]") {
  const scenes::Scene scene = scenes::strewn(firstSeed(), 8000);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  double area = 0, exact = 0;
  for (const SegmentStats& segment : result.projection.segmentStats) area += segment.area;
  const reference::Result expected = reference::transfer(scene.cage.view(), scene.target.view());
  for (const SegmentStats& segment : expected.segmentStats) exact += segment.area;
  // A tenth of what result.hpp promises for a single segment, and a box of 2 has a larger diagonal.
  const auto triangles = static_cast<double>(scene.target.triangleCount());
  INFO("CAGECAST_SEED=" << firstSeed() << ", off by " << area - exact);
  CHECK(std::abs(area - exact) <= 0.1 * triangles * triangles * 0x1p-58 * 4);
}

TEST_CASE("a segment below the threshold is culled, one at it is not", "[classify]") {
  // Three of four equal corners covered... of a square whose corners have 2/6, 1/6, 2/6, 1/6 of its area.
  scenes::Mesh target = square(1, 0);
  const scenes::Mesh cage =
      without(scenes::box({}, {2, 2, 2}, 4), [](scenes::Point p) { return p[2] < 2 || (p[0] > 0 && p[1] > 0); });
  TransferOptions options = TransferOptions::paper();
  const auto at = [&](float threshold) {
    options.threshold = threshold;
    return zonesOf(transferred(cage.view(), target.view(), options));
  };
  const TransferResult result = transferred(cage.view(), target.view());
  const double coverage = result.projection.segmentStats[0].coverage();
  CHECK(coverage == Approx(2.0 / 3));
  CHECK(at(0.66f) == std::vector<int>{0, 0, 2, 0});
  CHECK(at(0.67f) == std::vector<int>{3, 3, 2, 3});
  CHECK(at(0) == std::vector<int>{0, 0, 2, 0});
  CHECK(at(1) == std::vector<int>{3, 3, 2, 3});
}

TEST_CASE("threshold 0 culls nothing and 1 spares what is covered entirely", "[classify]") {
  const scenes::Scene scene = scenes::head(12);
  TransferOptions options = TransferOptions::paper();
  options.threshold = 0;
  const TransferResult none = transferred(scene.cage.view(), scene.target.view(), options);
  CHECK(std::count(none.zones.zones.begin(), none.zones.zones.end(), Zone::culled) == 0);
  CHECK(copied(none.zones.zones) == copied(none.projection.zones));
  options.threshold = 1;
  const TransferResult all = transferred(scene.cage.view(), scene.target.view(), options);
  for (const SegmentStats& stats : all.projection.segmentStats)
    CHECK(stats.culled() == (stats.coveredArea < stats.exposedArea));
}

TEST_CASE("classify with another threshold equals transfer with it", "[classify]") {
  const scenes::Scene scene = scenes::strewn(firstSeed(), 600);
  Projection projection;
  REQUIRE(project(scene.cage.view(), scene.target.view(), TransferOptions::paper(), testWorkspace(), projection).ok());
  for (const float threshold : {0.0f, 0.1f, 0.25f, 0.5f, 0.51f, 0.75f, 0.9f, 1.0f}) {
    TransferOptions options = TransferOptions::paper();
    options.threshold = threshold;
    const TransferResult whole = transferred(scene.cage.view(), scene.target.view(), options);
    Zones zones;
    TransferOptions decide = TransferOptions::paper();
    decide.threshold = threshold;
    REQUIRE(classify(projection.view(), scene.target.indices, decide, zones).ok());
    INFO("threshold " << threshold);
    CHECK(copied(zones.zones) == copied(whole.zones.zones));
    CHECK(copied(zones.cosmeticTriangles) == copied(whole.zones.cosmeticTriangles));
    CHECK(copied(zones.culledBy) == copied(whole.zones.culledBy));
    CHECK(copied(projection.zones) == copied(whole.projection.zones));
    for (std::size_t s = 0; s < zones.culledBy.size(); ++s)
      CHECK((zones.culledBy[s] != CulledBy::none) == whole.projection.segmentStats[s].culled());
    for (std::size_t s = 0; s < zones.scores.size(); ++s) {
      const SegmentStats& stats = projection.segmentStats[s];
      CHECK((zones.culledBy[s] != CulledBy::none) == (zones.scores[s] < 1));
      CHECK((zones.culledBy[s] != CulledBy::none) ==
            (stats.coveredArea < static_cast<double>(threshold) * stats.exposedArea));
    }
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
  }
}

TEST_CASE("a triangle is cosmetic only if all its corners are", "[classify]") {
  const scenes::Scene scene = scenes::head(12);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  std::size_t wrong = 0, cosmetic = 0;
  for (std::size_t t = 0; t < scene.target.triangleCount(); ++t) {
    const std::uint32_t* corners = &scene.target.indices[t * 3];
    const bool all =
        std::all_of(corners, corners + 3, [&](std::uint32_t v) { return result.zones.zones[v] == Zone::cosmetic; });
    wrong += all != (result.zones.cosmeticTriangles[t] == 1);
    cosmetic += all;
  }
  CHECK(wrong == 0);
  CHECK(cosmetic > scene.target.triangleCount() / 4);
}

TEST_CASE("the nearest-vertex baseline takes the nearest vertex, the lowest of equal ones, and filters nothing",
          "[nearestVertex]") {
  TransferOptions options = TransferOptions::paper();
  options.steps.projection = ProjectionMode::nearestVertex;
  for (const scenes::Scene& scene :
       {scenes::strewn(firstSeed(), 300), scenes::head(10), scenes::lattice(3), scenes::stairs()}) {
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), options);
    const auto& zones = result.zones.zones;
    CHECK(std::count(zones.begin(), zones.end(), Zone::cosmetic) == static_cast<std::ptrdiff_t>(zones.size()));
    const TransferResult filtered = transferred(scene.cage.view(), scene.target.view());
    CHECK(copied(result.projection.segments) == copied(filtered.projection.segments));
  }
}

TEST_CASE("of equally near cage vertices the nearest-vertex baseline takes the lowest", "[nearestVertex]") {
  scenes::Mesh cage = square(1, 1), target;
  // Nearer than all, but in no triangle: not part of the cage.
  cage.addVertex({0, 0, 0.1f});
  for (const scenes::Point p : {scenes::Point{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {-0.1f, 0.1f, 0}})
    target.addVertex(p);
  target.addTriangle(0, 1, 2);
  TransferOptions options = TransferOptions::paper();
  options.steps.projection = ProjectionMode::nearestVertex;
  const TransferResult result = transferred(cage.view(), target.view(), options);
  CHECK(copied(result.projection.uvs) == std::vector<float>{-1, -1, 1, -1, 1, 1, -1, 1});
  CHECK(copied(result.projection.triangles) == std::vector<std::uint32_t>{0, 0, 0, 1});
  CHECK(result.projection.distances[0] == Approx(std::sqrt(3.0)));
}

TEST_CASE("cage vertices are as near to the nearest-vertex baseline as in double precision", "[nearestVertex]") {
  // Over the middles between the vertices of a grid, at heights that no float's square is exact for.
  TransferOptions options = TransferOptions::paper();
  options.steps.projection = ProjectionMode::nearestVertex;
  scenes::Random random(firstSeed());
  for (int i = 0; i < 200; ++i) {
    scenes::Mesh cage, target;
    const float height = random.between(0.001f, 0.1f);
    const auto addGrid = [](scenes::Mesh& mesh, std::uint32_t cells, float z) {
      const auto side = static_cast<float>(cells);
      for (std::uint32_t v = 0; v < (cells + 1) * (cells + 1); ++v) {
        const float x = static_cast<float>(v % (cells + 1)) / side, y = static_cast<float>(v / (cells + 1)) / side;
        mesh.addVertex({x, y, z}, x, y);
      }
      for (std::uint32_t y = 0; y < cells; ++y) {
        for (std::uint32_t x = 0; x < cells; ++x) {
          const std::uint32_t a = y * (cells + 1) + x, b = a + cells + 1;
          mesh.addTriangle(a, a + 1, b + 1);
          mesh.addTriangle(a, b + 1, b);
        }
      }
    };
    addGrid(cage, 4, height);
    addGrid(target, 8, 0);
    INFO("height " << height << ", CAGECAST_SEED=" << firstSeed());
    requireSameAsReference("grids", cage.view(), target.view(), options);
  }
}

TEST_CASE("timings add up and memory is reported", "[transfer]") {
  const scenes::Scene scene = scenes::head(20);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  const Timings& t = result.projection.timings;
  const double sum = t.weld + t.build + t.project + t.occluded + t.covered + t.segments + t.classify;
  CHECK(t.total > 0);
  CHECK(sum <= t.total * 1.001 + 0.01);
  CHECK(result.projection.peakBytes > scene.target.vertexCount() * 8);
}

TEST_CASE("occluded points of a part that the cage covers nowhere get no more rays", "[recheck]") {
  // A shelf beside the cage, half of it under a roof. From there, rays to the side pass under the roof to the cage.
  const auto shelf = [](float x) {
    scenes::Mesh target;
    for (const auto& [u, z] : {std::pair{0.0f, 0.0f}, {0.5f, 0.0f}, {0.75f, 0.0f}, {1.0f, 0.0f}, {0.45f, 0.2f}})
      for (const float y : {-0.5f, 0.5f}) target.addVertex({x + u, z > 0 ? 2 * y : y, z}, 0, 0, 1);
    for (const auto& [a, b] : {std::pair{0u, 2u}, {2u, 4u}, {4u, 6u}, {8u, 6u}}) {
      target.addTriangle(a, b, a + 1);
      target.addTriangle(b, b + 1, a + 1);
    }
    return target;
  };
  const scenes::Mesh cage = square(2, 1);
  const LockEntry kept[] = {{1, Lock::keep}};
  TransferOptions options;
  options.steps.holes = false;
  options.locks.groups = kept;
  const auto isLeftUnder = [&](float x) {
    const std::vector<int> zones = zonesOf(transferred(cage.view(), shelf(x).view(), options));
    return std::vector(zones.begin() + 2, zones.begin() + 4) == std::vector{1, 1};
  };
  CHECK_FALSE(isLeftUnder(1.25f));
  CHECK(isLeftUnder(2.25f));
  // At a threshold of 0 and without a floor, such parts pass unlocked.
  options = TransferOptions::paper();
  options.threshold = 0;
  options.steps.recheck = true;
  for (const float x : {1.25f, 2.25f})
    CHECK(requireSameAsReference("a shelf", cage.view(), shelf(x).view(), options).unstable == 0);
}

TEST_CASE("a sheet with two sides, between two others, is seen from where the reference sees it", "[recheck]") {
  const scenes::Mesh cage = scenes::box({0, 0, 0.1f}, {5, 5, 1.2f}, 4);
  TransferOptions onlyOnce;
  onlyOnce.steps.recheck = false;
  std::size_t occluded = 0, left = 0;
  for (int step = 1; step <= 12; ++step) {
    scenes::Mesh target;
    const auto addSheet = [&](float z, scenes::Point low, scenes::Point high, bool hasTwoSides) {
      constexpr std::uint32_t kCells = 8;
      const auto first = static_cast<std::uint32_t>(target.vertexCount());
      const auto between = [](float from, float to, std::uint32_t i) {
        return from + (to - from) * static_cast<float>(i) / kCells;
      };
      for (std::uint32_t i = 0; i <= kCells; ++i)
        for (std::uint32_t j = 0; j <= kCells; ++j)
          target.addVertex({between(low[0], high[0], i), between(low[1], high[1], j), z});
      for (std::uint32_t i = 0; i < kCells; ++i)
        for (std::uint32_t j = 0; j < kCells; ++j) {
          const std::uint32_t a = first + i * (kCells + 1) + j, b = a + kCells + 1;
          for (const auto& [p, q, r] : {std::tuple{a, b, a + 1}, {b, b + 1, a + 1}}) {
            target.addTriangle(p, q, r);
            if (hasTwoSides) target.addTriangle(p, r, q);
          }
        }
    };
    const float share = static_cast<float>(step) / 13;
    addSheet(0, {-1.1f, -1}, {1.7f, 1}, true);
    addSheet(share * 0.4f, {-3.1f, -3.2f}, {0.8f, 3.3f}, false);
    addSheet((share - 1) * 0.3f, {-3.2f, -3.3f}, {0.83f, 3.1f}, false);
    const auto countOccluded = [&](const TransferOptions& options) {
      const std::vector<int> zones = zonesOf(transferred(cage.view(), target.view(), options));
      return static_cast<std::size_t>(std::count(zones.begin(), zones.begin() + 81, 1));
    };
    occluded += countOccluded(onlyOnce);
    left += countOccluded(TransferOptions{});
    requireSameAsReference("sheets", cage.view(), target.view(), TransferOptions{});
  }
  // Of 12 · 81 points.
  CHECK(occluded > 500);
  CHECK(left > 50);
  CHECK(left < 200);
}

TEST_CASE("a part that faces neither to the cage nor away from it is seen on the side of its normals", "[recheck]") {
  // An upright sheet beside a wall. A roof hides most of it from the cage above, and leaves one of its sides open.
  const scenes::Mesh cage = scenes::box({}, {5, 5, 2}, 4);
  TransferOptions options;
  for (const bool isTurned : {false, true}) {
    scenes::Mesh target;
    const auto addRectangle = [&](scenes::Point a, scenes::Point b, scenes::Point c, scenes::Point d) {
      const std::uint32_t i = target.addVertex(a), j = target.addVertex(b), k = target.addVertex(c);
      const std::uint32_t l = target.addVertex(d);
      target.addTriangle(i, j, k), target.addTriangle(i, k, l);
    };
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 4; ++j) {
        const float y = 0.25f * static_cast<float>(i) - 1, z = 0.25f * static_cast<float>(j);
        const scenes::Point a{0, y, z}, b{0, y + 0.25f, z}, c{0, y + 0.25f, z + 0.25f}, d{0, y, z + 0.25f};
        if (isTurned) addRectangle(a, d, c, b);
        if (!isTurned) addRectangle(a, b, c, d);
      }
    addRectangle({-0.5f, -3, 1.25f}, {0.5f, -3, 1.25f}, {0.5f, 0.6f, 1.25f}, {-0.5f, 0.6f, 1.25f});
    addRectangle({-0.1f, -3, -1}, {-0.1f, -3, 1.25f}, {-0.1f, 3, 1.25f}, {-0.1f, 3, -1});
    const auto occluded = [&](bool looksTwice) {
      options.steps.recheck = looksTwice;
      const std::vector<int> zones = zonesOf(transferred(cage.view(), target.view(), options));
      return std::count(zones.begin(), zones.begin() + 128, 1);
    };
    // The sheet's front looks away from the wall, or, turned, to it.
    const auto once = occluded(false);
    CHECK(once > 50);
    CHECK(occluded(true) == (isTurned ? once : 0));
    requireSameAsReference("an upright sheet", cage.view(), target.view(), options);
  }
}
