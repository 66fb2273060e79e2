// Memory that runs out at any one allocation: the status says so, nothing is lost, and the next call is right.
//
// The linker hands every call of malloc to the functions below. Where each array of the arena is an allocation of its
// own, with AddressSanitizer, that is every place at which a step can fail.

#include "cagecast/split.hpp"
#include "cuts.hpp"
#include "hash.hpp"

using namespace cagecast;

namespace {

/// How many more allocations succeed; none is counted while this is not on.
thread_local bool isOn = false;
thread_local std::size_t left = 0;
thread_local bool ranOut = false;

/// @return false if this allocation has to fail.
bool mayTake() {
  if (!isOn) return true;
  if (left > 0) {
    --left;
    return true;
  }
  ranOut = true;
  return false;
}

}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);                                      // NOLINT: the linker's names
void* __wrap_malloc(std::size_t size);                                      // NOLINT
void* __real__Znwm(std::size_t size);                                       // NOLINT: operator new
void* __wrap__Znwm(std::size_t size);                                       // NOLINT
void* __real__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t&);  // NOLINT
void* __wrap__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t&);  // NOLINT

void* __wrap_malloc(std::size_t size) { return mayTake() ? __real_malloc(size) : nullptr; }  // NOLINT
void* __wrap__Znwm(std::size_t size) {                                                       // NOLINT
  if (!mayTake()) throw std::bad_alloc();
  return __real__Znwm(size);
}
void* __wrap__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t& tag) {  // NOLINT
  return mayTake() ? __real__ZnwmRKSt9nothrow_t(size, tag) : nullptr;
}
}

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
    left = n;
    ranOut = false;
    isOn = true;
    const Status status = call(workspace, hash);
    isOn = false;
    if (!ranOut) {
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

TransferOptions welding(TransferOptions options) {
  options.weldTolerance = 1e-4f;
  return options;
}

}  // namespace

TEST_CASE("wherever memory runs out in a transfer, the status says so and the next call is right", "[memory]") {
  const scenes::Scene scene = scenes::patchwork(1);
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
  const scenes::Scene scene = scenes::patchwork(1);
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
          if (status.ok()) hash.add(zones.scores);
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
