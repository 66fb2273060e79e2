#include "hull/hull.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "mesh/bounds.hpp"
#include "mesh/half_edges.hpp"
#include "mesh/surface.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

constexpr double kBall = 4.0 / 3 * std::numbers::pi;  ///< The volume of one of radius 1.

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle3& t : mesh.triangles)
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  return sum;
}

/// Every edge has one triangle on each side, which run along it in opposite directions.
bool closedManifold(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  return std::find(twins.begin(), twins.end(), kNone) == twins.end();
}

/// Vertices − edges + triangles of a closed surface: 2 without handles.
std::int64_t eulerNumber(const TriangleMesh& mesh) {
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  return static_cast<std::int64_t>(mesh.positions.size()) - triangles / 2;
}

TriangleMesh hullOf(const TriangleMesh& mesh, const HullOptions& options) {
  TriangleMesh hull;
  REQUIRE(makeHull(mesh, options, {}, hull));
  CHECK(closedManifold(hull));
  return hull;
}

/// Of the vertices of a mesh from another one.
std::pair<double, double> distances(const TriangleMesh& from, const TriangleMesh& to) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const SurfacePoint& p : Surface(to).closest(from.positions)) {
    least = std::min(least, p.distance);
    most = std::max(most, p.distance);
  }
  return {least, most};
}

}  // namespace

TEST_CASE("a hull is closed, outwards, and as far away as it was asked to be", "[cages][hull]") {
  const TriangleMesh ball = sphere({4, -2, 1}, 3);
  const TriangleMesh hull = hullOf(ball, {.closing = 0.3, .offset = 0.2, .voxels = 60});
  CHECK(eulerNumber(hull) == 2);
  const double spacing = 6.6 / 55;
  const auto [least, most] = distances(hull, ball);
  CHECK(least > 0.2 - 0.15 * spacing);
  CHECK(most < 0.2 + 0.5 * spacing);
  CHECK(volume(hull) > kBall * 27);
}

TEST_CASE("a hull encloses whatever it is made for", "[cages][hull]") {
  TriangleMesh card;  // Flat, open, and seen from both sides.
  card.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
  card.triangles = {{0, 1, 2}, {2, 3, 0}, {0, 2, 1}};
  for (const double closing : {0.0, 0.1}) {
    const TriangleMesh hull = hullOf(card, {.closing = closing, .offset = 0.08, .voxels = 50});
    CHECK(distances(card, hull).first > 0.06);
    for (const SurfacePoint& p : Surface(hull).closest(card.positions)) CHECK(p.height < 0);
  }
}

TEST_CASE("gaps narrower than twice the closing are bridged, wider ones are not", "[cages][hull]") {
  const TriangleMesh two = together(sphere({0, 0, 0}, 1), sphere({2.3, 0, 0}, 1));
  CHECK(volume(hullOf(two, {.closing = 0.25, .offset = 0.05, .voxels = 80})) > 9);
  const TriangleMesh one = hullOf(two, {.closing = 0.05, .offset = 0.05, .voxels = 80});
  CHECK(volume(one) == Approx(kBall * 1.05 * 1.05 * 1.05).epsilon(0.03));
}

TEST_CASE("of several bodies a hull has the largest, or the one that is asked for", "[cages][hull]") {
  const TriangleMesh both = together(sphere({0, 0, 0}, 1), sphere({3, 0, 0}, 0.5));
  HullOptions options{.closing = 0.1, .offset = 0.05, .voxels = 48};
  CHECK(boundsOf(hullOf(both, options)).middle().x == Approx(0).margin(0.1));
  options.near = Vec3{2, 0, 0};
  CHECK(boundsOf(hullOf(both, options)).middle().x == Approx(3).margin(0.1));
}

TEST_CASE("openings are closed, the widest first, so that what is inside is not seen in a hull", "[cages][hull]") {
  const TriangleMesh bowl = sphere({0, 0, 0}, 1, 24, 8);
  const TriangleMesh both = together(bowl, sphere({5, 0, 0}, 2, 24, 4));
  const std::vector<Opening> openings = findOpenings(both, 0.1);
  REQUIRE(openings.size() == 2);
  CHECK(openings[0].width > openings[1].width);
  CHECK(openings[0].loop.size() == 48);
  CHECK(closedManifold(closeOpenings(both, 0.1)));
  CHECK(closeOpenings(both, 10).triangles.size() == both.triangles.size());
  const TriangleMesh hull =
      hullOf(together(bowl, sphere({0, -0.2, 0}, 0.2)), {.closing = 0.05, .offset = 0.03, .voxels = 60});
  CHECK(eulerNumber(hull) == 2);
  CHECK(volume(hull) > 0.8 * kBall);
}

TEST_CASE("a hull tells how far it is, and can be cancelled in each of its stages", "[cages][hull]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1);
  const HullOptions options{.closing = 0.1, .offset = 0.05, .voxels = 100};
  TriangleMesh hull;
  const auto call = [&](const Progress& progress) {
    return makeHull(
        ball, options,
        [&](float share, const char* stage) {
          CHECK(stage == std::string("hull"));
          return progress(share, stage);
        },
        hull);
  };
  checkProgress(call, {-1, 0.3f, 0.6f, 0.65f, 0.9f, 0.95f, 1});
}
