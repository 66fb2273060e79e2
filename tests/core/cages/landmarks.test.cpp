#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "cagecast/cages.hpp"
#include "landmarks/head.hpp"
#include "landmarks/rig.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// A mesh of ellipsoids, each a part.
struct Balls {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices, groups;
  std::vector<std::string> parts;

  void add(const std::string& name, const Position& centre, const Position& radii) {
    constexpr std::uint32_t kRings = 16, kSides = 24;
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    const auto vertex = [&](double polar, double around) {
      const double unit[] = {std::sin(polar) * std::sin(around), std::cos(polar), std::sin(polar) * std::cos(around)};
      for (std::size_t k = 0; k < 3; ++k) positions.push_back(centre[k] + radii[k] * static_cast<float>(unit[k]));
      groups.push_back(static_cast<std::uint32_t>(parts.size()));
    };
    const double pi = std::acos(-1.0);
    vertex(0, 0);
    for (std::uint32_t ring = 1; ring < kRings; ++ring)
      for (std::uint32_t side = 0; side < kSides; ++side) vertex(pi * ring / kRings, 2 * pi * side / kSides);
    vertex(pi, 0);
    const auto at = [&](std::uint32_t ring, std::uint32_t side) {
      return ring == 0        ? first
             : ring == kRings ? first + 1 + (kRings - 1) * kSides
                              : first + 1 + (ring - 1) * kSides + side % kSides;
    };
    for (std::uint32_t ring = 0; ring < kRings; ++ring)
      for (std::uint32_t side = 0; side < kSides; ++side) {
        if (ring > 0) indices.insert(indices.end(), {at(ring, side), at(ring + 1, side), at(ring, side + 1)});
        if (ring + 1 < kRings)
          indices.insert(indices.end(), {at(ring, side + 1), at(ring + 1, side), at(ring + 1, side + 1)});
      }
    parts.push_back(name);
  }

  void turn(double angle) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    for (std::size_t i = 0; i < positions.size(); i += 3) {
      const float x = positions[i], z = positions[i + 2];
      positions[i] = c * x + s * z;
      positions[i + 2] = c * z - s * x;
    }
  }

  [[nodiscard]] Model model() const { return {{positions, indices, {}, groups}, parts}; }
};

Balls plainHead() {
  Balls out;
  out.add("skin", {0, 0, 0}, {0.7f, 1, 0.85f});
  out.add("l-eye", {0.25f, 0.1f, 0.72f}, {0.13f, 0.13f, 0.13f});
  out.add("r-eye", {-0.25f, 0.1f, 0.72f}, {0.13f, 0.13f, 0.13f});
  return out;
}

const Landmark* find(const FoundLandmarks& found, const std::string& name) {
  for (const Landmark& landmark : found.landmarks)
    if (landmark.name == name) return &landmark;
  return nullptr;
}

double distance(const Position& a, const Position& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], static_cast<double>(a[2] - b[2]));
}

std::vector<Joint> jointsNamed(const std::vector<std::string>& names) {
  std::vector<Joint> out;
  for (const std::string& name : names) out.push_back({name, {static_cast<float>(out.size()), 0, 0}});
  return out;
}

}  // namespace

TEST_CASE("rigs are recognised by the names of their joints", "[cages][landmarks]") {
  const auto rig = [](const std::string& prefix, const std::vector<std::string>& names) {
    std::vector<std::string> full;
    for (const std::string& name : names) full.push_back(prefix + name);
    return recogniseRig(jointsNamed(full));
  };
  const std::vector<std::string> mixamo = {"Hips",    "Spine",       "Neck",     "Head",
                                           "LeftArm", "LeftForeArm", "RightArm", "LeftUpLeg"};
  for (const char* prefix : {"mixamorig:", "mixamorig", "mixamorig1:", "mixamorig_", "Armature|mixamorig:"}) {
    const Rig found = rig(prefix, mixamo);
    CHECK(found.name == "Mixamo");
    REQUIRE(found.find("joint_shoulder_left") != nullptr);
    CHECK(found.find("joint_shoulder_left")->position[0] == 4);
    CHECK(found.find("joint_spine") == nullptr);
  }
  CHECK(rig("", mixamo).name == "Ready Player Me");
  CHECK(rig("", {"hips", "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperLeg", "rightFoot"}).name == "VRM");
  const Rig roblox = rig("", {"LowerTorso", "UpperTorso", "Head", "LeftUpperArm", "LeftLowerArm", "LeftHand",
                              "LeftUpperLeg", "RightFoot"});
  CHECK(roblox.name == "Roblox R15");
  CHECK(roblox.find("joint_head") == nullptr);
  CHECK(roblox.find("joint_hips") != nullptr);
  CHECK(rig("", {"Bone", "Bone.001", "Head"}).name == "unknown");
  CHECK(rig("", {}).name.empty());
}

TEST_CASE("eyes are found by name and by shape, whatever way the head faces", "[cages][landmarks]") {
  const bool named = GENERATE(true, false);
  const double angle = GENERATE(0.0, 0.7, 1.5707963, 3.0, -2.0);
  CAPTURE(named, angle);
  Balls head = plainHead();
  if (!named) std::fill(head.parts.begin(), head.parts.end(), "mesh");
  head.turn(angle);
  FoundLandmarks found;
  REQUIRE(findLandmarks(head.model(), nullptr, found).ok());
  CHECK(found.kind == Kind::head);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  for (const float side : {1.0f, -1.0f}) {
    const Landmark* eye = find(found, side > 0 ? "eye_centre_left" : "eye_centre_right");
    REQUIRE(eye != nullptr);
    CHECK(distance(eye->position, {0.25f * side * c + 0.72f * s, 0.1f, 0.72f * c - 0.25f * side * s}) < 0.02);
  }
}

TEST_CASE("what is not found is said", "[cages][landmarks]") {
  FoundLandmarks found;
  const Balls head = plainHead();
  REQUIRE(findLandmarks(head.model(), nullptr, found).ok());
  for (const char* name : {"mouth_corner_left", "ear_top_right", "lip_upper"}) {
    CHECK(find(found, name) == nullptr);
    CHECK(std::find(found.missing.begin(), found.missing.end(), name) != found.missing.end());
  }
  Balls ball;
  ball.add("ball", {0, 0, 0}, {1, 1, 1});
  REQUIRE(findLandmarks(ball.model(), nullptr, found).ok());
  CHECK(found.kind == Kind::prop);
  CHECK(found.landmarks.empty());
  CHECK(found.missing.size() == 25);
}

TEST_CASE("wheels are no eyes", "[cages][landmarks]") {
  Balls car;
  car.add("body", {0, 0, 0}, {0.7f, 0.5f, 2});
  for (const float side : {-0.5f, 0.5f}) car.add("wheel", {side, -0.45f, 1.5f}, {0.1f, 0.25f, 0.25f});
  FoundLandmarks found;
  REQUIRE(findLandmarks(car.model(), nullptr, found).ok());
  CHECK(found.kind == Kind::prop);
  CHECK(found.landmarks.empty());
}

TEST_CASE("landmarks are not looked for on bad models", "[cages][landmarks]") {
  FoundLandmarks found;
  CHECK(findLandmarks({}, nullptr, found).problem == Problem::badModel);
  Balls ball;
  ball.add("ball", {0, 0, 0}, {1, 1, 1});
  ball.positions[7] = std::numeric_limits<float>::quiet_NaN();
  CHECK(findLandmarks(ball.model(), nullptr, found).problem == Problem::badModel);
}

TEST_CASE("what is nothing like a head has no landmarks", "[cages][landmarks]") {
  FoundLandmarks found;
  for (const Position& radii : {Position{1e-4f, 1, 1}, Position{1, 1, 1e-4f}, Position{1, 1e-4f, 1}}) {
    Balls flat;
    flat.add("flat", {0, 0, 0}, radii);
    REQUIRE(findLandmarks(flat.model(), nullptr, found).ok());
    CHECK(found.landmarks.empty());
  }
  const std::vector<std::uint32_t> indices = {0, 1, 2};
  const std::vector<float> thin = {0, 0, 0, 1, 1e-5f, 0, 2, 0, 0};
  REQUIRE(findLandmarks({{thin, indices}}, nullptr, found).ok());
  CHECK(found.landmarks.empty());
  const std::vector<float> thinner = {0, 0, 0, 1, 1e-7f, 0, 2, 0, 0};
  CHECK(findLandmarks({{thinner, indices}}, nullptr, found).problem == Problem::badModel);
}

TEST_CASE("parts that are called eyes may be anywhere", "[cages][landmarks]") {
  FoundLandmarks found;
  for (const Position& eye : {Position{30, 0, 0}, Position{0.2f, 40, 0}, Position{0.3f, 0, 0}, Position{0, 0.5f, 1}}) {
    CAPTURE(eye[0], eye[1], eye[2]);
    Balls head;
    head.add("skin", {0, 0, 0}, {0.7f, 1, 0.85f});
    head.add("l-eye", eye, {0.13f, 0.13f, 0.13f});
    head.add("r-eye", {-eye[0], eye[1], eye[2]}, {0.13f, 0.13f, 0.13f});
    CHECK(findLandmarks(head.model(), nullptr, found).ok());
  }
}

TEST_CASE("a head is not tiny beside the distance of its eyes", "[cages][landmarks]") {
  const float thin = GENERATE(0.1f, 0.02f, 0.001f);
  CAPTURE(thin);
  Balls goggles;  // On a thin rod, which is all that is above and behind their middle.
  goggles.add("rod", {0, 0, 0}, {0.4f, thin, thin});
  goggles.add("body", {0, -1, 0}, {0.8f, 0.7f, 0.6f});
  for (const float side : {0.5f, -0.5f}) goggles.add("eye", {side, 0, 0}, {0.3f, 0.3f, 0.3f});
  const Figure figure = readFigure(goggles.model());
  const std::optional<Eyes> eyes = findNamedEyes(figure);
  REQUIRE(eyes);
  const std::optional<Head> head = makeHead(figure, *eyes);
  REQUIRE(head);
  CHECK(head->frame.unit > 1);
  CHECK(length(eyes->centres[0] - eyes->centres[1]) < head->frame.unit);
}

TEST_CASE("finding landmarks can be cancelled", "[cages][landmarks]") {
  FoundLandmarks found;
  const Balls head = plainHead();
  int calls = 0;
  const Outcome outcome = findLandmarks(
      head.model(), [&](float, const char*) { return ++calls < 2; }, found);
  CHECK(outcome.problem == Problem::cancelled);
}
