#include "mesh/check_model.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace cagecast;
using namespace cagecast::cages;

namespace {

struct Arrays {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::vector<std::uint32_t> indices = {0, 1, 2};
  std::vector<std::uint32_t> groups = {};
  std::vector<float> uvs = {};

  [[nodiscard]] Model model() const {
    Model out;
    out.mesh = {positions, indices, uvs, groups};
    return out;
  }
  [[nodiscard]] std::string fault() const {
    const Outcome outcome = checkModel(model());
    CHECK((outcome.problem == Problem::badModel) != outcome.ok());
    return outcome.message;
  }
};

}  // namespace

TEST_CASE("whatever is wrong with a model is said in a sentence", "[cages][check]") {
  Arrays arrays;
  CHECK(arrays.fault().empty());
  const Arrays good = arrays;
  arrays.positions.clear();
  CHECK(arrays.fault() == "model has no vertices");
  arrays = good;
  arrays.indices.clear();
  CHECK(arrays.fault() == "model has no triangles");
  arrays = good;
  arrays.positions.pop_back();
  CHECK(arrays.fault() == "model.positions has 8 numbers, not three per vertex");
  arrays = good;
  arrays.indices.push_back(0);
  CHECK(arrays.fault() == "model.indices has 4 numbers, not three per triangle");
  arrays = good;
  arrays.indices[1] = 3;
  CHECK(arrays.fault() == "model.indices[1] = 3, but there are 3 vertices");
  for (const float x : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    arrays = good;
    arrays.positions[4] = x;
    CHECK(arrays.fault() == "model.positions[4] is not a finite number");
  }
  arrays = good;
  arrays.uvs = {0, 0, NAN, 0, 0, 0};
  CHECK(arrays.fault() == "model.uvs[2] is not a finite number");
  arrays.uvs.resize(4);
  CHECK(arrays.fault() == "model.uvs has 4 numbers for 3 vertices");
  arrays = good;
  arrays.groups = {0, 0};
  CHECK(arrays.fault() == "model.groups has 2 numbers for 3 vertices");
  arrays = good;
  arrays.positions[7] = 0;
  CHECK(arrays.fault() == "model has no triangle with an area");
  arrays = good;
  for (std::size_t v = 0; v < 3; ++v) arrays.positions[3 * v + 2] = 1e7f;
  CHECK(arrays.fault() == "model is more than a million times its size away from the origin");
  for (const auto& [scale, fault] : {std::pair{1e-38f, "model is smaller than 1e-37 across"},
                                     std::pair{6e37f, "model reaches farther than 4.2e37 from the origin"}}) {
    arrays = good;
    for (float& x : arrays.positions) x *= scale;
    CHECK(arrays.fault() == fault);
  }
  arrays = good;
  arrays.indices.resize(3 * (kMaxModelTriangles + 1), 0);
  CHECK(arrays.fault() == "model has 2000001 triangles, more than 2000000; simplify it first");
  arrays = good;
  arrays.positions.resize(3 * (kMaxModelVertices + 1), 0);
  CHECK(arrays.fault() == "model has 6000001 vertices, more than 6000000; simplify it first");
}

TEST_CASE("parts, marks and joints have to fit the model", "[cages][check]") {
  Arrays arrays;
  arrays.groups = {0, 1, 1};
  Model model = arrays.model();
  CHECK(checkModel(model).ok());
  model.parts = {"skin"};
  CHECK(checkModel(model).message == "model.groups[1] = 1, but there are 1 parts");
  model = arrays.model();
  const std::uint8_t marks[] = {1, 0};
  model.marks = marks;
  CHECK(checkModel(model).message == "model.marks has 2 numbers for 1 triangles");
  model = arrays.model();
  model.joints = {{"hips", {0, NAN, 0}, -1}};
  CHECK(checkModel(model).message == "model.joints[0].position is not finite");
  model.joints = {{"hips", {0, 0, 0}, 1}};
  CHECK(checkModel(model).message == "model.joints[0].parent = 1, but there are 1 joints");
}
