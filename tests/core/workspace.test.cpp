#include <algorithm>
#include <utility>

#include "checks.hpp"
#include "cuts.hpp"
#include "hash.hpp"
#include "variants.hpp"

using namespace cagecast;

namespace {

struct Task {
  scenes::Scene scene;
  TransferOptions options;

  /// @return The status, and the hash of the answer if it is ok.
  std::pair<Status, std::string> run(Workspace& workspace) const {
    TransferResult result;
    const Status status = transfer(scene.cage.view(), scene.target.view(), options, workspace, result);
    Hash hash;
    hash.add(result);
    hash.add(result.projection.cornerUvs);
    return {status, status.ok() ? hash.text() : ""};
  }
};

/// What a call may find something in that an earlier one has left.
struct Kept {
  Workspace workspace;
  TransferResult result;
  CutTarget cut;

  /// @param call  0 projects and classifies, 1 transfers, 2 cuts borders as well.
  /// @return The status, and the hash of all that there is then.
  std::pair<Status, std::string> run(std::uint32_t call, const scenes::Scene& scene, const TransferOptions& options) {
    const MeshView cage = scene.cage.view(), target = scene.target.view();
    Projection& projection = result.projection;
    Zones& zones = result.zones;
    Status status;
    if (call == 0) {
      status = project(cage, target, options, workspace, projection);
      if (status.ok()) status = classify(projection.view(), target.indices, options, zones);
    } else {
      status = transfer(cage, target, options, workspace, result);
    }
    Hash hash;
    if (call == 2 && status.ok()) {
      const DecidedTarget decided{target, zones.zones, projection.segments, zones.culledBy};
      status = cutBorders(cage, decided, options, workspace, cut);
      if (status.ok()) hash.add(cut.sources, cut.weights, cut.indices, cut.origins, cut.uvs, cut.cornerUvs, cut.zones);
    }
    if (!status.ok()) return {status, ""};
    hash.add(result);
    hash.add(projection.cornerUvs, projection.distances, projection.visibility, projection.recovery,
             projection.hiddenBy, projection.hiders, zones.cosmeticTriangles, zones.culledBy, zones.explainedHoles);
    return {status, hash.text()};
  }
};

Task smallTask() { return {scenes::patchwork(1), {}}; }
Task largeTask() { return {scenes::head(20), {}}; }

}  // namespace

TEST_CASE("any calls, some of which fail, give with what was used before what they give with new", "[workspace]") {
  scenes::Random random(firstSeed());
  Kept used;
  std::size_t failures = 0;
  for (int i = 0; i < 60; ++i) {
    scenes::Scene scene = random.below(3) == 0 ? scenes::crowdedHead(4 + static_cast<int>(random.below(3)), 0.06f)
                                               : scenes::patchwork(random.next());
    TransferOptions options = anyOptions(random);
    const LockEntry lock{random.below(3), Lock::exclude};  // A segment 2 is seldom there.
    if (random.below(4) == 0) options.locks = {&lock, 1};
    const std::uint32_t fault = random.below(12), call = random.below(3);
    if (fault == 0) scene.target.indices.back() = 1u << 30;
    if (fault == 1) scene.cage.positions.back() = kNaN;
    if (fault == 2) options.threshold = 2;
    if (fault == 3) std::fill(scene.cage.positions.begin(), scene.cage.positions.end(), 1.0f);
    Kept fresh;
    const auto [status, answer] = fresh.run(call, scene, options);
    const auto [again, sameAnswer] = used.run(call, scene, options);
    INFO("call " << i << " of kind " << call << ", fault " << fault << ", CAGECAST_SEED=" << firstSeed());
    CHECK(again.code == status.code);
    CHECK(again.at == status.at);
    CHECK(sameAnswer == answer);
    failures += !status.ok();
  }
  CHECK(failures > 5);
  CHECK(failures < 40);
}

TEST_CASE("two workspaces do not disturb each other", "[workspace]") {
  const Task small = smallTask(), large = largeTask();
  Workspace a, b;
  const std::string ofSmall = small.run(a).second, ofLarge = large.run(b).second;
  CHECK(large.run(a).second == ofLarge);
  CHECK(small.run(b).second == ofSmall);
}

TEST_CASE("a workspace can be moved, and what it was moved from used again", "[workspace]") {
  const Task task = smallTask();
  Workspace from;
  const std::string expected = task.run(from).second;
  Workspace to = std::move(from);
  CHECK(task.run(to).second == expected);
  CHECK(task.run(from).second == expected);
  from = std::move(to);
  CHECK(task.run(from).second == expected);
  CHECK(task.run(to).second == expected);
  from.release();
  CHECK(task.run(from).second == expected);
}

TEST_CASE("wherever memory runs out, the status says so and the next call is right", "[workspace]") {
  for (const Task& task : {smallTask(), Task{scenes::patchwork(2), TransferOptions::paper()}, largeTask()}) {
    Workspace enough;
    const std::string expected = task.run(enough).second;
    std::size_t failures = 0;
    for (std::size_t limit = 0;; limit += std::size_t{1} << 16) {
      Workspace workspace(limit);
      const auto [status, hash] = task.run(workspace);
      if (status.ok()) {
        CHECK(hash == expected);
        break;
      }
      ++failures;
      CHECK(status.code == Code::outOfMemory);
      workspace = Workspace();
      CHECK(task.run(workspace).second == expected);
    }
    CHECK(failures > 1);
  }
}
