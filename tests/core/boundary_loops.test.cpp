#include "cage/boundary_loops.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <vector>

#include "base/arena.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"

using namespace cagecast;

namespace {

/// One cage triangle, some of whose edges and corners are on a loop.
struct LoneTriangle {
  explicit LoneTriangle(const float (&positions)[9], const bool (&openEdges)[3]) {
    const std::uint32_t indices[3] = {0, 1, 2};
    const float uvs[6] = {};
    gatherCage({positions, indices, uvs}, Units{}, arena, cage);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!openEdges[k]) continue;
      loopOf[k] = loopOf[3 + k] = loopOf[3 + (k + 1) % 3] = 0;
    }
    loops.loopOf = loopOf;
  }
  [[nodiscard]] const CageTriangle& triangle() const { return cage.triangles[0]; }
  [[nodiscard]] bool isOnLoop(Vec3 p) const {
    return loops.at(triangle(), 0, positionOf(triangle(), closestPointOnTriangle(triangle(), p)), 1) !=
           BoundaryLoops::kNone;
  }

  Arena arena;
  Cage cage;
  BoundaryLoops loops;
  std::uint32_t loopOf[6] = {BoundaryLoops::kNone, BoundaryLoops::kNone, BoundaryLoops::kNone,
                             BoundaryLoops::kNone, BoundaryLoops::kNone, BoundaryLoops::kNone};
};

}  // namespace

TEST_CASE("what is surely off or on a loop is so at every point", "[borders]") {
  const std::uint32_t seed = std::random_device{}();
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> share(-1, 1);
  std::uniform_int_distribution<int> coin(0, 1);
  std::size_t off = 0, on = 0;
  for (int round = 0; round < 20000; ++round) {
    float positions[9];
    for (float& x : positions) x = share(random);
    const LoneTriangle lone(positions, {coin(random) != 0, coin(random) != 0, coin(random) != 0});
    if (lone.cage.count == 0) continue;
    const auto anywhere = [&](double size) {
      return size * Vec3{static_cast<double>(share(random)), static_cast<double>(share(random)),
                         static_cast<double>(share(random))};
    };
    const Vec3 centre = anywhere(2);
    const Vec3 hull[3] = {centre + anywhere(0.2), centre + anywhere(0.2), centre + anywhere(0.2)};
    const bool areOff = lone.loops.areSurelyOff(lone.triangle(), 0, hull, 1);
    const bool areOn = lone.loops.areSurelyOn(lone.triangle(), 0, hull);
    off += areOff;
    on += areOn;
    for (int i = 0; i < 8 && (areOff || areOn); ++i) {
      const auto a = static_cast<double>(share(random) + 1) / 2, b = static_cast<double>(share(random) + 1) / 2;
      const Vec3 p = hull[0] + a * (hull[1] - hull[0]) + (1 - a) * b * (hull[2] - hull[0]);
      REQUIRE(lone.isOnLoop(p) == areOn);
    }
  }
  CHECK(off > 1000);
  CHECK(on > 1000);
}

TEST_CASE("points nearest to an inner edge or corner are off the loop, wherever the open edge points", "[borders]") {
  // An obtuse triangle whose long edge from (0, 0) to (4, 0) is open; (-1, 1) is closest to the inner edge at the left,
  // and outside the lines of all three edges are points closest to the inner corner.
  const float obtuse[9] = {0, 0, 0, 4, 0, 0, -2, 1, 0};
  const LoneTriangle lone(obtuse, {true, false, false});
  const auto areOff = [&](Vec3 p) {
    const Vec3 hull[3] = {p, p + Vec3{0.01, 0, 0}, p + Vec3{0, 0.01, 0}};
    REQUIRE_FALSE(lone.isOnLoop(p));
    return lone.loops.areSurelyOff(lone.triangle(), 0, hull, 1);
  };
  CHECK(areOff({-1.2, 0.2, 0}));   // Closest to the edge from (-2, 1) to (0, 0),
  CHECK(areOff({-1.2, -0.5, 0}));  // also below the line of the open edge.
  CHECK(areOff({-4, -0.5, 0}));    // Closest to the corner (-2, 1).
}

TEST_CASE("the box of a loop is around its own vertices", "[borders]") {
  // Four triangles around a tip. Of each, another edge is open.
  const float positions[15] = {1, 2, 0, 4, 2, 0, 4, 8, 0, 1, 8, 0, 2, 3, 12};
  const std::uint32_t indices[12] = {0, 1, 4, 4, 1, 2, 3, 4, 2, 3, 0, 4};
  const float uvs[10] = {};
  const MeshView mesh{positions, indices, uvs};
  Arena arena;
  Cage cage;
  HalfEdges halfEdges;
  BoundaryLoops loops;
  gatherCage(mesh, Units{}, arena, cage);
  REQUIRE(cage.count == 4);
  REQUIRE(findHalfEdges(mesh, cage, arena, halfEdges));
  REQUIRE(findBoundaryLoops(cage, halfEdges, arena, loops));
  REQUIRE(loops.count == 1);
  CHECK(std::vector<double>(loops.boxes[0].low, loops.boxes[0].low + 3) == std::vector<double>{1, 2, 0});
  CHECK(std::vector<double>(loops.boxes[0].high, loops.boxes[0].high + 3) == std::vector<double>{4, 8, 0});
  CHECK(loops.boxes[0].diagonal() == Approx(std::sqrt(45.0)));
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t t = i / 3, k = i % 3;
    INFO("triangle " << t << ", corner and edge " << k);
    CHECK(loops.loopOf[6 * t + 3 + k] == (indices[i] == 4 ? BoundaryLoops::kNone : 0));
    const bool isInner = indices[i] == 4 || indices[3 * t + (k + 1) % 3] == 4;
    CHECK(loops.loopOf[6 * t + k] == (isInner ? BoundaryLoops::kNone : 0));
  }
}
