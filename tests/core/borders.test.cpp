#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <numbers>
#include <set>

#include "checks.hpp"
#include "cuts.hpp"
#include "reference/scene.hpp"
#include "scenes/traps.hpp"
#ifdef CAGECAST_GLTF
#include "assets.hpp"
#endif

using namespace cagecast;
using reference::Vec;

namespace {

/// What a border may be off, as a share of the diagonal.
constexpr double kTolerance = 1e-3;

/// The length of all edges that one triangle more runs along in one direction than in the other: where the surface is
/// open. Vertices with equal position and group are one.
double openLength(const MeshView& mesh) {
  using End = std::array<double, 4>;
  std::map<std::pair<End, End>, int> uses;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const auto end = [&](std::size_t corner) {
      const std::uint32_t v = mesh.indices[corner];
      const Vec p = reference::vertex(mesh, v);
      return End{p.x + 0.0, p.y + 0.0, p.z + 0.0, mesh.groups.empty() ? 0.0 : static_cast<double>(mesh.groups[v])};
    };
    const End from = end(i), to = end(i - i % 3 + (i + 1) % 3);
    if (from < to) ++uses[{from, to}];
    if (to < from) --uses[{to, from}];
  }
  double sum = 0;
  for (const auto& [ends, count] : uses) {
    const auto& [a, b] = ends;
    sum += std::abs(count) * length(Vec{a[0], a[1], a[2]} - Vec{b[0], b[1], b[2]});
  }
  return sum;
}

/// Whether a point lies beyond a boundary loop, by brute force.
class Sides {
 public:
  Sides(const MeshView& cage, const MeshView& target) : scene_(reference::makeScene(cage, target)) {}
  [[nodiscard]] bool isBeyond(Vec p) const { return loopAt(scene_, project(scene_, p)) >= 0; }
  [[nodiscard]] double diagonal() const { return scene_.diag; }

 private:
  reference::Scene scene_;
};

struct FoundBorders {
  std::size_t added = 0;      ///< Triangles that there were not before.
  std::size_t onRim = 0;      ///< Places on painted borders that were looked at,
  double mostOff = 0;         ///< and how far the farthest is from a projected loop, as a share of the diagonal.
  std::size_t inside = 0;     ///< Places well inside triangles that were looked at,
  std::size_t otherSide = 0;  ///< and those that are not on the side that their triangle is painted for.
};

/// Checks everything that holds for a cut target, and measures what is asked of it.
FoundBorders checkCut(const std::string& name, const MeshView& cage, const MeshView& target,
                      const TransferOptions& options) {
  INFO(name);
  const TransferResult result = transferred(cage, target, options);
  const CutTarget cut = cutOf(cage, target, options, result);
  const std::size_t vertexCount = target.positions.size() / 3, triangleCount = cut.origins.size();
  REQUIRE(cut.sources.size() % 3 == 0);
  REQUIRE(cut.weights.size() == cut.sources.size());
  const std::size_t newCount = vertexCount + cut.sources.size() / 3;
  REQUIRE(cut.indices.size() == 3 * triangleCount);
  REQUIRE(cut.uvs.size() == 2 * newCount);
  REQUIRE(cut.zones.size() == newCount);
  REQUIRE(cut.cosmeticTriangles.size() == triangleCount);
  REQUIRE(cut.cornerUvs.size() == (options.seams == Seams::corner ? 2 * cut.indices.size() : 0));

  std::size_t badWeights = 0, strangers = 0, unsorted = 0;
  for (std::size_t i = 0; i < cut.sources.size(); i += 3) {
    const float* w = cut.weights.data() + i;
    badWeights += std::min({w[0], w[1], w[2]}) < 0 ||
                  static_cast<double>(w[0]) + static_cast<double>(w[1]) + static_cast<double>(w[2]) != 1;
    for (std::size_t j = 0; j < 3; ++j) REQUIRE(cut.sources[i + j] < vertexCount);
  }
  for (std::size_t i = 0; i < cut.indices.size(); ++i) {
    const std::uint32_t v = cut.indices[i], origin = cut.origins[i / 3];
    REQUIRE(v < newCount);
    REQUIRE(origin < target.indices.size() / 3);
    unsorted += i >= 3 && origin < cut.origins[i / 3 - 1];
    const auto corners = target.indices.subspan(3 * std::size_t{origin}, 3);
    const auto isCorner = [&](std::uint32_t w) {
      return std::find(corners.begin(), corners.end(), w) != corners.end();
    };
    const std::uint32_t* sources = cut.sources.data() + (v < vertexCount ? 0 : 3 * (v - vertexCount));
    strangers += v < vertexCount ? !isCorner(v) : !std::all_of(sources, sources + 3, isCorner);
  }
  CHECK(badWeights == 0);
  CHECK(strangers == 0);
  CHECK(unsorted == 0);

  const scenes::Mesh mesh = meshOf(target, cut);
  const MeshView view = mesh.view();
  const Sides sides(cage, target);
  const double diagonal = sides.diagonal();

  // No area is lost, and none is covered twice or turned.
  std::vector<double> signedAreas(target.indices.size() / 3, 0), areas = signedAreas;
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const Vec whole = areaOf(target, cut.origins[t]);
    const double size = length(whole);
    signedAreas[cut.origins[t]] += size > 0 ? dot(areaOf(view, t), whole) / size : 0;
    areas[cut.origins[t]] += length(areaOf(view, t));
  }
  std::size_t otherArea = 0;
  for (std::size_t t = 0; t < areas.size(); ++t) {
    const double whole = length(areaOf(target, t)), slack = 1e-6 * diagonal * diagonal;
    otherArea += std::abs(areas[t] - whole) > slack || std::abs(signedAreas[t] - whole) > slack;
  }
  CHECK(otherArea == 0);
  MeshView before = target;
  std::vector<std::uint32_t> noGroups(vertexCount, 0);
  if (before.groups.empty()) before.groups = noGroups;
  // No gap: but what is open may be closed, where an edge without area lay along another.
  CHECK(openLength(view) <= openLength(before) * (1 + 1e-5));

  // Every triangle that is painted, or could be, lies on one side.
  FoundBorders found;
  found.added = triangleCount - target.indices.size() / 3;
  std::vector<std::uint8_t> takesPart(triangleCount, 0);
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const auto corners = target.indices.subspan(3 * std::size_t{cut.origins[t]}, 3);
    const bool isHidden = std::all_of(corners.begin(), corners.end(),
                                      [&](std::uint32_t v) { return result.zones.zones[v] == Zone::occluded; });
    const bool fails = std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
      return result.projection.segmentStats[result.projection.segments[v]].culled();
    });
    takesPart[t] = !isHidden && !fails && length(areaOf(target, cut.origins[t])) > 0;
  }
  const double deep = kTolerance * diagonal;
  const auto cornersOf = [&](std::size_t t) {
    return std::array{reference::vertex(view, view.indices[3 * t]), reference::vertex(view, view.indices[3 * t + 1]),
                      reference::vertex(view, view.indices[3 * t + 2])};
  };
  for (std::size_t t = 0; t < triangleCount; ++t) {
    if (!takesPart[t]) continue;
    const auto corners = cornersOf(t);
    const Vec a = corners[0], b = corners[1], c = corners[2];  // Clang 14 cannot capture structured bindings.
    const auto isWellInside = [&](Vec p) {
      for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
        if (length(cross(to - from, p - from)) <= deep * length(to - from)) return false;
      return true;
    };
    int seen[2] = {};
    for (int i = 1; i < 6; ++i)
      for (int j = 1; i + j < 6; ++j) {
        const Vec p = a + (b - a) * (i / 6.0) + (c - a) * (j / 6.0);
        if (!isWellInside(p)) continue;
        ++found.inside;
        ++seen[sides.isBeyond(p)];
      }
    found.otherSide += static_cast<std::size_t>(cut.cosmeticTriangles[t] != 0 ? seen[1] : std::min(seen[0], seen[1]));
  }

  // No vertex is taken to be on the other side of a loop.
  std::vector<std::uint8_t> isUsed(newCount, 0), hasArea(newCount, 0);
  for (std::size_t i = 0; i < cut.indices.size(); ++i) {
    isUsed[cut.indices[i]] |= takesPart[i / 3];
    hasArea[cut.indices[i]] |= length(areaOf(target, cut.origins[i / 3])) > 0;
  }
  const auto isWellOn = [&](Vec p, bool side) {
    for (const Vec away : {Vec{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
      if (sides.isBeyond(p + away * deep) != side) return false;
    return true;
  };
  std::size_t otherZone = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const Zone zone = cut.zones[v];
    const bool isLost = hasArea[v] != 0 && result.zones.zones[v] == Zone::cosmetic && zone == Zone::uncovered;
    const bool isLeft = isUsed[v] != 0 && zone == Zone::cosmetic;
    otherZone += (isLost || isLeft) && isWellOn(reference::vertex(view, v), isLeft);
  }
  CHECK(otherZone == 0);

  // What is painted ends where the loops are projected to.
  std::map<std::pair<std::array<double, 3>, std::array<double, 3>>, std::array<std::int64_t, 2>> edges;
  for (std::size_t t = 0; t < triangleCount; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec p = reference::vertex(view, view.indices[3 * t + k]),
                q = reference::vertex(view, view.indices[3 * t + (k + 1) % 3]);
      const std::array from{p.x, p.y, p.z}, to{q.x, q.y, q.z};
      const auto ends = std::pair(std::min(from, to), std::max(from, to));
      auto& both = edges.try_emplace(ends, std::array<std::int64_t, 2>{-1, -1}).first->second;
      both[cut.cosmeticTriangles[t] != 0] = static_cast<std::int64_t>(t);
    }
  for (const auto& [ends, both] : edges) {
    if (both[0] < 0 || both[1] < 0 || !takesPart[static_cast<std::size_t>(both[0])]) continue;
    // Nothing is painted where there is no area.
    if (length(areaOf(view, static_cast<std::size_t>(both[1]))) <= 1e-9 * diagonal * diagonal) continue;
    const Vec p{ends.first[0], ends.first[1], ends.first[2]}, q{ends.second[0], ends.second[1], ends.second[2]};
    const auto [a, b, c] = cornersOf(static_cast<std::size_t>(both[0]));
    if (!sides.isBeyond((a + b + c) * (1.0 / 3))) continue;  // It ends there for another reason.
    for (const double share : {0.05, 0.35, 0.65, 0.95}) {
      const Vec at = p + (q - p) * share;
      const bool isBeyond = sides.isBeyond(at);
      // The nearest point on the other side, in the planes of both triangles: searched in eight directions, ever
      // farther.
      double least = 10 * kTolerance;
      for (const std::int64_t t : both) {
        const Vec normal = areaOf(view, static_cast<std::size_t>(t));
        if (length(normal) == 0 || length(q - p) == 0) continue;
        const Vec along = unit(q - p), across = unit(cross(normal, along));
        for (int i = 0; i < 8; ++i) {
          const Vec direction = along * std::cos(i * 0.7853981633974483) + across * std::sin(i * 0.7853981633974483);
          for (double r = 1e-5; r < least; r *= 1.3)
            if (sides.isBeyond(at + direction * (r * diagonal)) != isBeyond) least = r;
        }
      }
      ++found.onRim;
      found.mostOff = std::max(found.mostOff, least);
    }
  }
  CHECK(found.mostOff <= kTolerance);
  CHECK(found.otherSide == 0);
  return found;
}

}  // namespace

TEST_CASE("cut borders follow the projected loops on heads", "[borders]") {
  for (const int cells : {8, 16}) {
    const scenes::Scene scene = scenes::head(cells);
    const FoundBorders found = checkCut(scene.name, scene.cage.view(), scene.target.view(), cutting());
    CHECK(found.onRim > 100);
  }
}

#ifdef CAGECAST_GLTF
TEST_CASE("cut borders follow the projected loops on real models", "[borders][assets]") {
  for (const std::filesystem::path& folder : assetFolders()) {
    const gltf::Model target = readAsset(folder / "target.glb"), cage = readAsset(folder / "cage.glb");
    for (const Seams seams : {Seams::vertex, Seams::corner}) {
      const std::string name = folder.filename().string() + (seams == Seams::corner ? ", seams too" : "");
      const FoundBorders found = checkCut(name, cage.view(), target.view(), cutting(seams));
      std::cout << name << ": " << found.added << " triangles more, borders at most " << found.mostOff
                << " of the diagonal off\n";
    }
  }
}
#endif

TEST_CASE("cut borders follow the projected loops of strewn triangles", "[borders]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 4; ++seed) {
    scenes::Scene scene = scenes::strewn(seed, 40);
    INFO("CAGECAST_SEED=" << seed);
    TransferOptions options = cutting(seed % 2 == 0 ? Seams::vertex : Seams::corner);
    options.steps.floor = false;
    options.threshold = 0;
    checkCut(scene.name, scene.cage.view(), scene.target.view(), options);
  }
}

TEST_CASE("cut borders follow the projected loops of patchwork", "[borders]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 12; ++seed) {
    const scenes::Scene scene = scenes::patchwork(seed);
    INFO("CAGECAST_SEED=" << seed);
    checkCut(scene.name, scene.cage.view(), scene.target.view(),
             cutting(seed % 2 == 0 ? Seams::vertex : Seams::corner));
  }
}

TEST_CASE("cut borders follow the projected loops in triangles larger than the holes", "[borders]") {
  // A box of twelve triangles under a box of 12 by 12 cells a side, with two windows; one of them is within a single
  // triangle.
  const auto inWindow = [](scenes::Point p) {
    const auto cell = [](float x) { return static_cast<int>((x + 1.2f) / 0.2f); };
    const int x = cell(p[0]), y = cell(p[1]);
    return p[2] > 1.19f && ((x >= 8 && x < 10 && y >= 3 && y < 5) || (x >= 2 && x < 6 && y >= 5 && y < 9));
  };
  const scenes::Mesh cage = scenes::without(scenes::box({}, {1.2f, 1.2f, 1.2f}, 12), inWindow);
  const scenes::Mesh target = scenes::box({}, {1, 1, 1}, 1);
  for (const std::array<int, 4> turn : {std::array{1, 0, 0, 0}, {3, 1, -2, 1}}) {
    const scenes::Mesh c = scenes::rotated(cage, turn), t = scenes::rotated(target, turn);
    TransferOptions options = cutting(Seams::vertex);
    const FoundBorders found = checkCut("windows", c.view(), t.view(), options);
    CHECK(found.onRim >= 40);
    // No more triangles than two windows ask for.
    CHECK(found.added < 48);
  }
}

TEST_CASE("a cut does not depend on the unit, and is made alike on both sides of a split edge", "[borders]") {
  const scenes::Scene scene = scenes::head(12);
  const CutTarget cut = cutOf(scene.cage.view(), scene.target.view(), cutting());
  SECTION("unit") {
    for (const float unit : {0x1p-20f, 0x1p10f, 0x1p20f}) {
      const auto other = [unit](scenes::Point p) { return scenes::Point{unit * p[0], unit * p[1], unit * p[2]}; };
      const CutTarget again = cutOf(mapped(scene.cage, other).view(), mapped(scene.target, other).view(), cutting());
      CHECK(copied(cut.sources) == copied(again.sources));
      CHECK(copied(cut.weights) == copied(again.weights));
      CHECK(copied(cut.indices) == copied(again.indices));
      CHECK(copied(cut.cosmeticTriangles) == copied(again.cosmeticTriangles));
    }
  }
  SECTION("every triangle with vertices of its own") {
    scenes::Mesh apart;
    for (const std::uint32_t v : scene.target.indices)
      apart.addVertex(scene.target.vertex(v), 0, 0, scene.target.groups[v]);
    for (std::uint32_t i = 0; i < apart.vertexCount(); i += 3) apart.addTriangle(i, i + 1, i + 2);
    const CutTarget other = cutOf(scene.cage.view(), apart.view(), cutting());
    // `checkCut` would find a gap by the length of what is open.
    CHECK(openLength(meshOf(apart.view(), other).view()) ==
          Approx(openLength(meshOf(scene.target.view(), cut).view())).epsilon(1e-5));
    CHECK(copied(cut.origins) == copied(other.origins));
    CHECK(copied(cut.cosmeticTriangles) == copied(other.cosmeticTriangles));
  }
}

TEST_CASE("a target is as it was where the cage has neither holes nor seams", "[borders]") {
  const scenes::Mesh target = scenes::ellipsoid({}, {1, 0.9f, 0.8f}, 6);
  scenes::Mesh cage = scenes::ellipsoid({}, {1.2f, 1.1f, 1}, 8);
  const TransferResult result = transferred(cage.view(), target.view(), cutting(Seams::vertex));
  const CutTarget cut = cutOf(cage.view(), target.view(), cutting(Seams::vertex), result);
  CHECK(cut.sources.empty());
  CHECK(copied(cut.indices) == target.indices);
  CHECK(copied(cut.zones) == copied(result.zones.zones));
  CHECK(copied(cut.uvs) == copied(result.projection.uvs));
  CHECK(copied(cut.cosmeticTriangles) == copied(result.zones.cosmeticTriangles));
}

TEST_CASE("nothing is cut where only vertices of the cage count", "[borders]") {
  const scenes::Scene scene = scenes::head(8);
  TransferOptions options = cutting();
  options.steps.projection = ProjectionMode::nearestVertex;
  CHECK(cutOf(scene.cage.view(), scene.target.view(), options).sources.empty());
}

TEST_CASE("needles at the poles of a cage leave no corner without UVs", "[borders][seams]") {
  // Sines of π are not 0: the triangles at the poles are some 1e-17 wide. Of the cage some are left out: those whose
  // bits are set.
  const auto ball = [](float radius, int rings, int sectors, std::size_t holes) {
    scenes::Mesh mesh;
    for (int j = 0; j <= rings; ++j)
      for (int i = 0; i <= sectors; ++i) {
        const double down = std::numbers::pi * j / rings, around = 2 * std::numbers::pi * i / sectors;
        const auto at = [&](double x) { return static_cast<float>(static_cast<double>(radius) * x); };
        mesh.addVertex(
            {at(std::sin(down) * std::cos(around)), at(std::cos(down)), at(std::sin(down) * std::sin(around))},
            static_cast<float>(i) / static_cast<float>(sectors), static_cast<float>(j) / static_cast<float>(rings));
      }
    const auto row = static_cast<std::uint32_t>(sectors) + 1;
    for (std::uint32_t a = 0; a + row + 1 < mesh.vertexCount(); ++a) {
      if ((holes >> (2 * a % 31) & 1) == 0) mesh.addTriangle(a, a + row + 1, a + row);
      if ((holes >> (2 * a % 31 + 1) & 1) == 0) mesh.addTriangle(a, a + 1, a + row + 1);
    }
    return mesh;
  };
  TransferOptions options = cutting();
  options.threshold = 0;
  const scenes::Mesh target = ball(1, 2, 6, 0);
  for (const std::size_t holes : {135271568u, 805315905u, 12621048u, 152076548u}) {
    const CutTarget cut = cutOf(ball(1.1f, 3, 7, holes).view(), target.view(), options);
    CHECK(std::all_of(cut.cornerUvs.begin(), cut.cornerUvs.end(), [](float uv) { return uv >= 0 && uv <= 1; }));
  }
}

TEST_CASE("a result of another target is refused", "[borders]") {
  const scenes::Scene scene = scenes::head(8);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), cutting());
  const MeshView cage = scene.cage.view(), other = scene.cage.view();
  CutTarget cut;
  const auto codeOf = [&](const DecidedTarget& target) {
    return cutBorders(cage, target, cutting(), testWorkspace(), cut).code;
  };
  const auto& [projection, zones] = result;
  CHECK(codeOf({other, zones.zones, projection.segments, zones.culledBy}) == Code::resultMismatch);
  CHECK(codeOf({scene.target.view(), zones.zones, projection.segments, {}}) == Code::resultMismatch);
  CHECK(codeOf({scene.target.view(), zones.zones, {}, zones.culledBy}) == Code::resultMismatch);
}

TEST_CASE("a result of another target with as many vertices is accepted", "[borders]") {
  const scenes::Scene scene = scenes::head(8);
  scenes::Random random(firstSeed());
  std::vector<std::uint32_t> order;
  const scenes::Mesh other = scenes::shuffled(scene.target, random, order);
  const CutTarget cut =
      cutOf(scene.cage.view(), scene.target.view(), cutting(), transferred(scene.cage.view(), other.view(), cutting()));
  const scenes::Mesh mesh = meshOf(scene.target.view(), cut);
  double before = 0, after = 0;
  for (std::size_t t = 0; t < scene.target.triangleCount(); ++t) before += length(areaOf(scene.target.view(), t));
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) after += length(areaOf(mesh.view(), t));
  CHECK(after == Approx(before));
}

TEST_CASE("a cage of thousands of charts, each a triangle, cuts a target at all of them", "[borders]") {
  const scenes::Mesh whole = scenes::ellipsoid({}, {1.1f, 1.1f, 1.1f}, 14),
                     target = scenes::ellipsoid({}, {1, 1, 1}, 6);
  scenes::Mesh cage;
  for (const std::uint32_t v : whole.indices) {
    const auto i = static_cast<std::uint32_t>(cage.vertexCount());
    const auto u = static_cast<float>(i / 3 % 64) + (i % 3 == 1 ? 0.5f : 0),
               w = static_cast<float>(i / 3 / 64) + (i % 3 == 2 ? 0.5f : 0);
    cage.addVertex(whole.vertex(v), u / 64, w / 64);
  }
  for (std::uint32_t i = 0; i < cage.vertexCount(); i += 3) cage.addTriangle(i, i + 1, i + 2);
  REQUIRE(cage.triangleCount() > 2000);
  const CutTarget cut = cutOf(cage.view(), target.view(), cutting());
  const scenes::Mesh mesh = meshOf(target.view(), cut);
  CHECK(cut.origins.size() > cage.triangleCount());
  // In each piece that is larger than what may be overlooked, all UVs are of one chart.
  std::size_t torn = 0, large = 0;
  for (std::size_t t = 0; t < cut.origins.size(); ++t) {
    if (length(areaOf(mesh.view(), t)) < 1e-5) continue;
    ++large;
    float low[2] = {2, 2}, high[2] = {-2, -2};
    for (std::size_t i = 6 * t; i < 6 * t + 6; ++i) {
      low[i % 2] = std::min(low[i % 2], cut.cornerUvs[i]);
      high[i % 2] = std::max(high[i % 2], cut.cornerUvs[i]);
    }
    torn += std::floor(low[0] * 64 + 1e-3f) < std::floor(high[0] * 64 - 1e-3f) ||
            std::floor(low[1] * 64 + 1e-3f) < std::floor(high[1] * 64 - 1e-3f);
  }
  CHECK(large > 2000);
  CHECK(torn == 0);
}

TEST_CASE("a triangle that spans hundreds of charts is cut at all of them", "[borders]") {
  // Each quad of a lumpy box is a chart.
  const scenes::Mesh whole = scenes::mapped(scenes::box({}, {1, 1, 1}, 12), [](scenes::Point p) {
    const float out = 1.1f + 0.1f * p[0] * p[1] * p[2] - 0.06f * (p[0] + p[1] * p[2]);
    return scenes::Point{out * p[0], out * p[1], out * p[2]};
  });
  constexpr std::uint32_t kRow = 32;
  scenes::Mesh cage;
  for (std::uint32_t i = 0; i < whole.indices.size(); i += 6) {
    const auto u = static_cast<float>(i / 6 % kRow), w = static_cast<float>(i / 6 / kRow);
    const auto add = [&](std::uint32_t corner, float du, float dw) {
      return cage.addVertex(whole.vertex(whole.indices[i + corner]), (u + du) / kRow, (w + dw) / kRow);
    };
    const std::uint32_t a = add(0, 0.1f, 0.1f), b = add(1, 0.9f, 0.1f), c = add(2, 0.9f, 0.9f), d = add(5, 0.1f, 0.9f);
    cage.addTriangle(a, b, c);
    cage.addTriangle(a, c, d);
  }
  const scenes::Mesh target = scenes::box({}, {1, 1, 1}, 1);
  const CutTarget cut = cutOf(cage.view(), target.view(), cutting());
  const scenes::Mesh mesh = meshOf(target.view(), cut);
  const reference::Scene scene = reference::makeScene(cage.view(), target.view());
  double all = 0, elsewhere = 0;
  for (std::size_t t = 0; t < cut.origins.size(); ++t) {
    const auto corner = [&](std::size_t k) { return reference::vertex(mesh.view(), mesh.indices[3 * t + k]); };
    const double area = length(areaOf(mesh.view(), t));
    const double longest =
        std::max({length(corner(1) - corner(0)), length(corner(2) - corner(1)), length(corner(0) - corner(2))});
    all += area;
    if (area < kTolerance * scene.diag * longest) continue;  // It may lie wholly within what a border may be off.
    const auto chart = project(scene, (corner(0) + corner(1) + corner(2)) * (1.0 / 3)).triangle->index / 2;
    const float* uv = cut.cornerUvs.data() + 6 * t;
    const auto cell = [&](int k) { return static_cast<std::uint32_t>((uv[k] + uv[k + 2] + uv[k + 4]) / 3 * kRow); };
    if (cell(0) + kRow * cell(1) != chart) elsewhere += area;
  }
  CHECK(cut.origins.size() > cage.triangleCount());
  CHECK(elsewhere < 1e-3 * all);
}

TEST_CASE("borders that take too long to find are an error that says what to do", "[borders][errors]") {
  // From the middle of a sphere, most of its triangles are about equally near.
  const auto isHole = [](scenes::Point p) { return p[0] > 0.999f; };
  const scenes::Mesh cage = scenes::without(scenes::ellipsoid({}, {1, 1, 1}, 64), isHole);
  const scenes::Mesh target = scenes::box({}, {0.02f, 0.02f, 0.02f}, 2);
  TransferOptions options = cutting(Seams::vertex);
  options.steps.floor = false;
  options.threshold = 0;
  const auto [projection, zones] = transferred(cage.view(), target.view(), options);
  const DecidedTarget decided{target.view(), zones.zones, projection.segments, zones.culledBy};
  CutTarget cut;
  const Status status = cutBorders(cage.view(), decided, options, testWorkspace(), cut);
  CHECK(status.code == Code::bordersTooComplex);
  CHECK(describe(status, cage.view(), target.view()) ==
        "target has borders that are too complex to cut: " + std::to_string(target.triangleCount()) +
            " triangles along " + std::to_string(status.at) +
            " border edges of the cage; leave its triangles whole, or use a cage with fewer "
            "holes and seams");
  const scenes::Scene next = scenes::head(8);
  CHECK(!cutOf(next.cage.view(), next.target.view(), cutting()).sources.empty());
}

TEST_CASE("defects of a target stay the same when it is cut", "[borders]") {
  scenes::Scene scene = scenes::head(8);
  scenes::Mesh& target = scene.target;
  const auto indices = target.indices;
  SECTION("triangles without area, of three corners or of two, or on one line") {
    for (std::size_t i = 0; i + 6 < indices.size(); i += 60) {
      target.addTriangle(indices[i], indices[i + 1], indices[i]);
      const scenes::Point p = target.vertex(indices[i]), q = target.vertex(indices[i + 1]);
      const std::uint32_t middle =
          target.addVertex({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2}, 0, 0, target.groups[indices[i]]);
      target.addTriangle(indices[i], middle, indices[i + 1]);
    }
  }
  SECTION("duplicate triangles, also with reverse winding") {
    for (std::size_t i = 0; i < indices.size(); i += 9) target.addTriangle(indices[i], indices[i + 1], indices[i + 2]);
    for (std::size_t i = 3; i < indices.size(); i += 9) target.addTriangle(indices[i], indices[i + 2], indices[i + 1]);
  }
  SECTION("edges of three triangles") {
    for (std::size_t i = 0; i < indices.size(); i += 30) {
      const std::uint32_t tip = target.addVertex({0, 0, 2}, 0, 0, target.groups[indices[i]]);
      target.addTriangle(indices[i], indices[i + 1], tip);
    }
  }
  SECTION("vertices that nothing uses, and positions of zero with a sign") {
    target.addVertex({5, 5, 5});
    for (float& x : target.positions)
      if (x == 0) x = -0.0f;
  }
  checkCut("wrong", scene.cage.view(), target.view(), cutting());
}
