// Which of two cage triangles wins where both are equally near, and the tie rule itself.

#include "clip/tie.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <vector>

#include "input/cage.hpp"
#include "scenes/scenes.hpp"

using namespace cagecast;

namespace {

/// A cage and its memory.
struct SmallCage {
  Arena arena;
  Cage cage{};

  explicit SmallCage(const scenes::Mesh& mesh) { REQUIRE(gatherCage(mesh.view(), Units{}, arena, cage)); }
  [[nodiscard]] Candidate at(std::uint32_t t, Vec3 p) const {
    return {t, closestPointOnTriangle(cage.triangles[t], p)};
  }
};

/// Two triangles at an edge, and two more at one of its ends.
scenes::Mesh fan(scenes::Random& random) {
  scenes::Mesh mesh;
  const auto coordinate = [&] { return random.between(-0.5f, 0.5f); };
  for (int v = 0; v < 6; ++v) {
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(coordinate());
    mesh.uvs.insert(mesh.uvs.end(), {0, 0});
  }
  mesh.indices = {0, 1, 2, 1, 0, 3, 0, 4, 5, 0, 5, 2};
  return mesh;
}

/// A number in [low, high).
double uniform(scenes::Random& random, float low, float high) { return static_cast<double>(random.between(low, high)); }

/// A point in a box around 0.
Vec3 anywhere(scenes::Random& random, double size) {
  const auto one = [&] { return size * uniform(random, -1, 1); };
  const double x = one(), y = one();
  return {x, y, one()};
}

Vec3 mix(const std::array<Vec3, 3>& corners, scenes::Random& random) {
  double a = uniform(random, 0, 1), b = uniform(random, 0, 1);
  if (a + b > 1) a = 1 - a, b = 1 - b;
  return (1 - a - b) * corners[0] + a * corners[1] + b * corners[2];
}

}  // namespace

TEST_CASE("a triangle that surely loses a tie is the nearest at no point of the part", "[tie][borders]") {
  scenes::Random random(7);
  int proofs = 0, ties = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const SmallCage small(fan(random));
    const Vec3 centre = anywhere(random, 2);
    const double size = uniform(random, 0.001f, 0.4f);
    std::array<Vec3, 3> hull;
    for (Vec3& p : hull) p = centre + anywhere(random, size);
    for (std::uint32_t loser = 0; loser < small.cage.count; ++loser) {
      for (std::uint32_t winner = 0; winner < small.cage.count; ++winner) {
        if (winner == loser || !losesTie(small.cage, loser, winner, hull, 1)) continue;
        ++proofs;
        for (int i = 0; i < 8; ++i) {
          const Vec3 p = i < 3 ? hull[static_cast<std::size_t>(i)] : mix(hull, random);
          const Candidate both[] = {small.at(loser, p), small.at(winner, p)};
          ties += both[0].point.distance - both[1].point.distance < kTieDistance;
          REQUIRE(nearestOf(both, 2, 1).cageTriangle == winner);
        }
      }
    }
  }
  CHECK(proofs > 10000);
  CHECK(ties > 10000);
}

TEST_CASE("triangles that share no corner, or a part on both sides of an edge, prove nothing", "[tie][borders]") {
  scenes::Mesh mesh;
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5f, 5, 5, 5, 6, 5, 5, 5, 6, 5};
  mesh.uvs.resize(14);
  mesh.indices = {0, 1, 2, 2, 1, 3, 4, 5, 6};
  const SmallCage small(mesh);
  const std::array<Vec3, 3> above{Vec3{0.1, 0.1, 1}, Vec3{0.2, 0.1, 1}, Vec3{0.1, 0.2, 1}};
  for (std::uint32_t loser = 0; loser < 3; ++loser) {
    for (std::uint32_t winner = 0; winner < 3; ++winner) CHECK_FALSE(losesTie(small.cage, loser, winner, above, 1));
  }
}

TEST_CASE("of equally near triangles the farthest plane wins, of equal planes the first triangle", "[tie]") {
  // Powers of two: sums and differences are exact.
  const double diagonal = 1;
  const auto candidate = [](std::uint32_t t, double distance, double height) {
    return Candidate{t, {distance, 0, 0, height, false}};
  };
  const auto winner = [&](std::vector<Candidate> list) {
    return nearestOf(list.data(), static_cast<std::uint32_t>(list.size()), diagonal).cageTriangle;
  };
  CHECK(winner({candidate(5, 1, 0), candidate(3, 1, 0)}) == 3);
  CHECK(winner({candidate(5, 1, 0.5), candidate(3, 1, 0.25)}) == 5);
  CHECK(winner({candidate(3, 1, 0.25), candidate(5, 1, -0.5)}) == 5);
  // At the limits themselves a triangle still counts as equally near and its plane as equally far.
  CHECK(winner({candidate(5, 0, 0.5), candidate(3, kTieDistance, 0.5)}) == 3);
  CHECK(winner({candidate(5, 0, 0.5), candidate(3, 2 * kTieDistance, 0.5)}) == 5);
  CHECK(winner({candidate(5, 0, kTiePlane), candidate(3, 0, 0)}) == 3);
  CHECK(winner({candidate(5, 0, 2 * kTiePlane), candidate(3, 0, 0)}) == 5);
  CHECK(winner({candidate(3, 0, 0.25), candidate(5, kTieDistance, 0.5)}) == 5);
  // A plane counts only if its triangle is near.
  CHECK(winner({candidate(1, 1, 9), candidate(5, 0, 0), candidate(3, 0, 0)}) == 3);
}

TEST_CASE("the axis that a ray runs along most is its z", "[tie]") {
  for (const double s : {1.0, -1.0}) {
    CHECK(RayDirection::along({s * 0.9, 0.3, 0.3}).rough.z == 0);
    CHECK(RayDirection::along({0.3, s * 0.9, 0.3}).rough.z == 1);
    CHECK(RayDirection::along({0.3, 0.3, s * 0.9}).rough.z == 2);
    CHECK(RayDirection::along({0.6, s * 0.7, 0.65}).rough.z == 1);
    CHECK(RayDirection::along({s * 0.7, 0.6, 0.65}).rough.z == 0);
    CHECK(RayDirection::along({0.6, 0.65, s * 0.7}).rough.z == 2);
    CHECK(RayDirection::along({0.65, 0.6, s * 0.7}).rough.z == 2);
  }
}
