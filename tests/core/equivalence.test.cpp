#include "checks.hpp"

using namespace cagecast;

TEST_CASE("the answer is the reference's on strewn triangles", "[equivalence]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 30; ++seed) {
    const scenes::Scene scene = scenes::strewn(seed, seed % 3 == 0 ? 1500 : 40);
    INFO("CAGECAST_SEED=" << seed);
    const auto found = requireSameAsReference(scene.name, scene.cage.view(), scene.target.view());
    CHECK(found.unstable * 100 <= found.vertices * 2);
  }
}

TEST_CASE("the answer is the reference's where everything lies on a grid", "[equivalence]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 20; ++seed) {
    const scenes::Scene scene = scenes::gridded(seed, seed % 2 == 0 ? 60 : 400);
    INFO("CAGECAST_SEED=" << seed);
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view());
    const std::array<int, 4> turn{3, 1, -2, 1};
    requireSameAsReference(scene.name + " rotated", rotated(scene.cage, turn).view(),
                           rotated(scene.target, turn).view());
  }
}

TEST_CASE("the answer is the reference's where the cage's triangles crowd in one plane, and in one place",
          "[equivalence]") {
  // No pivot between the ends of such a row is near its middle.
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 10; ++seed) {
    scenes::Scene scene = scenes::strewn(seed, 600);
    scenes::Mesh& cage = scene.cage;
    for (std::size_t i = 0; i < cage.positions.size(); i += 3) {
      float& x = cage.positions[i];
      x = x * x * x * x * x * x * x;
    }
    for (int copy = 0; copy < 50; ++copy) cage.addTriangle(cage.indices[0], cage.indices[1], cage.indices[2]);
    INFO("CAGECAST_SEED=" << seed);
    requireSameAsReference(scene.name + " crowded", cage.view(), scene.target.view());
  }
}

TEST_CASE("the answer is the reference's with nothing but single triangles", "[equivalence]") {
  // Every triangle a segment of its own: the threshold decides each by itself.
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    scenes::Scene scene = scenes::strewn(seed, 300);
    scenes::Mesh apart;
    for (const std::uint32_t index : scene.target.indices)
      apart.addVertex(scene.target.vertex(index), 0, 0, static_cast<std::uint32_t>(apart.vertexCount() / 3));
    for (std::uint32_t i = 0; i < apart.vertexCount(); i += 3) apart.addTriangle(i, i + 1, i + 2);
    INFO("CAGECAST_SEED=" << seed);
    for (const float threshold : {0.0f, 0.3f, 0.5f, 1.0f}) {
      TransferOptions options = TransferOptions::paper();
      options.threshold = threshold;
      requireSameAsReference(scene.name, scene.cage.view(), apart.view(), options);
    }
  }
}

TEST_CASE("the answer is the reference's on a head", "[equivalence]") {
  for (const int cells : {8, 16, 31}) {
    const scenes::Scene scene = scenes::head(cells);
    const auto found = requireSameAsReference(scene.name, scene.cage.view(), scene.target.view());
    CHECK(found.unstable * 100 <= found.vertices);
  }
}

TEST_CASE("the answer is the reference's on all fixed scenes", "[equivalence]") {
  for (const scenes::Scene& scene : scenes::golden())
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view());
}

TEST_CASE("the answer is the reference's for a box in a ball and a ball in a box", "[equivalence]") {
  const scenes::Mesh ball = scenes::ellipsoid({0.1f, 0, 0}, {1, 1, 1}, 9);
  const scenes::Mesh smallBox = scenes::box({0, 0.05f, 0}, {0.4f, 0.5f, 0.3f}, 7);
  const scenes::Mesh largeBox = scenes::box({0, 0, 0.2f}, {1.5f, 1.4f, 1.6f}, 1);
  requireSameAsReference("box in ball", ball.view(), smallBox.view());
  requireSameAsReference("ball in box", largeBox.view(), ball.view());
}

TEST_CASE("the answer is the reference's where the target sticks out of the cage", "[equivalence]") {
  const scenes::Mesh cage = scenes::ellipsoid({}, {1, 1, 1}, 6);
  requireSameAsReference("shifted", cage.view(), scenes::ellipsoid({0.5f, 0.2f, 0}, {0.9f, 0.9f, 0.9f}, 10).view());
  requireSameAsReference("larger", cage.view(), scenes::ellipsoid({}, {1.3f, 1.3f, 1.3f}, 10).view());
  requireSameAsReference("far off", cage.view(), scenes::ellipsoid({50, 0, 0}, {1, 1, 1}, 10).view());
}

TEST_CASE("the answer is the reference's when vertices are welded within a tolerance", "[equivalence]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    scenes::Scene scene = scenes::head(10);
    scenes::Random random(seed);
    for (float& x : scene.target.positions) x += random.between(-1e-6f, 1e-6f);
    TransferOptions options = TransferOptions::paper();
    options.weldTolerance = 1e-4f;
    INFO("CAGECAST_SEED=" << seed);
    requireSameAsReference(scene.name, scene.cage.view(), scene.target.view(), options);
  }
}
