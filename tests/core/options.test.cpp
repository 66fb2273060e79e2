#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "checks.hpp"

using namespace cagecast;
using Catch::Matchers::Contains;

namespace {

/// An option of options.def that is a number.
struct NumberOption {
  Option option;
  std::string name;
  bool isOfProject;
  std::array<float, 2> range;
  float& (*in)(TransferOptions&);
};

std::vector<NumberOption> numberOptions() {
  std::vector<NumberOption> all;
  enum Stage : bool { classify = false, project = true };
#define CAGECAST_ADD(stage, path, name, field, range) \
  all.push_back(                                      \
      {Option::name, path #name, stage, {CAGECAST_PAIR range}, [](TransferOptions& o) -> float& { return o.field; }});
#define CAGECAST_PAIR(low, high) low, high
#define CAGECAST_ADD_share(...) CAGECAST_ADD(__VA_ARGS__)
#define CAGECAST_ADD_length(...) CAGECAST_ADD(__VA_ARGS__)
#define CAGECAST_ADD_toggle(...)
#define CAGECAST_ADD_choice(type) CAGECAST_NOTHING
#define CAGECAST_NOTHING(...)
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) \
  CAGECAST_ADD_##kind(stage, "", name, name, range)
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) \
  CAGECAST_ADD_##kind(stage, "steps.", name, steps.name, range)
#include "cagecast/options.def"
  return all;
}

struct Call {
  scenes::Scene scene = scenes::head(8);
  TransferOptions options;

  Status transfer() const {
    TransferResult result;
    return cagecast::transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result);
  }
  Status project() const {
    Projection projection;
    return cagecast::project(scene.cage.view(), scene.target.view(), options, testWorkspace(), projection);
  }
  Status classify() const {
    Zones zones;
    return cagecast::classify({}, {}, options, zones);
  }
};

/// A target of two boxes, of which one is of group 7, in a cage of two boxes.
struct TwoGroups {
  scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  scenes::Mesh target = scenes::box({}, {1, 1, 1}, 1);

  TwoGroups() {
    append(target, scenes::box({0.2f, 0, 0}, {1.1f, 1, 1}, 1));
    target.groups.assign(target.vertexCount(), 0);
    std::fill(target.groups.begin() + 24, target.groups.end(), 7u);
  }
  /// @return The status, and who culls the two segments.
  std::pair<Status, std::vector<CulledBy>> transfer(const Locks& locks) const {
    TransferOptions options;
    options.locks = locks;
    TransferResult result;
    const Status status = cagecast::transfer(cage.view(), target.view(), options, testWorkspace(), result);
    return {status, copied(result.zones.culledBy)};
  }
  std::string text(const Status& status) const { return describe(status, cage.view(), target.view()); }
};

}  // namespace

TEST_CASE("every number in options.def is accepted within its range only, by the stage that reads it", "[options]") {
  const std::vector<NumberOption> all = numberOptions();
  REQUIRE(!all.empty());
  for (const auto& [option, name, isOfProject, range, in] : all) {
    INFO(name);
    Call call;
    for (const float good : range) {
      in(call.options) = good;
      CHECK(call.transfer().ok());
    }
    std::vector<float> wrong{kNaN, -0.01f, -kInfinity};
    if (std::isfinite(range[1])) wrong.insert(wrong.end(), {range[1] + 0.01f, kInfinity});
    for (const float bad : wrong) {
      in(call.options) = bad;
      const Status status = call.transfer();
      CHECK(status.code == Code::badOption);
      CHECK(status.argument == Argument::options);
      CHECK(status.option == option);
      CHECK_THAT(describe(status, {}, {}), Contains("options." + name + " = ") && Contains("not"));
      CHECK((call.project().option == option) == isOfProject);
      CHECK((call.classify().option == option) == !isOfProject);
    }
  }
}

TEST_CASE("a lock that is none of the three is an error", "[options]") {
  const TwoGroups call;
  const std::vector<LockEntry> locks{{1, Lock::keep}, {0, static_cast<Lock>(3)}};
  const std::vector<LockEntry> ofGroups{{7, static_cast<Lock>(200)}};
  const Status bySegment = call.transfer({locks, {}}).first;
  CHECK(bySegment.code == Code::badOption);
  CHECK(bySegment.option == Option::segmentLocks);
  CHECK(call.text(bySegment) == "options.locks.segments[0] = 3 is not one of (automatic, keep, exclude)");
  CHECK(call.text(call.transfer({{}, ofGroups}).first) ==
        "options.locks.groups[7] = 200 is not one of (automatic, keep, exclude)");
}

TEST_CASE("the sentence about an option names its value and its range", "[options]") {
  Call call;
  call.options.threshold = 2;
  CHECK(describe(call.transfer(), {}, {}) == "options.threshold = 2 is not within 0..1");
  call.options = {};
  call.options.weldTolerance = 0.5f;
  CHECK(describe(call.transfer(), {}, {}) == "options.weldTolerance = 0.5 is not within 0..0.01");
  call.options = {};
  call.options.occlusionReach = -1;
  CHECK(describe(call.transfer(), {}, {}) == "options.occlusionReach = -1 is not a number of at least 0");
  call.options = {};
  call.options.steps.floor = static_cast<Floor>(3);
  CHECK(describe(call.transfer(), {}, {}) == "options.steps.floor = 3 is not one of (none, area, depth)");
}

TEST_CASE("options as constructed are the preset `default`, and `paper` turns its steps off", "[options]") {
  constexpr TransferOptions standard, paper = TransferOptions::paper();
  static_assert(standard.seams == Seams::corner && standard.steps.floor == Floor::depth && standard.steps.recheck);
  static_assert(paper.seams == Seams::vertex && paper.steps.floor == Floor::none && !paper.steps.recheck);
  static_assert(standard.threshold == paper.threshold && paper.occlusionReach == kInfinity);
}

TEST_CASE("a lock decides over its segment or group, and one by segment over one by group", "[options][locks]") {
  const TwoGroups scene;
  using enum CulledBy;
  CHECK(scene.transfer({}).second == std::vector{none, none});
  const LockEntry first[] = {{0, Lock::exclude}};
  CHECK(scene.transfer({.segments = first}).second == std::vector{CulledBy::lock, none});
  const LockEntry seven[] = {{7, Lock::exclude}};
  CHECK(scene.transfer({.groups = seven}).second == std::vector{none, CulledBy::lock});
  const LockEntry second[] = {{1, Lock::keep}};
  CHECK(scene.transfer({.segments = second, .groups = seven}).second == std::vector{none, none});
  const LockEntry twice[] = {{1, Lock::keep}, {1, Lock::automatic}};
  CHECK(scene.transfer({.segments = twice, .groups = seven}).second == std::vector{none, none});
}

TEST_CASE("a lock of a segment or group that does not exist is an error", "[options][locks]") {
  const TwoGroups scene;
  const LockEntry stray[] = {{0, Lock::keep}, {2, Lock::keep}};
  const Status segment = scene.transfer({.segments = stray}).first;
  CHECK(segment.code == Code::badOption);
  CHECK(segment.option == Option::segmentLocks);
  CHECK(segment.at == 2);
  CHECK_THAT(scene.text(segment), Contains("options.locks.segments[2]") && Contains("no segment 2"));
  const Status group = scene.transfer({.groups = stray}).first;
  CHECK(group.code == Code::badOption);
  CHECK(group.option == Option::groupLocks);
  CHECK(group.at == 2);
  CHECK_THAT(scene.text(group), Contains("options.locks.groups[2]") && Contains("no segment of group 2"));
}

TEST_CASE("with minCovered 0 no segment that is covered at all is culled for its share", "[options]") {
  const scenes::Scene scene = scenes::patchwork(3);
  TransferOptions options;
  options.steps.twins = false;
  options.steps.floor = Floor::none;
  const TransferResult without = transferred(scene.cage.view(), scene.target.view(), options);
  for (const Floor floor : {Floor::area, Floor::depth}) {
    options.steps.floor = floor;
    options.minCovered = 0;
    const TransferResult result = transferred(scene.cage.view(), scene.target.view(), options);
    std::size_t covered = 0;
    for (std::size_t s = 0; s < result.zones.scores.size(); ++s) {
      const bool isCovered = result.projection.segmentStats[s].coveredArea > 0;
      covered += isCovered;
      CHECK(result.zones.scores[s] == (isCovered ? without.zones.scores[s] : 0));
    }
    CHECK(covered > 0);
  }
}
