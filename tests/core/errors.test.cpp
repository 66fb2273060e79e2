#include <cmath>
#include <limits>

#include "cagecast/clip.hpp"
#include "checks.hpp"

using namespace cagecast;
using Catch::Matchers::Contains;

namespace {

struct Case {
  scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1), target = scenes::box({}, {1, 1, 1}, 1);
  TransferOptions options = TransferOptions::paper();

  /// Transfers. `cutBorders` must find the same fault.
  Status run() const {
    TransferResult result;
    const Status status = transfer(cage.view(), target.view(), options, testWorkspace(), result);
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

/// Runs the call and checks its status and that the sentence names all of `words`.
void requireError(const Case& call, Code code, Argument argument, std::uint32_t at,
                  std::initializer_list<const char*> words) {
  const Status status = call.run();
  CHECK(status.code == code);
  CHECK(status.argument == argument);
  CHECK(status.at == at);
  const std::string text = call.text(status);
  for (const char* word : words) CHECK_THAT(text, Contains(word));
}

}  // namespace

TEST_CASE("an empty mesh is an error", "[errors]") {
  Case call;
  SECTION("no vertices") {
    call.target = {};
    requireError(call, Code::emptyMesh, Argument::target, 0, {"target", "no vertices"});
  }
  SECTION("no triangles") {
    call.cage.indices.clear();
    requireError(call, Code::emptyMesh, Argument::cage, 0, {"cage", "no triangles"});
  }
  SECTION("neither, both meshes: the cage comes first") {
    call.cage = call.target = {};
    requireError(call, Code::emptyMesh, Argument::cage, 0, {"cage"});
  }
}

TEST_CASE("array lengths that do not fit are errors", "[errors]") {
  Case call;
  SECTION("positions") {
    call.target.positions.pop_back();
    CHECK(call.run().code == Code::positionsNotTriples);
    CHECK(call.run().argument == Argument::target);
    CHECK_THAT(call.text(call.run()), Contains("target.positions") && Contains("71"));
  }
  SECTION("indices") {
    call.cage.indices.pop_back();
    CHECK(call.run().code == Code::indicesNotTriples);
    CHECK(call.run().argument == Argument::cage);
    CHECK_THAT(call.text(call.run()), Contains("cage.indices") && Contains("35"));
  }
  SECTION("no UVs on the cage") {
    call.cage.uvs.clear();
    requireError(call, Code::missingUvs, Argument::cage, 0, {"cage.uvs"});
  }
  SECTION("no UVs on the target is fine") {
    call.target.uvs.clear();
    CHECK(call.run().ok());
  }
  SECTION("too few UVs") {
    for (const bool onCage : {true, false}) {
      Case each;
      (onCage ? each.cage : each.target).uvs.pop_back();
      CHECK(each.run().code == Code::uvCountMismatch);
      CHECK(each.run().argument == (onCage ? Argument::cage : Argument::target));
      CHECK_THAT(each.text(each.run()), Contains(".uvs") && Contains("47") && Contains("24 vertices"));
    }
  }
  SECTION("too many groups") {
    call.target.groups.push_back(0);
    CHECK(call.run().code == Code::groupCountMismatch);
    CHECK(call.run().argument == Argument::target);
    CHECK_THAT(call.text(call.run()), Contains("target.groups") && Contains("25") && Contains("24 vertices"));
  }
}

TEST_CASE("the first index out of range is named", "[errors]") {
  for (const std::uint32_t bad : {24u, 1000u, UINT32_MAX}) {
    Case call;
    call.target.indices[17] = bad;
    call.target.indices[20] = UINT32_MAX;
    requireError(call, Code::indexOutOfRange, Argument::target, 17,
                 {"target.indices[17] = ", std::to_string(bad).c_str(), "is out of range (24 vertices)"});
    call = {};
    call.cage.indices[35] = bad;
    requireError(call, Code::indexOutOfRange, Argument::cage, 35, {"cage.indices[35]"});
  }
}

TEST_CASE("a number that is not finite is named, wherever it is", "[errors]") {
  for (const float bad : {kNaN, -kNaN, kInfinity, -kInfinity}) {
    for (std::uint32_t i = 0; i < 72; ++i) {
      Case call;
      call.target.positions[i] = bad;
      requireError(call, Code::nonFinitePosition, Argument::target, i, {"target.positions[", "not a finite number"});
      call = {};
      call.cage.positions[i] = bad;
      requireError(call, Code::nonFinitePosition, Argument::cage, i, {"cage.positions["});
    }
    for (std::uint32_t i = 0; i < 48; ++i) {
      Case call;
      call.target.uvs[i] = bad;
      requireError(call, Code::nonFiniteUv, Argument::target, i, {"target.uvs["});
      call = {};
      call.cage.uvs[i] = bad;
      requireError(call, Code::nonFiniteUv, Argument::cage, i, {"cage.uvs["});
    }
  }
}

TEST_CASE("a cage whose triangles all have no area is an error", "[errors]") {
  Case call;
  for (float& x : call.cage.positions) x = 1;
  requireError(call, Code::noUsableCageTriangle, Argument::cage, 0, {"cage", "area"});
}

TEST_CASE("a target whose triangles all have no area is not", "[errors]") {
  Case call;
  SECTION("all in one place") {
    for (float& x : call.target.positions) x = 1;
  }
  SECTION("all in a row") {
    for (std::size_t i = 0; i < call.target.positions.size(); ++i)
      if (i % 3 != 0) call.target.positions[i] = 0;
  }
  SECTION("one corner only") {
    for (std::uint32_t& index : call.target.indices) index = 0;
  }
  TransferResult result;
  REQUIRE(transfer(call.cage.view(), call.target.view(), TransferOptions::paper(), testWorkspace(), result).ok());
  CHECK(result.zones.zones.size() == 24);
  requireSameAsReference("flat", call.cage.view(), call.target.view());
  // Nor for cutting, whatever was decided.
  const std::vector<Zone> zones(24, Zone::cosmetic);
  const std::vector<std::uint32_t> segments(24, 0);
  const std::vector<CulledBy> culledBy(1, CulledBy::none);
  for (const TransferOptions& options : {TransferOptions::paper(), TransferOptions{}}) {
    CutTarget cut;
    REQUIRE(cutBorders(call.cage.view(), {call.target.view(), zones, segments, culledBy}, options, testWorkspace(), cut)
                .ok());
  }
}

TEST_CASE("sizes beyond the limits are errors before anything is read", "[errors]") {
  // Views of arrays that are not there: only their lengths may be looked at.
  const Case call;
  TransferResult result;
  MeshView huge = call.target.view();
  huge.uvs = {};
  huge.groups = {};
  SECTION("vertices") {
    huge.positions = {call.target.positions.data(), (std::size_t{kMaxVertices} + 1) * 3};
    const Status status = transfer(call.cage.view(), huge, TransferOptions::paper(), testWorkspace(), result);
    CHECK(status.code == Code::tooLarge);
    CHECK(status.argument == Argument::target);
    CHECK(status.at == kMaxVertices + 1);
    CHECK_THAT(describe(status, call.cage.view(), huge), Contains("268435457") && Contains("268435456"));
  }
  SECTION("triangles") {
    huge.indices = {call.target.indices.data(), (std::size_t{kMaxTriangles} + 1) * 3};
    const Status status = transfer(call.cage.view(), huge, TransferOptions::paper(), testWorkspace(), result);
    CHECK(status.code == Code::tooLarge);
    CHECK(status.at == kMaxTriangles + 1);
    CHECK_THAT(describe(status, call.cage.view(), huge), Contains("triangles"));
  }
}

TEST_CASE("coordinates too far from the origin are an error; meshes may be huge or tiny", "[errors]") {
  for (const float far : {3e30f, -3e38f, 1e12f}) {
    Case call;
    call.cage.positions[30] = far;
    const Status status = call.run();
    CHECK(status.code == Code::tooLarge);
    CHECK(status.argument == Argument::cage);
    CHECK(status.at == 30);
    CHECK_THAT(call.text(status), Contains("cage.positions[30]"));
  }
  for (const bool isCage : {true, false}) {
    // Distances between such positions would be infinite.
    Case call;
    for (scenes::Mesh* mesh : {&call.cage, &call.target})
      for (float& x : mesh->positions) x *= 1e37f;
    scenes::Mesh& mesh = isCage ? call.cage : call.target;
    mesh.positions[4] = -5e37f;
    const Status status = call.run();
    CHECK(status.code == Code::tooLarge);
    CHECK(status.argument == (isCage ? Argument::cage : Argument::target));
    CHECK(status.at == 4);
    CHECK_THAT(call.text(status), Contains("positions[4]") && Contains("4.2e37"));
  }
  for (const float factor : {1e-36f, 1e-30f, 1e-10f, 1e10f, 1e30f, 1e37f}) {
    Case call;
    for (scenes::Mesh* mesh : {&call.cage, &call.target})
      for (float& x : mesh->positions) x *= factor;
    TransferResult result;
    INFO("factor " << factor);
    REQUIRE(transfer(call.cage.view(), call.target.view(), TransferOptions::paper(), testWorkspace(), result).ok());
    for (const Zone zone : result.zones.zones) CHECK(zone == Zone::cosmetic);
    for (const float distance : result.projection.distances) CHECK(std::isfinite(distance));
  }
}

TEST_CASE("every code has a name of its own", "[errors]") {
  std::vector<std::string> names;
  for (int code = 0; code <= static_cast<int>(Code::outOfMemory); ++code)
    names.emplace_back(codeName(static_cast<Code>(code)));
  CHECK(names.front() == "ok");
  CHECK(names.back() == "outOfMemory");
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK(names[i] != names[j]);
}

TEST_CASE("arguments are named as in the sentences", "[errors]") {
  CHECK(argumentName(Argument::none) == std::string());
  CHECK(argumentName(Argument::cage) == std::string("cage"));
  CHECK(argumentName(Argument::target) == std::string("target"));
  CHECK(argumentName(Argument::options) == std::string("options"));
}

TEST_CASE("a weld tolerance that nearly all vertices lie within is an error that says what to do", "[errors]") {
  Case call;
  call.options.weldTolerance = 0.01f;
  // Of a box with a diagonal of more than 1, all of these lie within .01 of each other.
  const auto addCrowd = [&](std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) call.target.addVertex({1e-6f * static_cast<float>(i), 0, 0});
  };
  const auto transferred = [&] {
    TransferResult result;
    return transfer(call.cage.view(), call.target.view(), call.options, testWorkspace(), result);
  };
  addCrowd(2001);
  CHECK(transferred().ok());
  addCrowd(10);
  CHECK(transferred().ok());  // In the same places.
  call.target = scenes::box({}, {1, 1, 1}, 1);
  addCrowd(2050);
  const Status status = transferred();
  CHECK(status.code == Code::weldToleranceTooLarge);
  CHECK(status.argument == Argument::options);
  CHECK(status.at == 0);
  CHECK(status.option == Option::weldTolerance);
  CHECK(call.text(status) ==
        "options.weldTolerance = 0.01 is too large for target: its vertices have more than 2000 others so near, on "
        "average; use a smaller one");
  call.options.weldTolerance = 1e-5f;
  CHECK(transferred().ok());

  // Two crowds, each as near as that: exactly as many as may be near, and one more.
  call.options.weldTolerance = 0.01f;
  for (const std::uint32_t size : {2001u, 2002u}) {
    call.target = {};
    for (const float place : {0.0f, 1.0f})
      for (std::uint32_t i = 0; i < size; ++i) call.target.addVertex({place + 1e-6f * static_cast<float>(i), 0, 0});
    call.target.addTriangle(0, 1, size);
    CHECK(transferred().ok() == (size == 2001));
  }
}
