// What is wrong with a call: the code, the argument, the place, and the sentence.

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "cagecast/clip.hpp"
#include "cagecast/split.hpp"
#include "checks.hpp"

using namespace cagecast;
using Catch::Matchers::Contains;

namespace {

struct Call {
  scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1), target = scenes::box({}, {1, 1, 1}, 1);
  TransferOptions options = TransferOptions::paper();

  Status transfer() const {
    TransferResult result;
    return cagecast::transfer(cage.view(), target.view(), options, testWorkspace(), result);
  }
  /// Transfers. `cutBorders` must find the same fault.
  Status run() const {
    const Status status = transfer();
    const std::vector<Zone> zones(target.vertexCount(), Zone::cosmetic);
    const std::vector<std::uint32_t> segments(target.vertexCount(), 0);
    const std::vector<CulledBy> culledBy(1, CulledBy::none);
    CutTarget cut;
    const Status other =
        cutBorders(cage.view(), {target.view(), zones, segments, culledBy}, options, testWorkspace(), cut);
    CHECK(other.code == status.code);
    CHECK(other.argument == status.argument);
    CHECK(other.at == status.at);
    CHECK(other.option == status.option);
    return status;
  }
  std::string text(const Status& status) const { return describe(status, cage.view(), target.view()); }
};

struct Fault {
  std::function<void(Call&)> make;
  Code code;
  Argument argument;
  std::uint32_t at;
  std::vector<std::string> words;  ///< What the sentence says.
};

void check(const Fault& fault) {
  Call call;
  fault.make(call);
  const Status status = call.run();
  const std::string text = call.text(status);
  INFO(text);
  CHECK(status.code == fault.code);
  CHECK(status.argument == fault.argument);
  CHECK(status.at == fault.at);
  for (const std::string& word : fault.words) CHECK_THAT(text, Contains(word));
}

constexpr auto kCage = Argument::cage, kTarget = Argument::target;

}  // namespace

TEST_CASE("meshes whose arrays do not fit together are errors", "[errors]") {
  const Fault faults[] = {
      {[](Call& of) { of.target = {}; }, Code::emptyMesh, kTarget, 0, {"target has no vertices"}},
      {[](Call& of) { of.cage.indices.clear(); }, Code::emptyMesh, kCage, 0, {"cage has no triangles"}},
      {[](Call& of) { of.cage = of.target = {}; }, Code::emptyMesh, kCage, 0, {"cage"}},
      {[](Call& of) { of.target.positions.pop_back(); }, Code::positionsNotTriples, kTarget, 71, {"target.positions"}},
      {[](Call& of) { of.cage.indices.pop_back(); }, Code::indicesNotTriples, kCage, 35, {"cage.indices has 35"}},
      {[](Call& of) { of.cage.uvs.clear(); }, Code::missingUvs, kCage, 0, {"cage.uvs"}},
      {[](Call& of) { of.target.uvs.clear(); }, Code::ok, Argument::none, 0, {}},
      {[](Call& of) { of.cage.uvs.pop_back(); }, Code::uvCountMismatch, kCage, 47, {"cage.uvs has 47", "24 vertices"}},
      {[](Call& of) { of.target.uvs.pop_back(); }, Code::uvCountMismatch, kTarget, 47, {"target.uvs has 47"}},
      {[](Call& of) { of.target.groups.push_back(0); },
       Code::groupCountMismatch,
       kTarget,
       25,
       {"target.groups has 25", "24 vertices"}},
      {[](Call& of) { of.target.indices[17] = 24, of.target.indices[20] = UINT32_MAX; },
       Code::indexOutOfRange,
       kTarget,
       17,
       {"target.indices[17] = 24 is out of range (24 vertices)"}},
      {[](Call& of) { of.cage.indices[35] = UINT32_MAX; },
       Code::indexOutOfRange,
       kCage,
       35,
       {"cage.indices[35] = 4294967295 is out of range"}},
      {[](Call& of) { std::fill(of.cage.positions.begin(), of.cage.positions.end(), 1.0f); },
       Code::noUsableCageTriangle,
       kCage,
       0,
       {"cage has no triangle with an area"}},
      {[](Call& of) { of.cage.positions[30] = 3e30f; }, Code::tooLarge, kCage, 30, {"cage.positions[30] = 3e+30"}},
      {[](Call& of) { of.cage.positions[30] = -3e38f; }, Code::tooLarge, kCage, 30, {"1e8 diagonals"}},
      {[](Call& of) { of.cage.positions[30] = 1e12f; }, Code::tooLarge, kCage, 30, {"too far from the origin"}}};
  for (const Fault& fault : faults) check(fault);
}

TEST_CASE("a number that is not finite is named, wherever it is", "[errors]") {
  for (const float bad : {kNaN, -kNaN, kInfinity, -kInfinity}) {
    for (std::uint32_t i = 0; i < 72; ++i) {
      check({[=](Call& of) { of.target.positions[i] = bad; },
             Code::nonFinitePosition,
             kTarget,
             i,
             {"target.positions[", "not a finite number"}});
      check({[=](Call& of) { of.cage.positions[i] = bad; }, Code::nonFinitePosition, kCage, i, {"cage.positions["}});
    }
    for (std::uint32_t i = 0; i < 48; ++i) {
      check({[=](Call& of) { of.target.uvs[i] = bad; }, Code::nonFiniteUv, kTarget, i, {"target.uvs["}});
      check({[=](Call& of) { of.cage.uvs[i] = bad; }, Code::nonFiniteUv, kCage, i, {"cage.uvs["}});
    }
  }
}

TEST_CASE("meshes may be huge or tiny, unless distances would not fit a float", "[errors]") {
  const auto scaled = [](float factor) {
    Call call;
    for (scenes::Mesh* mesh : {&call.cage, &call.target})
      for (float& x : mesh->positions) x *= factor;
    return call;
  };
  for (const float factor : {1e-36f, 1e-30f, 1e10f, 1e30f, 1e37f}) {
    const Call call = scaled(factor);
    INFO("factor " << factor);
    const TransferResult result = transferred(call.cage.view(), call.target.view());
    for (const Zone zone : result.zones.zones) CHECK(zone == Zone::cosmetic);
    for (const float distance : result.projection.distances) CHECK(std::isfinite(distance));
  }
  for (const bool isCage : {true, false}) {
    const auto beyond = [=](Call& of) {
      of = scaled(1e37f);
      (isCage ? of.cage : of.target).positions[4] = -5e37f;
    };
    check({beyond, Code::tooLarge, isCage ? kCage : kTarget, 4, {"positions[4]", "4.2e37"}});
  }
}

TEST_CASE("a target whose triangles all have no area is no error", "[errors]") {
  for (const int kind : {0, 1, 2}) {
    Call call;
    scenes::Mesh& target = call.target;
    for (std::size_t i = 0; i < target.positions.size(); ++i) {
      if (kind == 0) target.positions[i] = 1;                // All in one place.
      if (kind == 1 && i % 3 != 0) target.positions[i] = 0;  // All in a row.
    }
    if (kind == 2) std::fill(target.indices.begin(), target.indices.end(), 0u);
    requireSameAsReference("flat", call.cage.view(), target.view());
    for (const TransferOptions& options : {TransferOptions::paper(), TransferOptions{}}) {
      call.options = options;
      CHECK(call.run().ok());  // Nor for cutting, whatever was decided.
    }
  }
}

TEST_CASE("sizes beyond the limits are errors before anything is read", "[errors]") {
  // Views of arrays that are not there: only their lengths may be looked at.
  const Call call;
  TransferResult result;
  for (const bool hasVertices : {true, false}) {
    MeshView huge{call.target.positions, call.target.indices};
    if (hasVertices) huge.positions = {call.target.positions.data(), (std::size_t{kMaxVertices} + 1) * 3};
    if (!hasVertices) huge.indices = {call.target.indices.data(), (std::size_t{kMaxTriangles} + 1) * 3};
    const Status status = transfer(call.cage.view(), huge, call.options, testWorkspace(), result);
    CHECK(status.code == Code::tooLarge);
    CHECK(status.argument == kTarget);
    CHECK(status.at == kMaxVertices + 1);
    CHECK(describe(status, call.cage.view(), huge) ==
          std::string("target has 268435457 ") + (hasVertices ? "vertices" : "triangles") + ", more than 268435456");
  }
}

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
#undef CAGECAST_ADD
#undef CAGECAST_PAIR
  return all;
}

}  // namespace

TEST_CASE("every number in options.def is accepted within its range only, by the stage that reads it", "[options]") {
  for (const auto& [option, name, isOfProject, range, in] : numberOptions()) {
    INFO(name);
    Call call;
    for (const float good : range) {
      in(call.options) = good;
      CHECK(call.run().ok());
    }
    std::vector<float> wrong{kNaN, -0.01f, -kInfinity};
    if (std::isfinite(range[1])) wrong.insert(wrong.end(), {range[1] + 0.01f, kInfinity});
    for (const float bad : wrong) {
      in(call.options) = bad;
      const Status status = call.run();
      CHECK(status.code == Code::badOption);
      CHECK(status.argument == Argument::options);
      CHECK(status.option == option);
      CHECK_THAT(call.text(status), Contains("options." + name + " = ") && Contains("not"));
      Projection projection;
      Zones zones;
      CHECK((project(call.cage.view(), call.target.view(), call.options, testWorkspace(), projection).option ==
             option) == isOfProject);
      CHECK((classify({}, {}, call.options, zones).option == option) == !isOfProject);
    }
  }
}

TEST_CASE("the sentence about an option names its value and its range", "[options]") {
  const struct {
    void (*set)(TransferOptions&);
    const char* text;
  } cases[] = {
      {[](TransferOptions& o) { o.threshold = 2; }, "threshold = 2 is not within 0..1"},
      {[](TransferOptions& o) { o.weldTolerance = 0.5f; }, "weldTolerance = 0.5 is not within 0..0.01"},
      {[](TransferOptions& o) { o.occlusionReach = -1; }, "occlusionReach = -1 is not a number of at least 0"},
      {[](TransferOptions& o) { o.seams = static_cast<Seams>(3); }, "seams = 3 is not one of (vertex, corner)"},
      {[](TransferOptions& o) { o.steps.projection = static_cast<ProjectionMode>(9); },
       "steps.projection = 9 is not one of (nearestPoint, nearestVertex)"}};
  for (const auto& [set, text] : cases) {
    Call call;
    set(call.options);
    CHECK(call.text(call.run()) == std::string("options.") + text);
  }
}

TEST_CASE("options as constructed are the preset `default`, and `paper` turns its steps off", "[options]") {
  constexpr TransferOptions standard, paper = TransferOptions::paper();
  static_assert(standard.seams == Seams::corner && standard.steps.floor && standard.steps.recheck);
  static_assert(paper.seams == Seams::vertex && !paper.steps.floor && !paper.steps.recheck);
  static_assert(standard.threshold == paper.threshold && paper.occlusionReach == kInfinity);
}

TEST_CASE("a lock that is none of the three, or of nothing that exists, is an error", "[options][locks]") {
  using Locked = std::vector<LockEntry>;
  using Groups = std::vector<std::uint32_t>;
  const struct {
    Locked locks;
    Groups ignore, keep, exclude;
    Option option;
    std::uint32_t at;
    const char* text;
  } cases[] = {{{{0, static_cast<Lock>(3)}},
                {},
                {},
                {},
                Option::locks,
                0,
                "locks[0] = 3 is not one of (automatic, keep, exclude)"},
               {{{0, Lock::keep}, {2, Lock::keep}},
                {},
                {},
                {},
                Option::locks,
                2,
                "locks[2] is given, but there is no segment 2"},
               {{}, {2}, {}, {}, Option::ignoredParts, 2, "parts.ignore has group 2, of which there is no vertex"},
               {{}, {0}, {}, {}, Option::ignoredParts, 0, "parts.ignore has all groups of target: nothing is left"},
               {{}, {}, {0, 2}, {}, Option::keptParts, 2, "parts.keep has group 2, of which there is no vertex"},
               {{}, {}, {}, {2}, Option::excludedParts, 2, "parts.exclude has group 2, of which there is no vertex"}};
  for (const auto& [locks, ignore, keep, exclude, option, at, text] : cases) {
    Call call;
    call.options.locks = locks;
    call.options.parts = {ignore, keep, exclude};
    const Status status = call.transfer();
    CHECK(status.code == Code::badOption);
    CHECK(status.option == option);
    CHECK(status.at == at);
    CHECK(call.text(status) == std::string("options.") + text);
  }
}

TEST_CASE("a weld tolerance that nearly all vertices lie within is an error that says what to do", "[errors]") {
  Call call;
  call.options.weldTolerance = 0.01f;
  const auto crowd = [&](std::uint32_t count, float place) {
    for (std::uint32_t i = 0; i < count; ++i) call.target.addVertex({place + 1e-6f * static_cast<float>(i), 0, 0});
  };
  // Of a box with a diagonal of more than 1, all of these lie within .01 of each other.
  crowd(2001, 0);
  CHECK(call.transfer().ok());
  crowd(10, 0);
  CHECK(call.transfer().ok());  // In the same places.
  call.target = scenes::box({}, {1, 1, 1}, 1);
  crowd(2050, 0);
  const Status status = call.transfer();
  CHECK(status.code == Code::weldToleranceTooLarge);
  CHECK(status.argument == Argument::options);
  CHECK(status.option == Option::weldTolerance);
  CHECK(call.text(status) ==
        "options.weldTolerance = 0.01 is too large for target: its vertices have more than 2000 others so near, on "
        "average; use a smaller one");
  // Two crowds, each as near as that: exactly as many as may be near, and one more.
  for (const std::uint32_t size : {2001u, 2002u}) {
    call.target = {};
    crowd(size, 0), crowd(size, 1);
    call.target.addTriangle(0, 1, size);
    CHECK(call.transfer().ok() == (size == 2001));
  }
  call.options.weldTolerance = 1e-5f;
  CHECK(call.transfer().ok());
}

TEST_CASE("cage triangles that lie in each other by the thousand end the call, and the next one works", "[errors]") {
  Call usual;
  usual.options = {};
  for (const std::size_t layers : {100u, 40'000u}) {
    Call call = usual;
    for (std::size_t i = 1; i < layers; ++i)
      call.cage.indices.insert(call.cage.indices.end(), usual.cage.indices.begin(), usual.cage.indices.end());
    call.target = scenes::box({}, {1, 1, 1}, 60);
    const Status status = call.transfer();
    CAPTURE(layers, call.text(status));
    CHECK(status.code == (layers == 100 ? Code::ok : Code::tooComplex));
    CHECK(usual.transfer().ok());
  }
}

TEST_CASE("splitting says what is wrong with its arrays", "[errors][seams]") {
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 5};
  const std::vector<float> uvs(12);
  const MeshView mesh{{}, indices};
  SplitVertices split;
  const Status stray = splitVertices(indices, uvs, 5, split);
  CHECK(stray.code == Code::indexOutOfRange);
  CHECK(stray.at == 5);
  CHECK(describe(stray, {}, mesh) == "target.indices[5] = 5 is out of range");
  CHECK(describe(stray, {}, {}) == "target.indices[5] is out of range");
  CHECK(splitVertices(std::span(indices).first(4), uvs, 6, split).code == Code::indicesNotTriples);
  const Status few = splitVertices(indices, std::span(uvs).first(11), 6, split);
  CHECK(few.code == Code::cornerUvCountMismatch);
  CHECK(describe(few, {}, mesh) == "cornerUvs has 11 numbers, not 2 for each of 6 indices");
}

TEST_CASE("codes and arguments have names of their own", "[errors]") {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(Code::outOfMemory); ++code)
    names.insert(codeName(static_cast<Code>(code)));
  CHECK(names.size() == static_cast<std::size_t>(Code::outOfMemory) + 1);
  CHECK(codeName(Code::ok) == std::string("ok"));
  CHECK(codeName(Code::outOfMemory) == std::string("outOfMemory"));
  CHECK(argumentName(Argument::none) == std::string());
  CHECK(argumentName(Argument::cage) == std::string("cage"));
  CHECK(argumentName(Argument::target) == std::string("target"));
  CHECK(argumentName(Argument::options) == std::string("options"));
}
