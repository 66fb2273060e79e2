#include <algorithm>

#include "checks.hpp"

using namespace cagecast;

namespace {

// No rotation; quarters and eighths of a turn, which keep rays on the lattice; and some that do neither.
constexpr std::array<std::array<int, 4>, 7> kRotations{
    {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 1}, {0, 1, 1, 0}, {3, 1, -2, 1}, {7, -1, 0, 2}, {5, 4, -3, 2}}};

}  // namespace

TEST_CASE("no ray leaks through the edges and corners of a closed cage, and none hits a convex target", "[lattice]") {
  for (const auto& rotation : kRotations) {
    for (const int cells : {1, 2, 5, 8}) {
      const scenes::Scene scene = scenes::lattice(cells);
      const scenes::Mesh cage = rotated(scene.cage, rotation), target = rotated(scene.target, rotation);
      const TransferResult result = transferred(cage.view(), target.view());
      INFO(scene.name << " rotated by " << rotation[0] << ' ' << rotation[1] << ' ' << rotation[2] << ' '
                      << rotation[3]);
      const auto& zones = result.zones.zones;
      CHECK(std::count(zones.begin(), zones.end(), Zone::uncovered) == 0);
      CHECK(std::count(zones.begin(), zones.end(), Zone::occluded) == 0);
      CHECK(std::count(zones.begin(), zones.end(), Zone::culled) == 0);
      requireSameAsReference(scene.name, cage.view(), target.view());
    }
  }
}

TEST_CASE("a closed lattice in a larger one occludes all that is in it", "[lattice]") {
  // Both walls on the lattice: the rays of the inner box go through edges and corners of the outer one.
  for (const auto& rotation : kRotations) {
    const scenes::Scene scene = scenes::lattice(6);
    scenes::Mesh target = scenes::box({}, {4, 4, 4}, 4);
    const std::size_t inner = target.vertexCount();
    append(target, scene.target);
    const scenes::Mesh cage = rotated(scene.cage, rotation), turned = rotated(target, rotation);
    const TransferResult result = transferred(cage.view(), turned.view());
    INFO("rotated by " << rotation[0] << ' ' << rotation[1] << ' ' << rotation[2] << ' ' << rotation[3]);
    const auto* zones = result.zones.zones.begin();
    CHECK(std::count(zones, zones + inner, Zone::occluded) == static_cast<std::ptrdiff_t>(inner));
    requireSameAsReference(scene.name, cage.view(), turned.view());
  }
}

TEST_CASE("a ray along a wall does not hit the wall", "[lattice]") {
  // A wall that stands on the floor and is open at the top: rays from its foot run in its plane.
  scenes::Mesh target;
  const auto quad = [&](scenes::Point a, scenes::Point b, scenes::Point c, scenes::Point d) {
    const std::uint32_t first = target.addVertex(a);
    target.addVertex(b);
    target.addVertex(c);
    target.addVertex(d);
    target.addTriangle(first, first + 1, first + 2);
    target.addTriangle(first, first + 2, first + 3);
  };
  quad({0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2});  // The floor: x = 0, facing +x.
  for (float x = 1; x < 4; ++x)
    quad({x, -1, 0}, {x, 1, 0}, {x + 1, 1, 0}, {x + 1, -1, 0});  // The wall: z = 0, above a gap.
  target.addVertex({0, 0, 0});                                   // The foot of the wall, in no triangle.
  const std::uint32_t foot = static_cast<std::uint32_t>(target.vertexCount() - 1);
  const scenes::Mesh cage = scenes::box({-7.5f, 0, 0}, {12.5f, 100, 100}, 1);
  for (const auto& rotation : kRotations) {
    const scenes::Mesh turnedCage = rotated(cage, rotation), turned = rotated(target, rotation);
    const reference::Result expected = reference::transfer(turnedCage.view(), turned.view());
    const TransferResult result = transferred(turnedCage.view(), turned.view());
    const reference::Differences found = compare(expected, result, turned.view());
    INFO(found.details);
    CHECK(found.total() == 0);
    if (rotation == kRotations[0]) CHECK(result.projection.zones[foot] != Zone::occluded);
  }
}

TEST_CASE("stairs are the reference's at every rotation", "[lattice]") {
  const scenes::Scene scene = scenes::stairs();
  for (const auto& rotation : kRotations)
    requireSameAsReference(scene.name, rotated(scene.cage, rotation).view(), rotated(scene.target, rotation).view());
}

TEST_CASE("a cage of quads cut along other diagonals covers as well", "[lattice]") {
  scenes::Scene scene = scenes::lattice(5);
  for (std::size_t t = 0; t + 1 < scene.cage.triangleCount(); t += 2) {
    // a b c, a c d becomes a b d, b c d.
    std::uint32_t* quad = &scene.cage.indices[t * 3];
    const std::uint32_t b = quad[1], d = quad[5];
    quad[2] = d;
    quad[3] = b;
  }
  requireSameAsReference("other diagonals", scene.cage.view(), scene.target.view());
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  CHECK(std::count(result.zones.zones.begin(), result.zones.zones.end(), Zone::cosmetic) ==
        static_cast<std::ptrdiff_t>(scene.target.vertexCount()));
}
