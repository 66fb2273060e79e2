#include "landmarks/painted_face.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <functional>

#include "landmarks/landmark_list.hpp"
#include "shapes.hpp"
#include "views/base_color.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

using Bytes = std::array<std::uint8_t, 3>;

constexpr std::uint32_t kSide = 256;
constexpr Vec3 kEye{0.27, 0.05, 0}, kMouth{0, -0.45, 0};

/// What is painted on an egg.
struct Look {
  Bytes skin{224, 172, 140}, hair{70, 45, 30}, white{240, 240, 240}, iris{60, 90, 140}, lips{180, 90, 90};
  double eye = 0.13;       ///< Half the width of an eye.
  double hairline = 0.45;  ///< Its height above the eyes.
  double beard = -2;       ///< The height that it begins at.
  bool hasFace = true;
};

/// The colour at a place of the front, whose corners are -1 and 1.
Bytes colorAt(const Look& look, double x, double y) {
  const auto isWithin = [](double across, double up) { return across * across + up * up < 1; };
  if (look.hasFace) {
    const double across = std::abs(x) - kEye.x, up = y - kEye.y;
    if (isWithin(across / (0.4 * look.eye), up / (0.4 * look.eye))) return look.iris;
    if (isWithin(across / look.eye, up / (0.6 * look.eye))) return look.white;
    if (std::abs(across) < 1.2 * look.eye && std::abs(up - 0.22) < 0.025) return look.hair;  // A brow.
    if (isWithin(x / 0.2, (y - kMouth.y) / 0.06)) return look.lips;
  }
  return y > kEye.y + look.hairline || std::abs(x) > 0.6 || y < look.beard ? look.hair : look.skin;
}

/// An egg that faces +z, with a face that is painted on.
struct PaintedEgg {
  OwnedModel owned;
  std::vector<std::uint8_t> pixels;

  explicit PaintedEgg(const Look& look) {
    owned.add("egg", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 40));
    for (std::size_t i = 0; i < owned.positions.size(); i += 3) {
      const bool isFront = owned.positions[i + 2] > 0;
      owned.uvs.push_back(isFront ? 0.5f + 0.5f * owned.positions[i] : 0.001f);
      owned.uvs.push_back(isFront ? 0.5f - 0.5f * owned.positions[i + 1] : 0.001f);
    }
    for (std::uint32_t row = 0; row < kSide; ++row)
      for (std::uint32_t column = 0; column < kSide; ++column) {
        const Bytes color = colorAt(look, 2 * (column + 0.5) / kSide - 1, 1 - 2 * (row + 0.5) / kSide);
        pixels.insert(pixels.end(), {color[0], color[1], color[2], 255});
      }
  }
  [[nodiscard]] std::vector<Landmark> landmarks(const std::function<void(Model&)>& change = {}) const {
    Model model = owned.model();
    model.baseColors = {{.image = {kSide, kSide, pixels}}};
    if (change) change(model);
    FoundLandmarks out;
    const Status status = findLandmarks(model, nullptr, out);
    INFO(describe(status, model));
    REQUIRE(status.ok());
    return out.landmarks;
  }
};

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
