#include "mesh/check_model.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>

#include "mesh/limits.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

OwnedModel triangle() {
  OwnedModel out;
  out.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  out.indices = {0, 1, 2};
  return out;
}

}  // namespace

// What any mesh has to be is tested with the core (errors.test.cpp): one of each kind will do.
TEST_CASE("whatever is wrong with a model is said in a sentence", "[cages][check]") {
  struct Fault {
    std::string says;
    Code code;
    std::function<void(OwnedModel&)> make;
  };
  const auto scaled = [](float scale) {
    return [=](OwnedModel& m) {
      for (float& x : m.positions) x *= scale;
    };
  };
  const std::string far =
      " is too far from the origin: farther than a million times the size of the mesh, or than 4.2e37";
  const Fault faults[] = {
      {"model has no vertices; at least one is needed", Code::emptyMesh, [](auto& m) { m.positions.clear(); }},
      {"model.positions has 8 numbers, not 3 per vertex", Code::positionsNotTriples,
       [](auto& m) { m.positions.pop_back(); }},
      {"model.indices[1] = 3 is out of range (3 vertices)", Code::indexOutOfRange, [](auto& m) { m.indices[1] = 3; }},
      {"model.positions[4] = NaN is not a finite number", Code::nonFinitePosition,
       [](auto& m) { m.positions[4] = NAN; }},
      {"model.uvs[2] = Infinity is not a finite number", Code::nonFiniteUv,
       [](auto& m) { m.uvs = {0, 0, INFINITY, 0, 0, 0}; }},
      {"model.groups has 2 entries, not 1 for each of 3 vertices", Code::groupCountMismatch,
       [](auto& m) {
         m.groups = {0, 0};
       }},
      {"model has no triangle with an area", Code::flatMesh, [](auto& m) { m.positions[7] = 0; }},
      {"model.positions[2]" + far, Code::tooFar,
       [](auto& m) { m.positions[2] = m.positions[5] = m.positions[8] = 1e7f; }},
      {"model.positions[3]" + far, Code::tooFar, scaled(6e37f)},
      {"model is smaller than 1e-37 across", Code::tooSmall, scaled(1e-38f)},
      {"model has 2000001 triangles and 3 vertices, at most 2000000 and 6000000 are allowed; simplify it first",
       Code::tooDetailed, [](auto& m) { m.indices.resize(3 * (kMaxModelTriangles + 1), 0); }},
      {"model has 1 triangles and 6000001 vertices, at most 2000000 and 6000000 are allowed; simplify it first",
       Code::tooDetailed, [](auto& m) { m.positions.resize(3 * (kMaxModelVertices + 1), 0); }},
      {"model has its triangles in too many layers: their area is 125 times the square of its diagonal, at most 50 "
       "times "
       "are allowed; leave out copies that lie in each other",
       Code::tooManyLayers,
       [](auto& m) {
         for (int copies = 0; copies < 499; ++copies) m.indices.insert(m.indices.end(), {0, 1, 2});
       }},
      {"model.groups[1] = 1, but there are 1 parts", Code::partOutOfRange,
       [](auto& m) {
         m.groups = {0, 1, 1};
         m.parts = {"skin"};
       }},
      {"model.marks has 2 entries, not 1 for each of 1 triangles", Code::markCountMismatch,
       [](auto& m) {
         m.marks = {1, 0};
       }},
  };
  CHECK(checkModel(triangle().model()).ok());
  for (const auto& [says, code, make] : faults) {
    OwnedModel owned = triangle();
    make(owned);
    const Model model = owned.model();
    const Status status = checkModel(model);
    CHECK(status.argument == Argument::model);
    CHECK(status.code == code);
    CHECK(describe(status, model) == says);
  }
  const OwnedModel owned = triangle();
  Model model = owned.model();
  model.joints = {{"hips", {0, NAN, 0}, -1}};
  CHECK(describe(checkModel(model), model) == "model.joints[0].position is not finite");
  model.joints = {{"hips", {0, 0, 0}, 1}};
  CHECK(describe(checkModel(model), model) == "model.joints[0].parent = 1, but there are 1 joints");
  model.joints[0].parent = -1;
  std::vector<std::uint16_t> holders = {kNoJoint, 0};
  model.vertexJoints = holders;
  CHECK(describe(checkModel(model), model) == "model.vertexJoints has 2 entries, not 1 for each of 3 vertices");
  holders = {kNoJoint, 0, 1};
  model.vertexJoints = holders;
  CHECK(describe(checkModel(model), model) == "model.vertexJoints[2] is not less than the number of joints, 1");
  model.vertexJoints = {};
  const std::vector<std::uint8_t> pixel = {1, 2, 3, 255};
  const std::string bad =
      "model.baseColors[0] has a factor outside 0..1, or an image without 4 bytes per pixel or "
      "without UVs to lie by";
  for (const BaseColor& color :
       {BaseColor{.factor = {0, NAN, 0}}, BaseColor{.factor = {0, 0, 1.5f}}, BaseColor{.image = {1, 2, pixel}},
        BaseColor{.image = {1U << 31, 1U << 31, pixel}}, BaseColor{.image = {1, 1, pixel}}}) {
    model.baseColors = {color};
    CHECK(describe(checkModel(model), model) == bad);
  }
  const std::vector<float> uvs(6);
  model.mesh.uvs = uvs;
  CHECK(checkModel(model).ok());
  const std::vector<std::uint32_t> groups = {0, 1, 1};
  model.mesh.groups = groups;
  CHECK(describe(checkModel(model), model) == "model.groups[1] = 1, but there are 1 base colors");
}

TEST_CASE("every code has a sentence", "[cages][check]") {
  const OwnedModel owned = triangle();
  const Model model = owned.model();
  const Template from{model.mesh, {{"chin", {0, 0, 0}}, {"crown", {0, 1, 0}}}};
  FitOptions options;
  options.landmarks = from.landmarks;
  for (int code = 0; code <= static_cast<int>(Code::cageOff); ++code)
    for (const Argument argument : {Argument::cage, Argument::model, Argument::from, Argument::landmarks}) {
      const Status status{static_cast<Code>(code), argument};
      CAPTURE(code, codeName(status.code));
      const std::string fault = describe(status, from, model, options);
      CHECK(fault.size() > 1);
      CHECK(fault.find_first_of("{}") == std::string::npos);
      CHECK(std::string(codeName(status.code)) != "unknown");
    }
}
