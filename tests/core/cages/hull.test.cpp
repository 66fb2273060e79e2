#include "hull/hull.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "mesh/bounds.hpp"
#include "mesh/surface.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle3& t : mesh.triangles)
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  return sum;
}

/// Every edge has one triangle on each side, which run along it in opposite directions.
bool closedManifold(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle3& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end() && back->second == 1;
  });
}

/// Vertices − edges + triangles of a closed surface: 2 without handles.
std::int64_t eulerNumber(const TriangleMesh& mesh) {
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  return static_cast<std::int64_t>(mesh.positions.size()) - triangles / 2;
}

TriangleMesh hullOf(const TriangleMesh& mesh, const HullOptions& options) {
  TriangleMesh hull;
  REQUIRE(makeHull(mesh, options, {}, hull));
  return hull;
}

std::pair<double, double> distances(const TriangleMesh& from, const TriangleMesh& to) {
  const Surface surface(to);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const SurfacePoint& p : surface.closest(from.positions)) {
    least = std::min(least, p.distance);
    most = std::max(most, p.distance);
  }
  return {least, most};
}

}  // namespace

TEST_CASE("a hull is closed, outwards, and as far away as it was asked to be", "[cages][hull]") {
  const TriangleMesh ball = sphere({4, -2, 1}, 3);
  const HullOptions options{.closing = 0.3, .offset = 0.2, .voxels = 60};
  const TriangleMesh hull = hullOf(ball, options);
  CHECK(closedManifold(hull));
  CHECK(eulerNumber(hull) == 2);
  const double spacing = 6.6 / 55;
  const auto [least, most] = distances(hull, ball);
  CHECK(least > 0.2 - 0.15 * spacing);
  CHECK(most < 0.2 + 0.5 * spacing);
  CHECK(volume(hull) > 4.0 / 3 * std::numbers::pi * 27);
}

TEST_CASE("a hull encloses whatever it is made for", "[cages][hull]") {
  TriangleMesh card;  // Flat, open, and seen from both sides.
  card.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
  card.triangles = {{0, 1, 2}, {2, 3, 0}, {0, 2, 1}};
  for (const double closing : {0.0, 0.1}) {
    const TriangleMesh hull = hullOf(card, {.closing = closing, .offset = 0.08, .voxels = 50});
    CHECK(closedManifold(hull));
    CHECK(distances(card, hull).first > 0.06);
    for (const SurfacePoint& p : Surface(hull).closest(card.positions)) CHECK(p.height < 0);
  }
}

TEST_CASE("gaps narrower than twice the closing are bridged, wider ones are not", "[cages][hull]") {
  const TriangleMesh two = together(sphere({0, 0, 0}, 1), sphere({2.3, 0, 0}, 1));
  CHECK(volume(hullOf(two, {.closing = 0.25, .offset = 0.05, .voxels = 80})) > 9);
  // Apart: only one of them is kept, the larger one if they differ.
  const TriangleMesh apart = together(sphere({0, 0, 0}, 0.8), sphere({2.3, 0, 0}, 1));
  const TriangleMesh hull = hullOf(apart, {.closing = 0.1, .offset = 0.05, .voxels = 80});
  CHECK(volume(hull) == Approx(4.0 / 3 * std::numbers::pi * 1.05 * 1.05 * 1.05).epsilon(0.03));
  CHECK(closedManifold(hull));
}

TEST_CASE("of several bodies a hull has the largest, or the one that is asked for", "[cages][hull]") {
  const TriangleMesh both = together(sphere({0, 0, 0}, 1), sphere({3, 0, 0}, 0.5));
  HullOptions options{.closing = 0.1, .offset = 0.05, .voxels = 48};
  CHECK(boundsOf(hullOf(both, options)).middle().x == Approx(0).margin(0.1));
  options.near = Vec3{2, 0, 0};
  CHECK(boundsOf(hullOf(both, options)).middle().x == Approx(3).margin(0.1));
}

TEST_CASE("what is inside is not seen in a hull, even through a wide opening", "[cages][hull]") {
  const TriangleMesh bowl = sphere({0, 0, 0}, 1, 24, 8);
  const TriangleMesh hull =
      hullOf(together(bowl, sphere({0, -0.2, 0}, 0.2)), {.closing = 0.05, .offset = 0.03, .voxels = 60});
  CHECK(closedManifold(hull));
  CHECK(eulerNumber(hull) == 2);
  CHECK(volume(hull) > 0.8 * 4.0 / 3 * std::numbers::pi);
}

TEST_CASE("openings are found, the widest first", "[cages][hull]") {
  const TriangleMesh bowl = sphere({0, 0, 0}, 1, 24, 8);
  const TriangleMesh both = together(bowl, sphere({5, 0, 0}, 2, 24, 4));
  std::vector<Opening> openings;
  const TriangleMesh closed = closeOpenings(both, 0.1, &openings);
  REQUIRE(openings.size() == 2);
  CHECK(openings[0].width > openings[1].width);
  CHECK(openings[0].triangleCount == 48);
  CHECK(openings[1].firstTriangle == both.triangles.size() + 48);
  CHECK(closedManifold(closed));
  CHECK(closeOpenings(both, 10).triangles.size() == both.triangles.size());
}

TEST_CASE("a hull is the same in every run", "[cages][hull]") {
  const TriangleMesh ball = together(sphere({0, 0, 0}, 1), sphere({1.2, 0.3, 0}, 0.7));
  const HullOptions options{.closing = 0.1, .offset = 0.05, .voxels = 48};
  const TriangleMesh first = hullOf(ball, options), second = hullOf(ball, options);
  CHECK(first.triangles == second.triangles);
  CHECK(std::equal(first.positions.begin(), first.positions.end(), second.positions.begin(), second.positions.end(),
                   [](const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }));
}

TEST_CASE("a hull can be cancelled, and tells how far it is", "[cages][hull]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1);
  TriangleMesh hull;
  float last = -1;
  bool rising = true;
  CHECK(makeHull(
      ball, {.closing = 0.1, .offset = 0.05, .voxels = 60},
      [&](float share, const char* stage) {
        rising = rising && share >= last && share <= 1 && stage == std::string("hull");
        last = share;
        return true;
      },
      hull));
  CHECK(rising);
  CHECK(last == 1);
  for (const float until : {0.0f, 0.3f, 0.7f})
    CHECK_FALSE(makeHull(
        ball, {.closing = 0.1, .offset = 0.05, .voxels = 60}, [&](float share, const char*) { return share < until; },
        hull));
}

TEST_CASE("a hull asks in each of its stages whether it is cancelled", "[cages][hull]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1);
  for (const auto& [from, to] : {std::pair{0.6f, 0.65f}, {0.9f, 0.95f}, {0.95f, 1.0f}}) {
    INFO("between " << from << " and " << to);
    TriangleMesh hull;
    CHECK_FALSE(makeHull(
        ball, {.closing = 0.1, .offset = 0.05, .voxels = 100},
        [&](float share, const char*) { return !(share > from && share < to); }, hull));
  }
}
