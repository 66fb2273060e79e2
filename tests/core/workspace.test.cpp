#include <utility>

#include "checks.hpp"
#include "cuts.hpp"
#include "hash.hpp"

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

Task smallTask() { return {scenes::patchwork(1), {}}; }
Task largeTask() { return {scenes::head(20), {}}; }

}  // namespace

TEST_CASE("a workspace that was used before gives the same answer as a new one", "[workspace]") {
  const Task small = smallTask(), large = largeTask();
  Workspace fresh, other, reused;
  const std::string ofSmall = small.run(fresh).second, ofLarge = large.run(other).second;
  for (int i = 0; i < 3; ++i) {
    CHECK(large.run(reused).second == ofLarge);
    CHECK(small.run(reused).second == ofSmall);
  }
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
