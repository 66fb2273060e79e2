#include "cage/boundary_loops.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "base/arena.hpp"
#include "clip/boundary_lines.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"
#include "reference/scene.hpp"
#include "scenes/scenes.hpp"
#include "search/cage_tree.hpp"
#include "seed.hpp"

using namespace cagecast;

namespace {

/// One cage triangle, the second of three, some of whose edges and corners are on a loop.
struct LoneTriangle {
  LoneTriangle(const float (&positions)[9], const bool (&openEdges)[3], const bool (&openCorners)[3] = {}) {
    const std::uint32_t indices[3] = {0, 1, 2};
    const float uvs[6] = {};
    gatherCage({positions, indices, uvs}, Units{}, arena, cage);
    std::fill(std::begin(loopOf), std::end(loopOf), BoundaryLoops::kNone);
    std::uint32_t* own = loopOf + 6 * kIndex;
    for (std::size_t k = 0; k < 3; ++k) {
      if (openCorners[k]) own[3 + k] = 0;
      if (!openEdges[k]) continue;
      own[k] = own[3 + k] = own[3 + (k + 1) % 3] = 0;
    }
    loops.loopOf = loopOf;
  }
  [[nodiscard]] const CageTriangle& triangle() const { return cage.triangles[0]; }
  [[nodiscard]] std::uint32_t elementAt(Vec3 q, double diagonal) const {
    return loops.elementAt(triangle(), kIndex, q, diagonal);
  }
  [[nodiscard]] bool areSurelyOff(std::span<const Vec3> hull, double diagonal = 1) const {
    return loops.areSurelyOff(triangle(), kIndex, hull, diagonal);
  }
  [[nodiscard]] bool areSurelyOn(std::span<const Vec3> hull) const {
    return loops.areSurelyOn(triangle(), kIndex, hull);
  }
  [[nodiscard]] bool isOnLoop(Vec3 p, double diagonal = 1) const {
    const Vec3 q = positionOf(triangle(), closestPointOnTriangle(triangle(), p));
    return elementAt(q, diagonal) != BoundaryLoops::kNone;
  }

  Arena arena;
  Cage cage;
  BoundaryLoops loops;

 private:
  static constexpr std::uint32_t kIndex = 1;
  std::uint32_t loopOf[18];
};

/// A cage with its boundary loops.
struct LoopedCage {
  explicit LoopedCage(const MeshView& mesh) {
    REQUIRE(gatherCage(mesh, Units{}, arena, cage));
    REQUIRE(findHalfEdges(mesh, cage, arena, halfEdges));
    REQUIRE(findBoundaryLoops(cage, halfEdges, arena, loops));
  }
  [[nodiscard]] bool isOpen(std::uint32_t halfEdge) const { return halfEdges.nextOfEdge[halfEdge] == halfEdge; }

  Arena arena;
  Cage cage;
  HalfEdges halfEdges;
  BoundaryLoops loops;
};

}  // namespace

TEST_CASE("a point is on a loop up to a millionth of the diagonal from its edges and corners", "[borders]") {
  const float positions[9] = {0, 0, 0, 4, 0, 0, 1, 3, 0};
  for (const double diagonal : {1.0, 1.75}) {
    for (const double distance : {0.9e-6 * diagonal, 1.1e-6 * diagonal}) {
      CAPTURE(diagonal, distance);
      const bool isClose = distance < 1e-6 * diagonal;
      const LoneTriangle edge(positions, {true, false, false}), corner(positions, {}, {false, true, false});
      CHECK(edge.elementAt({2, distance, 0}, diagonal) == (isClose ? 0 : BoundaryLoops::kNone));
      CHECK(corner.elementAt({4 - distance, 0, 0}, diagonal) == (isClose ? 4 : BoundaryLoops::kNone));
    }
  }
}

TEST_CASE("what is surely off or on a loop is so at every point", "[borders]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> share(-1, 1);
  std::uniform_int_distribution<int> coin(0, 1), power(0, 5);
  const auto anywhere = [&](double size) {
    return size * Vec3{static_cast<double>(share(random)), static_cast<double>(share(random)),
                       static_cast<double>(share(random))};
  };
  std::size_t off = 0, on = 0, surelyOff = 0, surelyOn = 0;
  for (int round = 0; round < 40000; ++round) {
    // Triangles from the size of the target down to that of the tolerance, and parts much smaller than they.
    const double size = std::pow(0.1, power(random)), width = 0.2 * size * std::pow(0.1, power(random));
    const double diagonal = 1 + coin(random);
    float positions[9];
    for (float& x : positions) x = static_cast<float>(size) * share(random);
    const LoneTriangle lone(positions, {coin(random) != 0, coin(random) != 0, coin(random) != 0},
                            {coin(random) != 0, coin(random) != 0, coin(random) != 0});
    if (lone.cage.count == 0) continue;
    const Vec3 centre = anywhere(2 * size);
    const Vec3 hull[3] = {centre + anywhere(width), centre + anywhere(width), centre + anywhere(width)};
    const bool areOff = lone.areSurelyOff(hull, diagonal);
    const bool areOn = lone.areSurelyOn(hull);
    int seenOn = 0;
    constexpr int kSeen = 9;
    for (int i = 0; i < kSeen; ++i) {
      const auto a = static_cast<double>(share(random) + 1) / 2, b = static_cast<double>(share(random) + 1) / 2;
      const Vec3 p = i < 3 ? hull[i] : hull[0] + a * (hull[1] - hull[0]) + (1 - a) * b * (hull[2] - hull[0]);
      const bool isOn = lone.isOnLoop(p, diagonal);
      if (areOff || areOn) REQUIRE(isOn == areOn);
      seenOn += isOn;
    }
    if (size < 1e-3) continue;
    off += seenOn == 0;
    on += seenOn == kSeen;
    surelyOff += areOff;
    surelyOn += areOn;
  }
  // Mostly it is known: what is not takes the time to look closer.
  CHECK(surelyOff > off - off / 50);
  CHECK(surelyOn > on - on / 50);
}

TEST_CASE("points nearest to an inner edge or corner are off the loop, wherever the open edge points", "[borders]") {
  // An obtuse triangle whose long edge from (0, 0) to (4, 0) is open; (-1, 1) is closest to the inner edge at the left,
  // and outside the lines of all three edges are points closest to the inner corner.
  const float obtuse[9] = {0, 0, 0, 4, 0, 0, -2, 1, 0};
  const LoneTriangle lone(obtuse, {true, false, false});
  const auto areOff = [&](Vec3 p) {
    const Vec3 hull[3] = {p, p + Vec3{0.01, 0, 0}, p + Vec3{0, 0.01, 0}};
    REQUIRE_FALSE(lone.isOnLoop(p));
    return lone.areSurelyOff(hull);
  };
  CHECK(areOff({-1.2, 0.2, 0}));   // Closest to the edge from (-2, 1) to (0, 0),
  CHECK(areOff({-1.2, -0.5, 0}));  // also below the line of the open edge.
  CHECK(areOff({-4, -0.5, 0}));    // Closest to the corner (-2, 1).
}

TEST_CASE("the loops of any few triangles are the reference's", "[borders]") {
  constexpr std::uint32_t kVertices = 8;
  scenes::Random random(7);
  for (int round = 0; round < 2000; ++round) {
    scenes::Mesh mesh;
    for (std::uint32_t v = 0; v < kVertices; ++v)
      mesh.addVertex({random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    for (std::uint32_t count = 1 + random.below(20); count > 0; --count) {
      const std::uint32_t a = random.below(kVertices), b = random.below(kVertices), c = random.below(kVertices);
      if (a != b && b != c && c != a) mesh.addTriangle(a, b, c);
    }
    const reference::Scene expected = reference::makeScene(mesh.view(), mesh.view());
    const LoopedCage cage(mesh.view());
    const BoundaryLoops& loops = cage.loops;
    REQUIRE(cage.cage.count == expected.loops.loopOfEdge.size());
    REQUIRE(loops.count == expected.loops.loops.size());
    // They may be numbered in another order.
    std::map<std::int32_t, std::uint32_t> numbers{{-1, BoundaryLoops::kNone}};
    for (std::uint32_t i = 0; i < 3 * cage.cage.count; ++i) {
      const std::uint32_t t = i / 3, k = i % 3;
      const std::int32_t ofCorner = expected.loops.loopOfCorner[t][k], ofEdge = expected.loops.loopOfEdge[t][k];
      CHECK(loops.loopOf[6 * t + 3 + k] == numbers.try_emplace(ofCorner, loops.loopOf[6 * t + 3 + k]).first->second);
      CHECK(loops.loopOf[6 * t + k] == (ofEdge < 0 ? BoundaryLoops::kNone : numbers[ofCorner]));
    }
    for (std::size_t loop = 0; loop < loops.count; ++loop) {
      const BoundaryLoops::Box& box = loops.boxes[numbers[static_cast<std::int32_t>(loop)]];
      CHECK(box.diagonal() == Approx(expected.loops.loops[loop].box.diagonal()));
    }
  }
}

TEST_CASE("the box of a loop is around its own vertices", "[borders]") {
  // Four triangles around a tip. Of each, another edge is open.
  const float positions[15] = {1, 2, 5, 4, 2, 5, 4, 8, 7, 1, 8, 7, 2, 3, 12};
  const std::uint32_t indices[12] = {0, 1, 4, 4, 1, 2, 3, 4, 2, 3, 0, 4};
  const float uvs[10] = {};
  const LoopedCage cage({positions, indices, uvs});
  const BoundaryLoops& loops = cage.loops;
  REQUIRE(cage.cage.count == 4);
  REQUIRE(loops.count == 1);
  CHECK(std::vector<double>(loops.boxes[0].low, loops.boxes[0].low + 3) == std::vector<double>{1, 2, 5});
  CHECK(std::vector<double>(loops.boxes[0].high, loops.boxes[0].high + 3) == std::vector<double>{4, 8, 7});
  CHECK(loops.boxes[0].diagonal() == Approx(7));
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t t = i / 3, k = i % 3;
    INFO("triangle " << t << ", corner and edge " << k);
    CHECK(loops.loopOf[6 * t + 3 + k] == (indices[i] == 4 ? BoundaryLoops::kNone : 0));
    const bool isInner = indices[i] == 4 || indices[3 * t + (k + 1) % 3] == 4;
    CHECK(loops.loopOf[6 * t + k] == (isInner ? BoundaryLoops::kNone : 0));
  }
}

TEST_CASE("the distance to the open edges is that to the nearest of them", "[borders]") {
  scenes::Random random(5);
  for (int round = 0; round < 20; ++round) {
    // Strewn triangles: of every three, two share an edge, which is not open.
    scenes::Mesh mesh;
    const auto coordinate = [&] { return random.between(-1, 1); };
    for (std::uint32_t t = 0; t < 60; ++t) {
      const scenes::Point p{coordinate(), coordinate(), coordinate()};
      for (int k = 0; k < 3; ++k)
        mesh.addVertex({p[0] + 0.2f * coordinate(), p[1] + 0.2f * coordinate(), p[2] + 0.2f * coordinate()});
      mesh.addTriangle(3 * t, 3 * t + 1, 3 * t + 2);
      if (t % 2 == 1) mesh.addTriangle(3 * t + 1, 3 * t, 3 * t - 1);
    }
    LoopedCage cage(mesh.view());
    Units units;
    units.diagonal = 1;
    units.sceneSize = 3;
    CageTree tree;
    REQUIRE(buildCageTree(cage.cage, units, cage.arena, tree));
    const BoundaryLines lines(cage.cage, tree, cage.loops, cage.arena);
    REQUIRE_FALSE(cage.arena.failed());
    for (int i = 0; i < 50; ++i) {
      const Vec3 p{static_cast<double>(2 * coordinate()), static_cast<double>(2 * coordinate()),
                   static_cast<double>(2 * coordinate())};
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t halfEdge = 0; halfEdge < 3 * cage.cage.count; ++halfEdge) {
        if (!cage.isOpen(halfEdge)) continue;
        const CageTriangle& t = cage.cage.triangles[halfEdge / 3];
        const float* corners[3] = {t.a, t.b, t.c};
        const std::uint32_t k = halfEdge % 3;
        const Vec3 from = Vec3::from(corners[k]), to = Vec3::from(corners[(k + 1) % 3]);
        const double share = std::clamp(dot(p - from, to - from) / dot(to - from, to - from), 0.0, 1.0);
        least = std::min(least, length(p - from - share * (to - from)));
      }
      CHECK(lines.distance(p) == Approx(least));
    }
  }
}
