#include "charts/unwrap.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "charts/min_cut.hpp"
#include "charts/slim.hpp"
#include "charts/steps.hpp"
#include "hull/hull.hpp"
#include "seed.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// A grid of quads, closed round in one or both directions, at places given by two shares.
template <typename Place>
TriangleMesh gridMesh(std::uint32_t columns, std::uint32_t rows, bool roundRows, const Place& place) {
  TriangleMesh mesh;
  const std::uint32_t lines = roundRows ? rows : rows + 1;
  for (std::uint32_t y = 0; y < lines; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) mesh.positions.push_back(place(double(x) / columns, double(y) / rows));
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) {
      const std::uint32_t right = (x + 1) % columns, above = (y + 1) % lines;
      const std::uint32_t a = y * columns + x, b = y * columns + right, c = above * columns + right,
                          d = above * columns + x;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

TriangleMesh torus(std::uint32_t columns, std::uint32_t rows) {
  return gridMesh(columns, rows, true, [](double u, double v) {
    const double r = 2 + std::cos(2 * kPi * v);
    return Vec3{r * std::cos(2 * kPi * u), std::sin(2 * kPi * v), -r * std::sin(2 * kPi * u)};
  });
}

/// Open at the ends; about y.
TriangleMesh tube(std::uint32_t columns, std::uint32_t rows, double height) {
  return gridMesh(columns, rows, false, [=](double u, double v) {
    return Vec3{std::sin(2 * kPi * u), height * v, std::cos(2 * kPi * u)};
  });
}

/// An egg that stands, closed or open below.
TriangleMesh egg(bool isOpen) {
  return mapped(sphere({0, 0, 0}, 1, 14, isOpen ? 4 : 0), [&](const Vec3& p) {
    return isOpen ? Vec3{p.x, -1.3 * p.y, -1.1 * p.z} : Vec3{p.x, 1.3 * p.y, 1.1 * p.z};  // Turned upside down.
  });
}

TriangleMesh box() {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) mesh.positions.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A figure with arms held out, of balls in one hull.
TriangleMesh figure() {
  TriangleMesh balls;
  const auto limb = [&](Vec3 from, Vec3 to, double radius) {
    const int count = static_cast<int>(2 * length(to - from) / radius) + 1;
    for (int i = 0; i <= count; ++i) balls = together(balls, sphere(from + double(i) / count * (to - from), radius, 6));
  };
  limb({0, 1.55, 0}, {0, 1.6, 0}, 0.12);
  limb({0, 0.95, 0}, {0, 1.4, 0}, 0.13);
  for (const double side : {-1.0, 1.0}) {
    limb({side * 0.1, 1.32, 0}, {side * 0.7, 1.32, 0}, 0.06);
    limb({side * 0.1, 0.9, 0}, {side * 0.15, 0.08, 0}, 0.08);
  }
  const double diagonal = diagonalOf(balls);
  TriangleMesh hull;
  REQUIRE(makeHull(balls, {0.01 * diagonal, 0.01 * diagonal, 60}, {}, hull));
  return hull;
}

/// What is wrong with a layout, and how much it stretches: the 95th percentile by area.
struct LayoutFaults {
  std::uint32_t charts = 0;        ///< Pieces connected by shared vertices.
  std::uint32_t overlaps = 0;      ///< Pairs of triangles whose insides meet.
  std::uint32_t flips = 0;         ///< Triangles turned the other way round than most, or without an area.
  std::uint32_t outside = 0;       ///< Vertices outside the unit square.
  double coverage = 0;             ///< Share of the unit square that triangles take.
  double angle95 = 1, area95 = 1;  ///< Longest by shortest axis of the ellipse of a circle; texel density by the mean.
};

/// The value below which 95 % of the weight lies.
double quantile95(std::vector<std::pair<double, double>> valuesAndWeights) {
  std::sort(valuesAndWeights.begin(), valuesAndWeights.end());
  double whole = 0, sum = 0;
  for (const auto& [value, weight] : valuesAndWeights) whole += weight;
  for (const auto& [value, weight] : valuesAndWeights)
    if ((sum += weight) >= 0.95 * whole) return value;
  return 1;
}

LayoutFaults layoutFaults(const TriangleMesh& mesh, const std::vector<cages::Uv>& uvs) {
  LayoutFaults faults;
  (void)connectedPieces(mesh, faults.charts);
  faults.overlaps = countOverlaps(uvs, mesh.triangles, kNone);
  for (const auto& [u, v] : uvs) faults.outside += u >= 0 && u <= 1 && v >= 0 && v <= 1 ? 0 : 1;
  std::uint32_t left = 0, right = 0;
  const RestShapes rest = restShapesOf(mesh);
  std::vector<std::pair<double, double>> angles, densities;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle3& c = mesh.triangles[t];
    const double flat = doubledArea(uvs[c[0]], uvs[c[1]], uvs[c[2]]) / 2, solid = areaOf(mesh, c);
    left += flat > 0 ? 1 : 0;
    right += flat < 0 ? 1 : 0;
    faults.coverage += std::abs(flat);
    if (!(solid > 0)) continue;
    const auto [longest, shortest] = jacobianOf(rest.gradients[t], c, uvs).singularValues();
    angles.emplace_back(shortest > 0 ? longest / shortest : 1e9, solid);
    densities.emplace_back(longest * shortest, solid);
  }
  faults.flips = static_cast<std::uint32_t>(mesh.triangles.size()) - std::max(left, right);
  const double mean = faults.coverage / areaOf(mesh);
  for (auto& [density, area] : densities) density = density > 0 ? std::max(density / mean, mean / density) : 1e9;
  faults.angle95 = quantile95(std::move(angles));
  faults.area95 = quantile95(std::move(densities));
  return faults;
}

/// The least distance between two charts, by brute force.
double leastGap(const Layout& layout) {
  double least = std::numeric_limits<double>::infinity();
  const auto at = [&](std::uint32_t v) { return Vec3{layout.uvs[v][0], layout.uvs[v][1], 0}; };
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> chartOf = connectedPieces(layout.mesh, count);
  for (std::size_t s = 0; s < chartOf.size(); ++s)
    for (std::size_t t = 0; t < chartOf.size(); ++t) {
      if (chartOf[s] == chartOf[t]) continue;
      const auto [a, b, c] = layout.mesh.triangles[t];
      for (const std::uint32_t v : layout.mesh.triangles[s])
        for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
          least = std::min(least, distanceToSegment(at(v), at(from), at(to)));
    }
  return least;
}

/// Unwraps, and checks what holds for any mesh.
LayoutFaults checked(const TriangleMesh& mesh, const UnwrapOptions& options, Layout& layout) {
  REQUIRE(unwrap(mesh, options, {}, layout));
  REQUIRE(layout.mesh.triangles.size() == mesh.triangles.size());
  REQUIRE(layout.uvs.size() == layout.mesh.positions.size());
  bool same = true;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = layout.mesh.positions[layout.mesh.triangles[t][i]], q = mesh.positions[mesh.triangles[t][i]];
      same = same && length(p - q) == 0;
    }
  CHECK(same);
  const LayoutFaults faults = layoutFaults(layout.mesh, layout.uvs);
  CHECK(faults.overlaps == 0);
  CHECK(faults.flips == 0);
  CHECK(faults.outside == 0);
  return faults;
}

LayoutFaults checked(const TriangleMesh& mesh, Kind kind, Layout& layout) {
  UnwrapOptions options;
  options.kind = kind;
  return checked(mesh, options, layout);
}

}  // namespace

TEST_CASE("faults of a layout are found", "[cages][charts]") {
  const TriangleMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  std::vector<cages::Uv> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  LayoutFaults faults = layoutFaults(square, uvs);
  CHECK(faults.charts == 1);
  CHECK(faults.overlaps + faults.flips + faults.outside == 0);
  CHECK(faults.coverage == Approx(1));
  CHECK(faults.angle95 == Approx(1));
  CHECK(faults.area95 == Approx(1));
  uvs[3] = {0.9, 0.2};
  faults = layoutFaults(square, uvs);
  CHECK(faults.overlaps == 1);
  CHECK(faults.flips == 1);
  uvs[3] = {0, 2};
  faults = layoutFaults(square, uvs);
  CHECK(faults.outside == 1);
  CHECK(faults.area95 > 1.2);
  CHECK(faults.angle95 > 1.2);
}

TEST_CASE("shapes of any topology are laid out", "[cages][charts]") {
  Layout layout;
  for (const Kind kind : {Kind::head, Kind::body, Kind::prop}) {
    CAPTURE(static_cast<int>(kind));
    CHECK(checked(box(), kind, layout).coverage > 0.25);
    checked(torus(16, 8), kind, layout);
    checked(tube(12, 10, 8), kind, layout);
    checked(egg(false), kind, layout);
    checked(egg(true), kind, layout);
    CHECK(leastGap(layout) >= 4.0 / 1024 - 1e-6);
  }
}

TEST_CASE("a head is one chart, upright and not mirrored", "[cages][charts]") {
  Layout layout;
  const LayoutFaults faults = checked(egg(true), Kind::head, layout);
  CHECK(faults.charts == 1);
  CHECK(faults.angle95 < 2);
  CHECK(faults.area95 < 2);
  // The corners of triangles in front: further up is further up in the picture, further left is further left.
  for (std::size_t t = 0; t < layout.mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = layout.mesh.triangles[t][i], b = layout.mesh.triangles[t][(i + 1) % 3];
      const Vec3 d = layout.mesh.positions[b] - layout.mesh.positions[a];
      if (layout.mesh.positions[a].z < 0.9 || layout.mesh.positions[b].z < 0.9) continue;
      if (d.y > 2 * std::abs(d.x)) CHECK(layout.uvs[b][1] < layout.uvs[a][1]);
      if (d.x > 2 * std::abs(d.y)) CHECK(layout.uvs[b][0] > layout.uvs[a][0]);
    }
}

TEST_CASE("a face that seams would run over is a chart of its own", "[cages][charts]") {
  // An egg that is cut where its sides are, with a face between two of them.
  const TriangleMesh mesh = egg(false);
  UnwrapOptions options;
  options.kind = Kind::prop;
  FaceFrame face;
  face.size = 0.6;
  face.front = unit({1, 0, 1});
  face.left = cross(face.up, face.front);
  const auto chartsOfFace = [&](const Layout& layout) {
    std::uint32_t count = 0;
    const std::vector<std::uint32_t> chartOf = connectedPieces(layout.mesh, count);
    std::set<std::uint32_t> charts;
    for (std::size_t t = 0; t < chartOf.size(); ++t) {
      const Vec3 d = face.toLocal(centroid(layout.mesh, layout.mesh.triangles[t]));
      if (std::abs(d.x) < 0.8 && d.y < 0.3 && d.y > -1.4 && d.z > 0) charts.insert(chartOf[t]);
    }
    return charts.size();
  };
  Layout layout;
  checked(mesh, options, layout);
  CHECK(chartsOfFace(layout) > 1);
  options.face = face;
  checked(mesh, options, layout);
  CHECK(chartsOfFace(layout) == 1);
  // What has no seam on its face stays as it is.
  options.kind = Kind::head;
  options.face = FaceFrame{.size = 0.6};
  CHECK(checked(egg(true), options, layout).charts == 1);
  options.face->middle = {0, 100, 0};
  checked(mesh, options, layout);
}

TEST_CASE("a body has a chart for each limb", "[cages][charts]") {
  const TriangleMesh mesh = figure();
  Layout layout;
  const LayoutFaults faults = checked(mesh, Kind::body, layout);
  CHECK(faults.charts <= 8);
  CHECK(faults.angle95 < 2);
  // Hands, feet, and the top of the head are on five charts; each has its surroundings on the same.
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> chartOf = connectedPieces(layout.mesh, count);
  std::vector<std::uint32_t> charts;
  for (const Vec3& tip : {Vec3{-0.76, 1.32, 0}, {0.76, 1.32, 0}, {-0.15, 0, 0}, {0.15, 0, 0}, {0, 1.72, 0}}) {
    std::uint32_t chart = 0xffffffffu;
    bool same = true;
    for (std::size_t t = 0; t < layout.mesh.triangles.size(); ++t) {
      if (length(layout.mesh.positions[layout.mesh.triangles[t][0]] - tip) > 0.12) continue;
      same = same && (chart == 0xffffffffu || chart == chartOf[t]);
      chart = chartOf[t];
    }
    CHECK(same);
    charts.push_back(chart);
  }
  std::sort(charts.begin(), charts.end());
  CHECK(std::adjacent_find(charts.begin(), charts.end()) == charts.end());
}

TEST_CASE("a tube is cut open without stretch", "[cages][charts]") {
  Layout layout;
  const LayoutFaults faults = checked(tube(16, 12, 6), Kind::head, layout);
  CHECK(faults.charts == 1);
  CHECK(faults.angle95 < 1.1);
  CHECK(faults.area95 < 1.1);
}

TEST_CASE("bad meshes are laid out", "[cages][charts]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  Layout layout;
  checked({}, Kind::head, layout);
  for (int round = 0; round < 8; ++round) {
    const TriangleMesh whole = round % 2 == 0 ? torus(14, 10) : egg(false);
    TriangleMesh mesh = whole;
    mesh.triangles.clear();
    std::uniform_int_distribution<std::size_t> any(0, whole.triangles.size() - 1);
    for (const Triangle3& t : whole.triangles)
      if (share(random) < -0.8 + 0.22 * round) mesh.triangles.push_back(t);
    // Fins, twice the same triangle, and turned ones: edges shared by more than two.
    for (int i = 0; i < round; ++i) {
      const Triangle3 t = whole.triangles[any(random)];
      mesh.triangles.push_back(i % 2 == 0 ? t : Triangle3{t[1], t[0], whole.triangles[any(random)][2]});
    }
    std::erase_if(mesh.triangles, [](const Triangle3& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    for (Vec3& p : mesh.positions) p = p + 0.1 * Vec3{share(random), share(random), share(random)};
    checked(mesh, static_cast<Kind>(round % 4), layout);
  }
}

TEST_CASE("an unwrap can be cancelled, and is the same each time", "[cages][charts]") {
  const TriangleMesh mesh = egg(true);
  Layout first, second;
  checked(mesh, Kind::head, first);
  checked(mesh, Kind::head, second);
  CHECK(first.uvs == second.uvs);
  CHECK(first.mesh.triangles == second.mesh.triangles);
  CHECK_FALSE(unwrap(
      mesh, {}, [](float, const char*) { return false; }, first));
}

TEST_CASE("joining many regions tells how far it is, and can be cancelled", "[cages][charts]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1);
  std::vector<std::uint32_t> each(ball.triangles.size());
  std::iota(each.begin(), each.end(), 0u);
  std::vector<std::uint32_t> regions = each;
  int reports = 0;
  const Progress counts = [&](float, const char*) { return ++reports > 0; };
  Ticker counting(counts);
  joinSmallRegions(ball, 0.04, 8, counting, regions);
  CHECK(reports > 2);
  CHECK(std::set(regions.begin(), regions.end()).size() <= 8);
  regions = each;
  const Progress cancels = [](float, const char*) { return false; };
  Ticker cancelling(cancels);
  joinSmallRegions(ball, 0.04, 8, cancelling, regions);
  CHECK(regions == each);
}

TEST_CASE("a long chain is cut at its cheapest edge", "[cages][charts]") {
  constexpr std::uint32_t kNodes = 300'000, kCheapest = 200'000;  // Recursion would overflow the stack.
  MinCut cut(kNodes, 0.01);
  cut.addNode(0, 0, MinCut::kForbidden);
  cut.addNode(kNodes - 1, MinCut::kForbidden, 0);
  for (std::uint32_t i = 0; i + 1 < kNodes; ++i) cut.addEdge(i, i + 1, i == kCheapest ? 1 : 2);
  const std::vector<bool> second = cut.solve();
  CHECK(std::count(second.begin(), second.end(), false) == kCheapest + 1);
  CHECK_FALSE(second[kCheapest]);
  CHECK(second[kCheapest + 1]);
}

TEST_CASE("what is forbidden stays so on models of any unit", "[cages][charts]") {
  MinCut cut(2, 1e29);
  cut.addNode(0, 0, MinCut::kForbidden);
  cut.addNode(1, MinCut::kForbidden, 0);
  cut.addEdge(0, 1, 1e33);
  CHECK(cut.solve() == std::vector{false, true});
}
