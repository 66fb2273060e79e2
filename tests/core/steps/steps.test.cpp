// Steps 1 to 7 on small scenes with known answers.

#include <algorithm>
#include <cmath>

#include "checks.hpp"

using namespace cagecast;
using scenes::append;
using scenes::Mesh;
using scenes::Point;

namespace {

/// A level square around the z axis, that faces up or down.
Mesh square(float halfSize, float z, bool isUp = true) {
  const float s = halfSize;
  return isUp ? scenes::sheet({-s, -s, z}, {2 * s, 0, 0}, {0, 2 * s, 0})
              : scenes::sheet({-s, -s, z}, {0, 2 * s, 0}, {2 * s, 0, 0});
}

/// One triangle, as a group of its own.
void addTriangle(Mesh& mesh, Point a, Point b, Point c, std::uint32_t group = 0) {
  const std::uint32_t first = mesh.addVertex(a, 0, 0, group);
  mesh.addVertex(b, 0, 0, group);
  mesh.addVertex(c, 0, 0, group);
  mesh.addTriangle(first, first + 1, first + 2);
}

std::vector<int> zonesOf(const Mesh& cage, const Mesh& target,
                         const TransferOptions& options = TransferOptions::paper()) {
  const TransferResult result = transferred(cage.view(), target.view(), options);
  std::vector<int> zones;
  for (const Zone zone : result.zones.zones) zones.push_back(static_cast<int>(zone));
  return zones;
}

using Ints = std::vector<int>;
using Floats = std::vector<float>;

}  // namespace

TEST_CASE("a point gets the UV of its foot on the cage, beside the cage that of its border", "[project]") {
  const Mesh cage = square(2, 1);
  Mesh target = square(1, 0);
  target.positions[3] = 3;  // One corner under no triangle of the cage.
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(copied(result.projection.uvs) == Floats{0.25f, 0.25f, 1, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f});
  CHECK(result.projection.distances[0] == 1);
  CHECK(zonesOf(cage, target) == Ints{0, 2, 0, 0});
  CHECK(copied(result.zones.cosmeticTriangles) == std::vector<std::uint8_t>{0, 1});
}

TEST_CASE("whichever vertex is beside the cage is uncovered", "[uncovered]") {
  TransferOptions withoutHoles;
  withoutHoles.steps.holes = false;
  for (const TransferOptions& options : {TransferOptions::paper(), withoutHoles}) {
    for (std::size_t v = 0; v < 4; ++v) {
      for (const float x : {-3.0f, 3.0f}) {
        Mesh target = square(0.5f, 0);
        target.positions[3 * v] = x;
        INFO("vertex " << v << " at " << x);
        CHECK(zonesOf(square(2, 1), target, options)[v] == 2);
      }
    }
  }
}

TEST_CASE("of equally near triangles the one whose plane is farthest gives the ray, then the lowest index",
          "[project]") {
  // Two triangles meet in the edge x = 0, z = 0, above the point (0, 0, -1): one is level, the other one steep.
  Mesh cage, target;
  const std::uint32_t a = cage.addVertex({0, -2, 0}), b = cage.addVertex({0, 2, 0});
  const std::uint32_t steep = cage.addVertex({-1, 0, 3}), level = cage.addVertex({2, 0, 0});
  addTriangle(target, {0, 0, -1}, {-0.1f, -0.5f, -1}, {-0.1f, 0.5f, -1});
  for (const bool isLevelFirst : {true, false}) {
    cage.indices = isLevelFirst ? std::vector{a, level, b, a, b, steep} : std::vector{a, b, steep, a, level, b};
    CHECK(transferred(cage.view(), target.view()).projection.triangles[0] == (isLevelFirst ? 0 : 1));
  }
  // The middle of a side of a box: six triangles in one plane.
  const Mesh box = scenes::box({}, {2, 2, 2}, 2);
  addTriangle(target, {1.5f, 0, 0}, {1.4f, 0.1f, 0}, {1.4f, 0, 0.1f});
  const auto first = std::find_if(box.indices.begin(), box.indices.end(), [&](std::uint32_t v) {
    return box.vertex(v) == Point{2, 0, 0};
  });
  CHECK(transferred(box.view(), target.view()).projection.triangles[3] == (first - box.indices.begin()) / 3);
}

TEST_CASE("what the target covers is occluded, from either side; what lies on it is not", "[occluded]") {
  const Mesh cage = square(4, 1);
  for (const bool isUp : {true, false}) {
    Mesh target = square(0.5f, 0);
    append(target, square(1, 0.5f, isUp));
    CHECK(zonesOf(cage, target) == Ints{1, 1, 1, 1, 0, 0, 0, 0});
  }
  // In the same place, as groups of their own: windows on a car are like that.
  Mesh target = square(0.5f, 0);
  append(target, square(0.5f, 0));
  append(target, square(0.5f, 1e-6f));
  CHECK(zonesOf(cage, target) == Ints(12, 0));
}

TEST_CASE("a surface beyond the cage occludes up to the reach, and a point may poke out a little",
          "[reach][pokeThrough]") {
  const Mesh cage = square(9, 2);  // The diagonal of a target is about 6, the reach about 0.18.
  const auto zoneUnder = [&](float height, const TransferOptions& options) {
    Mesh target = square(0.5f, 0);
    append(target, square(2, height));
    return zonesOf(cage, target, options)[0];
  };
  CHECK(zoneUnder(2.1f, {}) == 1);
  CHECK(zoneUnder(2.5f, {}) == 0);
  CHECK(zoneUnder(2.5f, TransferOptions::paper()) == 1);
  const auto zoneAt = [&](float height, const TransferOptions& options) {
    Mesh target = square(2, height);
    append(target, square(0.1f, 1.9f));
    return zonesOf(cage, target, options)[0];
  };
  TransferOptions withoutHoles;
  withoutHoles.steps.holes = false;
  CHECK(zoneAt(2.01f, {}) == 0);
  CHECK(zoneAt(2.01f, withoutHoles) == 0);
  CHECK(zoneAt(2.1f, withoutHoles) == 2);
  CHECK(zoneAt(2.01f, TransferOptions::paper()) == 2);
  // As little out of the cage, but beside its border.
  CHECK(zonesOf(cage, square(9.005f, 2.005f), withoutHoles)[0] == 2);
}

TEST_CASE("degenerate triangles take no part, and a point in no triangle is a segment of its own", "[degenerate]") {
  Mesh target = square(0.5f, 0);
  // Over it: a point, a segment, three points in a row. Each would join or occlude something if it counted.
  const std::uint32_t a = target.addVertex({-3, 0, 0.5f}), b = target.addVertex({0, 0, 0.5f});
  const std::uint32_t c = target.addVertex({3, 0, 0.5f});
  for (const auto& t : {std::array{a, a, a}, {a, c, a}, {a, b, c}, {0u, 0u, a}}) target.addTriangle(t[0], t[1], t[2]);
  Mesh cage;
  cage.addVertex({0, 0, 0.1f}), cage.addVertex({1, 0, 0.1f});
  cage.addTriangle(0, 1, 1);
  append(cage, square(4, 1));
  const TransferResult result = transferred(cage.view(), target.view());
  CHECK(result.projection.triangles[0] > 0);
  CHECK(copied(result.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 1, 2, 3});
  CHECK(result.zones.zones[0] == Zone::cosmetic);
  const SegmentStats& lone = result.projection.segmentStats[1];
  CHECK(lone.points == 1);
  CHECK(lone.area == 0);
  CHECK(lone.coverage() == 0);
  CHECK(result.zones.zones[4] == Zone::cosmetic);  // 0 < threshold · 0 does not hold.
  requireSameAsReference("degenerate", cage.view(), target.view());
}

TEST_CASE("segments are numbered by their first vertex and have its group", "[segments]") {
  Mesh target = square(1, 0);
  append(target, square(1, -3));
  append(target, square(1, -6));
  target.groups = {7, 1, 1, 1, 5, 5, 5, 5, 3, 3, 3, 3};
  std::reverse(target.indices.begin(), target.indices.end());
  const TransferResult result = transferred(square(9, 1).view(), target.view());
  CHECK(copied(result.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2});
  std::vector<std::uint32_t> groups;
  for (const SegmentStats& segment : result.projection.segmentStats) groups.push_back(segment.group);
  CHECK(groups == std::vector<std::uint32_t>{7, 5, 3});
}

TEST_CASE("equal positions are one point, minus zero too, except across groups", "[weld]") {
  Mesh target;
  addTriangle(target, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  addTriangle(target, {-0.0f, -0.0f, -0.0f}, {-1, 0, 0}, {0, -1, 0});
  addTriangle(target, {0, 0, 0}, {2, 1, 0}, {1, 2, 0}, 1);
  const Mesh cage = square(9, 1);
  const TransferResult grouped = transferred(cage.view(), target.view());
  CHECK(copied(grouped.projection.segments) == std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 1, 1, 1});
  CHECK(grouped.projection.segmentStats[0].points == 5);
  target.groups.clear();
  const TransferResult ungrouped = transferred(cage.view(), target.view());
  CHECK(ungrouped.projection.segmentStats.size() == 1);
  CHECK(ungrouped.projection.segmentStats[0].points == 7);
}

TEST_CASE("the weld tolerance is a distance in double precision, within a group", "[weld]") {
  scenes::Random random(firstSeed());
  const Mesh cage = square(2, 2);
  std::size_t wrong = 0, joined = 0;
  for (int i = 0; i < 4000; ++i) {
    TransferOptions options = TransferOptions::paper();
    options.weldTolerance = random.between(0.005f, 0.01f);
    // Two vertices on either side of 0, as far from each other as floats allow to the tolerance.
    const double tolerance = static_cast<double>(options.weldTolerance) * std::sqrt(12.0);
    const float left = -random.between(0, 1) * static_cast<float>(tolerance);
    auto right = static_cast<float>(static_cast<double>(left) + tolerance);
    for (std::uint64_t steps = random.below(3); steps-- > 0;) right = std::nextafter(right, -1.0f);
    Mesh target;
    for (const Point p : {Point{-1, -1, -1}, {1, 1, 1}, {left, 0, 0}, {right, 0, 0}}) target.addVertex(p);
    target.addTriangle(0, 1, 2);
    target.addTriangle(0, 1, 3);
    if (i % 2 == 1) target.groups[3] = 1;
    const TransferResult result = transferred(cage.view(), target.view(), options);
    std::size_t points = 0;
    for (const SegmentStats& segment : result.projection.segmentStats) points += segment.points;
    const double distance = static_cast<double>(right) - static_cast<double>(left);
    wrong += (points == 3) != (distance < tolerance && i % 2 == 0);
    joined += points == 3;
  }
  INFO("CAGECAST_SEED=" << firstSeed());
  CHECK(wrong == 0);
  CHECK(joined > 200);
  CHECK(joined < 1800);
}

TEST_CASE("areas of many triangles add up without a bias", "[segments]") {
  const scenes::Scene scene = scenes::strewn(firstSeed(), 8000);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  double area = 0, exact = 0;
  for (const SegmentStats& segment : result.projection.segmentStats) area += segment.area;
  const auto corner = [&](std::size_t i) {
    const Point p = scene.target.vertex(scene.target.indices[i]);
    return std::array{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  };
  for (std::size_t i = 0; i < scene.target.indices.size(); i += 3) {
    const auto a = corner(i), b = corner(i + 1), c = corner(i + 2);
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t x = (k + 1) % 3, y = (k + 2) % 3;
      const double n = (b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]);
      square += n * n;
    }
    exact += std::sqrt(square) / 2;
  }
  // A tenth of what result.hpp promises for a single segment, and a box of 2 has a larger diagonal.
  const auto triangles = static_cast<double>(scene.target.triangleCount());
  INFO("CAGECAST_SEED=" << firstSeed() << ", off by " << area - exact);
  CHECK(std::abs(area - exact) <= 0.1 * triangles * triangles * 0x1p-58 * 4);
}

TEST_CASE("depth is the mean distance of covered area from the cage, by the diagonal", "[segments]") {
  Mesh target = square(3, 0);
  append(target, square(1, -2));  // Under it: occluded.
  append(target, scenes::sheet({10, -3, -4}, {6, 0, 0}, {0, 6, 0}));
  const Mesh cage = scenes::sheet({-20, -20, 1}, {50, 0, 0}, {0, 50, 0});
  const TransferResult result = transferred(cage.view(), target.view());
  const double diagonal = std::sqrt(19.0 * 19 + 6 * 6 + 4 * 4);
  CHECK(result.projection.segmentStats[0].depth == Approx(1 / diagonal));
  CHECK(result.projection.segmentStats[1].depth == 0);
  CHECK(result.projection.segmentStats[2].depth == Approx(5 / diagonal));
  // More than a diagonal counts as one.
  const Mesh far = scenes::sheet({-200, -200, 99}, {500, 0, 0}, {0, 500, 0});
  CHECK(transferred(far.view(), target.view()).projection.segmentStats[0].depth == 1);
}

TEST_CASE("a window of two triangles is judged inside, not at its frame", "[interiorSamples]") {
  const Mesh cage = without(scenes::box({}, {6, 6, 1}, 12),
                            [](Point p) { return p[2] > 0.9f && std::abs(p[0]) < 2 && std::abs(p[1]) < 2; });
  Mesh target = scenes::box({}, {5.8f, 5.8f, 0.8f}, 6);
  append(target, square(2.1f, 0.9f));
  TransferOptions options;
  CHECK(zonesOf(cage, target, options).back() == 3);
  options.steps.interiorSamples = false;
  CHECK(zonesOf(cage, target, options).back() == 0);
}

TEST_CASE("a triangle is painted if its corners say so: all cosmetic, or some occluded", "[triangles]") {
  const scenes::Scene scene = scenes::head(12);
  for (const bool isPartial : {false, true}) {
    TransferOptions options;
    options.steps.partialTriangles = isPartial;
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), options);
    std::size_t wrong = 0, partly = 0;
    for (std::size_t t = 0; t < scene.target.triangleCount(); ++t) {
      const auto count = [&](Zone zone) {
        const std::uint32_t* corners = &scene.target.indices[3 * t];
        return std::count_if(corners, corners + 3, [&](std::uint32_t v) { return result.zones.zones[v] == zone; });
      };
      const auto cosmetic = count(Zone::cosmetic), others = count(Zone::uncovered) + count(Zone::culled);
      const bool isPainted = isPartial ? cosmetic > 0 && others == 0 : cosmetic == 3;
      wrong += isPainted != (result.zones.cosmeticTriangles[t] == 1);
      partly += isPainted && cosmetic < 3;
    }
    CHECK(wrong == 0);
    CHECK((partly > 0) == isPartial);
  }
}

TEST_CASE("the nearest-vertex baseline takes the nearest vertex, the lowest of equal ones, and filters nothing",
          "[nearestVertex]") {
  TransferOptions options = TransferOptions::paper(), standard;
  options.steps.projection = standard.steps.projection = ProjectionMode::nearestVertex;
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 300), scenes::head(10), scenes::stairs()}) {
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), standard);
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), options);
    for (const Zone zone : result.zones.zones) CHECK(zone == Zone::cosmetic);
  }
  // Over the middles between the vertices of a grid, at heights that no float's square is exact for.
  scenes::Random random(firstSeed());
  for (int i = 0; i < 200; ++i) {
    const float height = random.between(0.001f, 0.1f);
    INFO("height " << height << ", CAGECAST_SEED=" << firstSeed());
    const Mesh cage = scenes::sheet({0, 0, height}, {1, 0, 0}, {0, 1, 0}, 4);
    requireSameAsReference("grids", cage.view(), scenes::sheet({}, {1, 0, 0}, {0, 1, 0}, 8).view(), options);
  }
  Mesh cage = square(1, 1), target;
  cage.addVertex({0, 0, 0.1f});  // Nearer than all, but in no triangle: not part of the cage.
  addTriangle(target, {0, 0, 0}, {0.1f, 0, 0}, {-0.1f, 0.1f, 0});
  const TransferResult result = transferred(cage.view(), target.view(), options);
  CHECK(copied(result.projection.uvs) == Floats{0, 0, 1, 0, 0, 1});
  CHECK(copied(result.projection.triangles) == std::vector<std::uint32_t>{0, 0, 1});
  CHECK(result.projection.distances[0] == Approx(std::sqrt(3.0)));
}

TEST_CASE("timings add up and memory is reported", "[transfer]") {
  const scenes::Scene scene = scenes::head(20);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), {});
  const Timings& t = result.projection.timings;
  const double sum =
      t.weld + t.build + t.project + t.occluded + t.covered + t.segments + t.recheck + t.holes + t.seams + t.classify;
  CHECK(t.total > 0);
  CHECK(sum <= t.total * 1.001 + 0.01);
  CHECK(result.projection.peakBytes > scene.target.vertexCount() * 8);
}
