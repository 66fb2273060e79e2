// Memory that runs out at any one allocation: the status says so, nothing is lost, and the next call is right.
//
// Where each array of the arena is an allocation of its own, with AddressSanitizer, that is every place at which a step
// can fail.

#include <cmath>

#include "c/c_mesh.hpp"
#include "cagecast/split.hpp"
#include "cuts.hpp"
#include "hash.hpp"
#include "out_of_memory/failing.hpp"

using namespace cagecast;

namespace {

/// Lets `call` run out of memory at its first allocation, its second, and so on, each time with a new workspace.
/// @param call   Takes a workspace and a hash for its results, and returns a status.
/// @return How many allocations it makes.
template <typename Call>
std::size_t failEverywhere(const Call& call) {
  std::string expected;
  {
    Workspace workspace;
    Hash hash;
    REQUIRE(call(workspace, hash).ok());
    expected = hash.text();
  }
  for (std::size_t n = 0;; ++n) {
    INFO("allocation " << n);
    Workspace workspace;
    Hash hash;
    failing::start(n);
    const Status status = call(workspace, hash);
    if (!failing::stop()) {
      CHECK(status.ok());
      CHECK(hash.text() == expected);
      return n;
    }
    if (status.code != Code::outOfMemory) {
      CHECK(status.code == Code::outOfMemory);
      return n;
    }
    Hash again;
    // Not each time: it takes longer than the call that failed.
    if (n % 16 != 0) continue;
    REQUIRE(call(workspace, again).ok());
    CHECK(again.text() == expected);
  }
}

/// A scene with two poses, in which a half of the target moves.
scenes::Scene posed(scenes::Scene scene) {
  for (const float by : {0.1f, -0.2f}) {
    for (std::size_t v = 0; v < scene.target.vertexCount(); ++v) {
      scenes::Point p = scene.target.vertex(v);
      if (p[0] > 0) p[1] += by;
      scene.target.poses.insert(scene.target.poses.end(), p.begin(), p.end());
    }
  }
  return scene;
}

TransferOptions welding(TransferOptions options) {
  options.weldTolerance = 1e-4f;
  return options;
}

}  // namespace

TEST_CASE("wherever memory runs out in a transfer, the status says so and the next call is right", "[memory]") {
  const scenes::Scene scene = posed(scenes::patchwork(1));
  for (const TransferOptions& options : {welding(TransferOptions{}), TransferOptions::paper()}) {
    const std::size_t count = failEverywhere([&](Workspace& workspace, Hash& hash) {
      TransferResult result;
      const Status status = transfer(scene.cage.view(), scene.target.view(), options, workspace, result);
      if (status.ok()) hash.add(result);
      return status;
    });
    CHECK(count > 15);
  }
}

TEST_CASE("wherever memory runs out when borders are cut, the status says so and the next call is right", "[memory]") {
  const scenes::Scene scene = posed(scenes::patchwork(1));
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), cutting());
  const DecidedTarget target{scene.target.view(), result.zones.zones, result.projection.segments,
                             result.zones.culledBy};
  const std::size_t count = failEverywhere([&](Workspace& workspace, Hash& hash) {
    CutTarget cut;
    const Status status = cutBorders(scene.cage.view(), target, cutting(), workspace, cut);
    if (status.ok()) hash.add(cut.indices);
    if (status.ok()) hash.add(cut.uvs);
    return status;
  });
  CHECK(count > 15);
}

TEST_CASE("wherever memory runs out when segments are judged or vertices split, the status says so", "[memory]") {
  const scenes::Scene scene = scenes::patchwork(1);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), TransferOptions{});
  const MeshView target = scene.target.view();
  CHECK(failEverywhere([&](Workspace&, Hash& hash) {
          Zones zones;
          const Status status = classify(result.projection.view(), target.indices, TransferOptions{}, zones);
          if (status.ok()) hash.add(zones.ratios);
          return status;
        }) > 3);
  const auto vertexCount = static_cast<std::uint32_t>(target.positions.size() / 3);
  CHECK(failEverywhere([&](Workspace&, Hash& hash) {
          SplitVertices split;
          const Status status = splitVertices(target.indices, result.projection.cornerUvs, vertexCount, split);
          if (status.ok()) hash.add(split.indices);
          return status;
        }) > 2);
}

TEST_CASE("wherever memory runs out in a call from C, its error says so, and the next call is right", "[memory]") {
  const scenes::Scene scene = scenes::patchwork(1);
  const CagecastMesh cage = cMesh(scene.cage), target = cMesh(scene.target);
  CagecastTransfer out{};
  const std::size_t count = failEverywhere([&](Workspace&, Hash& hash) {
    cagecastFreeTransfer(&out);
    if (cagecastTransfer(&cage, &target, nullptr, &out) != 0)
      return Status{std::string(out.error.code) == "outOfMemory" ? Code::outOfMemory : Code::aborted};
    hash.addBytes(out.uvs, 2 * sizeof(float) * out.vertexCount);
    return Status{};
  });
  cagecastFreeTransfer(&out);
  CHECK(count > 3);
}

TEST_CASE("what memory held before changes no result", "[memory]") {
  for (const scenes::Scene& scene : {scenes::patchwork(1), posed(scenes::patchwork(5)), posed(scenes::head(6))}) {
    std::vector<std::string> hashes;
    for (const int fill : {0, 1, 255}) {
      Workspace workspace;
      TransferResult result;
      CutTarget cut;
      failing::filling = fill;
      Status status = transfer(scene.cage.view(), scene.target.view(), cutting(), workspace, result);
      const DecidedTarget target{scene.target.view(), result.zones.zones, result.projection.segments,
                                 result.zones.culledBy};
      if (status.ok()) status = cutBorders(scene.cage.view(), target, cutting(), workspace, cut);
      failing::filling = -1;
      REQUIRE(status.ok());
      Hash hash;
      hash.add(result);
      hash.add(result.zones.ratios);
      hash.add(result.projection.recovery);
      hash.add(result.projection.cornerUvs);
      for (const HoleShare& share : result.projection.holeShares)
        hashes.push_back(std::to_string(share.hole) + " " + std::to_string(share.exposedArea));
      hash.add(cut.indices);
      hash.add(cut.uvs);
      hashes.push_back(hash.text());
    }
    const std::size_t third = hashes.size() / 3;
    REQUIRE(hashes.size() == 3 * third);
    for (std::size_t i = 0; i < 2 * third; ++i) CHECK(hashes[i] == hashes[i + third]);
  }
}

// Where a part that is met first has its areas is looked up in memory that nothing was written to yet.
TEST_CASE("the first part at a hole is listed, whatever memory held before", "[memory]") {
  const auto isAbove = [](scenes::Point p) { return p[2] > 1.9f && std::abs(p[0]) < 1 && std::abs(p[1]) < 1; };
  const scenes::Mesh cage = scenes::without(scenes::box({}, {2, 2, 2}, 8), isAbove);
  const scenes::Mesh target = scenes::box({}, {1.8f, 1.8f, 1.8f}, 6);
  TransferOptions options;
  options.steps.recheck = false;
  for (const int fill : {0, 255}) {
    Workspace workspace;
    TransferResult result;
    failing::filling = fill;
    const Status status = transfer(cage.view(), target.view(), options, workspace, result);
    failing::filling = -1;
    REQUIRE(status.ok());
    INFO("memory held " << fill);
    REQUIRE(result.projection.holeShares.size() == 1);
    CHECK(result.projection.holeShares[0].uncoveredArea > 1);
  }
}
