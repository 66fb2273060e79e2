#include "landmarks/painted_face.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

#include "landmarks/landmark_list.hpp"
#include "painted_egg.hpp"
#include "views/base_color.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// Checks that eyes and mouth are where they are painted.
/// @param placed  Where a place of the egg is now.
void checkFace(const std::vector<Landmark>& landmarks, const std::function<Vec3(const Vec3&)>& placed) {
  constexpr double kNear = 0.05;  ///< Eyes are 0.5 above the mouth.
  const auto check = [&](const std::string& name, const Vec3& truth) {
    CAPTURE(name);
    const auto place = placeOf(landmarks, name);
    REQUIRE(place);
    // The depth is that of the skin, or of an eyeball behind it.
    const Vec3 front = placed({0, 0, 1}), off = *place - placed(truth);
    CHECK(length(off - dot(off, front) * front) < kNear);
    CHECK(dot(front, *place) > 0.3);
  };
  check("eye_centre_left", kEye);
  check("eye_centre_right", {-kEye.x, kEye.y, 0});
  check("mouth_corner_left", {0.2, kMouth.y, 0});
  check("mouth_corner_right", {-0.2, kMouth.y, 0});
  check("lip_upper", {0, kMouth.y + 0.02, 0});
  check("lip_lower", {0, kMouth.y - 0.02, 0});
}

Vec3 same(const Vec3& p) { return p; }

}  // namespace

TEST_CASE("a painted face is found, whatever it looks like", "[cages][landmarks][painted]") {
  const Look looks[] = {
      {},
      {.skin = {92, 58, 40},
       .hair = {20, 15, 12},
       .white = {225, 220, 210},
       .iris = {50, 30, 20},
       .lips = {120, 55, 50}},
      {.skin = {110, 170, 80}, .hair = {200, 60, 160}, .iris = {200, 180, 40}, .lips = {50, 90, 40}},
      {.skin = {240, 230, 225}, .hair = {230, 220, 160}, .lips = {225, 170, 170}},
      {.eye = 0.2},
      {.eye = 0.08},
      {.hairline = 0.28},
      {.beard = -0.35},
  };
  for (const Look& look : looks) {
    CAPTURE(&look - looks);
    checkFace(PaintedEgg(look).landmarks(), same);
  }
}

TEST_CASE("a painted face may look anywhere", "[cages][landmarks][painted]") {
  const double angle = GENERATE(0.7, 1.5707963, 3.1, -2.0);
  CAPTURE(angle);
  const auto turned = [&](const Vec3& p) {
    return Vec3{std::cos(angle) * p.x + std::sin(angle) * p.z, p.y, std::cos(angle) * p.z - std::sin(angle) * p.x};
  };
  PaintedEgg egg({});
  egg.owned = egg.owned.mapped(turned);
  checkFace(egg.landmarks(), turned);
}

TEST_CASE("painted eyes without a mouth are found where bones say that there is a head",
          "[cages][landmarks][painted]") {
  const Look mouthless{.hair = Look{}.skin, .white = {40, 30, 30}, .iris = {40, 30, 30}, .lips = Look{}.skin};
  CHECK(placeOf(PaintedEgg(mouthless).landmarks(), "eye_centre_left") == std::nullopt);
  const PaintedEgg egg(mouthless);
  const std::vector<std::uint16_t> held(egg.owned.positions.size() / 3, 5);
  const auto landmarks = egg.landmarks([&](Model& model) {
    model.joints = {{"Hips", {0, -3, 0}},          {"Spine2", {0, -2, 0}, 0},
                    {"LeftArm", {1, -1.5f, 0}, 1}, {"RightArm", {-1, -1.5f, 0}, 1},
                    {"Neck", {0, -1.2f, 0}, 1},    {"Head", {0, -1, 0}, 4}};
    model.vertexJoints = held;
  });
  const auto eye = placeOf(landmarks, "eye_centre_left");
  REQUIRE(eye);
  CHECK(eye->x == Approx(kEye.x).margin(0.05));
  CHECK(eye->y == Approx(kEye.y).margin(0.05));
}

TEST_CASE("where no face is painted, none is found", "[cages][landmarks][painted]") {
  const auto withoutColors = [](Model& model) { model.baseColors.clear(); };
  const PaintedEgg blank({.hasFace = false});
  CHECK(blank.landmarks().size() == blank.landmarks(withoutColors).size());
  const PaintedEgg egg({});
  const auto isClear = [&](Model& model) { model.baseColors[0].factor = {0, 0, 0}; };
  CHECK(egg.landmarks(isClear).size() == egg.landmarks(withoutColors).size());
}

TEST_CASE("names and hints count more than what is painted", "[cages][landmarks][painted]") {
  PaintedEgg egg({});
  for (const double side : {0.2, -0.2}) {
    egg.owned.add("eye", sphere({side, 0.1, 0.78}, 0.1, 12));
    egg.owned.uvs.resize(2 * egg.owned.positions.size() / 3);
  }
  const auto landmarks = egg.landmarks([](Model& model) { model.baseColors.resize(model.parts.size()); });
  const auto eye = placeOf(landmarks, "eye_centre_left");
  REQUIRE(eye);
  CHECK(length(*eye - Vec3{0.2, 0.1, 0.78}) < 0.02);
  // Its mouth is not known by shape.
  REQUIRE(placeOf(landmarks, "mouth_corner_left"));
  CHECK(placeOf(landmarks, "mouth_corner_left")->x == Approx(0.2).margin(0.05));
}

TEST_CASE("a face that is painted on a hat is none", "[cages][landmarks][painted]") {
  PaintedEgg egg({});
  // The head of a bear, with a face like the one below it.
  TriangleMesh bear = mapped(sphere({0, 0, 0}, 1, 40), [](const Vec3& p) {
    return Vec3{0.9 * p.x, 1.3 + 0.7 * p.y, 0.2 + 0.9 * p.z};
  });
  const std::size_t first = egg.owned.positions.size();
  egg.owned.add("Bear_Hat", bear);
  for (std::size_t i = first; i < egg.owned.positions.size(); i += 3) {
    const bool isFront = egg.owned.positions[i + 2] > 0.2f;
    egg.owned.uvs.push_back(isFront ? 0.5f + 0.5f * egg.owned.positions[i] : 0.001f);
    egg.owned.uvs.push_back(isFront ? 0.5f - 0.5f * (egg.owned.positions[i + 1] - 1.3f) : 0.001f);
  }
  checkFace(egg.landmarks([](Model& model) { model.baseColors.push_back(model.baseColors[0]); }), same);
}

TEST_CASE("what looks like a face on a vehicle is none", "[cages][landmarks][painted]") {
  PaintedEgg egg({});
  egg.owned.add("wheels", sphere({0, -1, 0}, 0.2, 8));
  egg.owned.uvs.resize(2 * egg.owned.positions.size() / 3);
  const auto withColors = [](Model& model) { model.baseColors.resize(model.parts.size()); };
  CHECK(placeOf(egg.landmarks(withColors), "eye_centre_left") == std::nullopt);
  egg.owned.parts.back() = "feet";
  CHECK(placeOf(egg.landmarks(withColors), "eye_centre_left") != std::nullopt);
}

TEST_CASE("a base colour is a factor times a pixel, and nothing where that is transparent", "[cages][painted]") {
  OwnedModel owned;
  owned.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  owned.uvs = {1, 1, 2, 1, 1, 0};  // Repeated.
  owned.indices = {0, 1, 2};
  const std::vector<std::uint8_t> pixels = {255, 255, 255, 255, 255, 255, 255, 0, 255, 0, 0, 255, 0, 0, 0, 255};
  Model model = owned.model();
  model.baseColors = {{.image = {2, 2, pixels}}};
  const auto at = [&](double x, double y) { return baseColorAt(model, 0, {x, y, 0}); };
  REQUIRE(at(0.1, 0.9));
  CHECK(at(0.1, 0.9)->x == Approx(100).margin(0.1));
  CHECK_FALSE(at(0.7, 0.7));
  CHECK(at(0.1, 0.1)->x == Approx(53.2).margin(0.1));
  CHECK(at(0.1, 0.1)->y == Approx(80.1).margin(0.2));
  CHECK(at(0.7, 0.1)->x == Approx(0).margin(0.1));
  model.baseColors = {{.factor = {0.5f, 0.5f, 0.5f}}};
  CHECK(at(0.7, 0.7)->x == Approx(76.1).margin(0.1));
}
