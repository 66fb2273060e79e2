#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cagecast/cages.hpp"
#include "landmarks/head.hpp"
#include "landmarks/landmark_list.hpp"
#include "landmarks/rig.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// An egg with two eyes.
OwnedModel plainHead(const std::string& left = "l-eye", const std::string& right = "r-eye") {
  OwnedModel out;
  out.add("skin", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 16));
  out.add(left, sphere({0.25, 0.1, 0.72}, 0.13, 12));
  out.add(right, sphere({-0.25, 0.1, 0.72}, 0.13, 12));
  return out;
}

/// Two of them, the second moved by `way` and `size` times as large.
OwnedModel twoHeads(const std::string& left, const std::string& right, const Vec3& way, double size) {
  OwnedModel out = plainHead(left, right);
  const auto place = [&](const TriangleMesh& mesh) {
    return mapped(mesh, [&](const Vec3& p) { return size * p + way; });
  };
  out.add("skin", place(ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 16)));
  out.add(left, place(sphere({0.25, 0.1, 0.72}, 0.13, 12)));
  out.add(right, place(sphere({-0.25, 0.1, 0.72}, 0.13, 12)));
  return out;
}

FoundLandmarks found(const OwnedModel& owned) {
  FoundLandmarks out;
  const Model model = owned.model();
  const Status status = findLandmarks(model, nullptr, out);
  INFO(describe(status, model));
  REQUIRE(status.ok());
  return out;
}

}  // namespace

TEST_CASE("rigs are recognised by the names of their joints", "[cages][landmarks]") {
  const auto rig = [](const std::string& prefix, const std::vector<std::string>& names) {
    std::vector<Joint> joints;
    for (const std::string& name : names) joints.push_back({prefix + name, {static_cast<float>(joints.size()), 0, 0}});
    return recogniseRig(joints);
  };
  const std::vector<std::string> mixamo = {"Hips",    "Spine",       "Neck",     "Head",
                                           "LeftArm", "LeftForeArm", "RightArm", "LeftUpLeg"};
  for (const char* prefix : {"mixamorig:", "mixamorig", "mixamorig1:", "mixamorig_", "Armature|mixamorig:"}) {
    const Rig of = rig(prefix, mixamo);
    CHECK(of.name == "Mixamo");
    REQUIRE(placeOf(of.joints, "joint_shoulder_left"));
    CHECK(placeOf(of.joints, "joint_shoulder_left")->x == 4);
    CHECK_FALSE(placeOf(of.joints, "joint_spine"));
  }
  CHECK(rig("", mixamo).name == "Ready Player Me");
  CHECK(rig("", {"hips", "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperLeg", "rightFoot"}).name == "VRM");
  const Rig roblox = rig("", {"LowerTorso", "UpperTorso", "Head", "LeftUpperArm", "LeftLowerArm", "LeftHand",
                              "LeftUpperLeg", "RightFoot"});
  CHECK(roblox.name == "Roblox R15");
  CHECK_FALSE(placeOf(roblox.joints, "joint_head"));
  CHECK(placeOf(roblox.joints, "joint_hips"));
  CHECK(rig("J_Bip_", {"C_Hips", "C_Neck", "C_Head", "L_UpperArm", "R_LowerArm", "R_Foot"}).name == "VRoid");
  const Rig rigify = rig("DEF-", {"spine", "spine.004", "spine.006", "upper_arm.L", "forearm.R", "shin.R"});
  CHECK(rigify.name == "Rigify");
  CHECK(placeOf(rigify.joints, "joint_head")->x == 2);
  CHECK(placeOf(rigify.joints, "joint_knee_right")->x == 5);
  CHECK(rig("", {"Bone", "Bone.001", "Head"}).name == "unknown");
  // Sketchfab numbers all joints but the root.
  const Rig numbered = rig(
      "DEF-", {"spine_01", "spine004_02", "spine006_051", "upper_armL_03", "forearmR_04", "shinR_05", "_rootJoint"});
  CHECK(numbered.name == "Rigify");
  CHECK(placeOf(numbered.joints, "joint_head")->x == 2);
  // Rigs with names of their own: words name the joint and its side.
  const std::vector<std::vector<std::string>> others = {
      {"pelvis", "neck_01", "head", "clavicle_l", "upperarm_l", "upperarm_twist_01_l", "lowerarm_l", "hand_l",
       "thigh_r", "calf_r", "foot_r"},
      {"Bip01 Pelvis", "Bip01 Neck", "Bip01 Head", "Bip01 L Clavicle", "Bip01 L UpperArm", "Bip01 L UpArmTwist",
       "Bip01 L Forearm", "Bip01 L Hand", "Bip01 R Thigh", "Bip01 R Calf", "Bip01 R Foot"},
      {"hip", "neckLower", "head", "lCollar", "lShldrBend", "lShldrTwist", "lForearmBend", "lHand", "rThighBend",
       "rShin", "rFoot"},
      {"C_hips", "C_neck", "C_head", "L_clavicle", "L_armUpper", "L_armTwist", "L_armLower", "L_hand", "R_legUpper",
       "R_legLower", "R_foot"},
      {"下半身", "首", "頭", "左肩", "左腕", "左腕捩", "左ひじ", "左手首", "右足", "右ひざ", "右足首"},
      {"Hips", "Neck", "Head", "Shoulder.L", "UpperArm.L", "UpperArmTwist.L", "LowerArm.L", "Wrist.L", "UpperLeg.R",
       "LowerLeg.R", "Foot.R"},
      {"Root_M", "Neck_M", "Head_M", "Scapula_L", "Shoulder_L", "ShoulderPart1_L", "Elbow_L", "Wrist_L", "Hip_R",
       "Knee_R", "Ankle_R"},
      {"Hips_01", "Neck_02", "Head_03", "Shoulder_L_04", "UpperArm_L_05", "UpperArmTwist_L_06", "LowerArm_L_07",
       "Wrist_L_08", "UpperLeg_R_09", "LowerLeg_R_010", "Foot_R_011"}};
  for (const std::vector<std::string>& names : others) {
    const Rig of = rig("", names);
    CAPTURE(names.back());
    const std::pair<const char*, double> expected[] = {
        {"hips", 0},       {"neck", 1},       {"head", 2},      {"clavicle_left", 3}, {"shoulder_left", 4},
        {"elbow_left", 6}, {"wrist_left", 7}, {"hip_right", 8}, {"knee_right", 9},    {"ankle_right", 10}};
    for (const auto& [name, place] : expected) {
      CAPTURE(name);
      REQUIRE(placeOf(of.joints, std::string("joint_") + name));
      CHECK(placeOf(of.joints, std::string("joint_") + name)->x == place);
    }
    CHECK(of.joints.size() == std::size(expected));
    CHECK(of.isHead[2]);
  }
  CHECK(rig("", {}).name.empty());
}

TEST_CASE("eyes are found by name and by shape, whatever way the head faces", "[cages][landmarks]") {
  const bool named = GENERATE(true, false);
  const double angle = GENERATE(0.0, 0.7, 1.5707963, 3.0, -2.0);
  CAPTURE(named, angle);
  const auto turned = [&](const Vec3& p) {
    return Vec3{std::cos(angle) * p.x + std::sin(angle) * p.z, p.y, std::cos(angle) * p.z - std::sin(angle) * p.x};
  };
  const FoundLandmarks of = found((named ? plainHead() : plainHead("mesh", "mesh")).mapped(turned));
  CHECK(of.kind == Kind::head);
  for (const auto& [name, x] : {std::pair{"eye_centre_left", 0.25}, {"eye_centre_right", -0.25}}) {
    REQUIRE(placeOf(of.landmarks, name));
    CHECK(length(*placeOf(of.landmarks, name) - turned({x, 0.1, 0.72})) < 0.02);
  }
}

TEST_CASE("of heads beside each other none is taken for the face", "[cages][landmarks]") {
  // Named eyes are found wherever they are; others where they mirror each other.
  const auto [eye, way, size] =
      GENERATE(std::tuple{"eye", Vec3{1.6, 0, 0}, 1.0}, std::tuple{"eye", Vec3{6, 0.2, 0}, 0.8},
               std::tuple{"eye", Vec3{1, 0, -2}, 1.0}, std::tuple{"eye", Vec3{0, 0, -4}, 0.8},
               std::tuple{"mesh", Vec3{1.6, 0, 0}, 1.0}, std::tuple{"mesh", Vec3{6, 0, 0}, 1.0});
  CAPTURE(eye, way.x, way.z, size);
  const FoundLandmarks of = found(twoHeads(eye, eye, way, size));
  CHECK(of.areSeveralHeads);
  CHECK_FALSE(placeOf(of.landmarks, "eye_centre_left"));
}

TEST_CASE("a second pair of eyes on one head is no second head", "[cages][landmarks]") {
  const auto [way, size] =
      GENERATE(std::pair{Vec3{0, 0.35, -0.1}, 1.0}, std::pair{Vec3{0, 0, 0.02}, 0.6}, std::pair{Vec3{0, 0, 0.2}, 1.0});
  OwnedModel head = plainHead();
  for (const double x : {0.25, -0.25})
    head.add(x > 0 ? "l-eye" : "r-eye", sphere(Vec3{x, 0.1, 0.72} + way, size * 0.13, 12));
  const FoundLandmarks of = found(head);
  CHECK_FALSE(of.areSeveralHeads);
  CHECK(placeOf(of.landmarks, "eye_centre_left"));
}

TEST_CASE("a face is looked for in what the joints of a head hold", "[cages][landmarks]") {
  OwnedModel figure;
  figure.add("skin", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 24));
  const std::size_t headEnd = figure.positions.size() / 3;
  figure.add("coat", ellipsoid({0, -3.2, 0}, {1.4, 2, 0.8}, 24));
  // Buttons look like eyes; the eyes are painted on.
  for (const double side : {0.3, -0.3}) figure.add("coat", sphere({side, -2.8, 0.75}, 0.13, 12));
  Model model = figure.model();
  model.joints = {{"Hips", {0, -4, 0}},       {"Spine2", {0, -2, 0}, 0},       {"Neck", {0, -1, 0}, 1},
                  {"Head", {0, -0.8f, 0}, 2}, {"LeftEye", {0.2f, 0.1f, 0}, 3}, {"RightEye", {-0.2f, 0.1f, 0}, 3},
                  {"LeftArm", {1, -2, 0}, 1}, {"RightArm", {-1, -2, 0}, 1}};
  FoundLandmarks out;
  REQUIRE(findLandmarks(model, nullptr, out).ok());
  std::vector<std::uint16_t> holders(figure.positions.size() / 3, 1);
  std::fill_n(holders.begin(), headEnd, std::uint16_t{3});
  model.vertexJoints = holders;
  REQUIRE(findLandmarks(model, nullptr, out).ok());
  const auto eye = placeOf(out.landmarks, "eye_centre_left");
  REQUIRE(eye);
  CHECK(length(Vec3{eye->x - 0.2, eye->y - 0.1, 0}) < 0.02);
  CHECK(eye->z > 0.6);
  CHECK(out.kind == Kind::body);
}

TEST_CASE("hints say where a face is, against its shape and the names of its parts", "[cages][landmarks]") {
  OwnedModel egg;
  egg.add("skin", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 24));
  // On its shoulders, as badges.
  for (const double side : {0.5, -0.5}) egg.add("eye", sphere({side, -0.6, 0.3}, 0.13, 12));
  // The sides are named the wrong way round.
  const std::vector<Landmark> hints = {{"eye_inner_right", {0.1f, 0.1f, 0.85f}},
                                       {"eye_outer_right", {0.4f, 0.1f, 0.85f}},
                                       {"eye_inner_left", {-0.1f, 0.1f, 0.85f}},
                                       {"eye_outer_left", {-0.4f, 0.1f, 0.85f}},
                                       {"mouth_corner_right", {0.2f, -0.4f, 0.75f}},
                                       {"mouth_corner_left", {-0.2f, -0.4f, 0.75f}},
                                       {"mouth", {0, -0.4f, 0.78f}}};
  const auto findWith = [&](const std::vector<Landmark>& given) {
    Model model = egg.model();
    model.hints = given;
    FoundLandmarks out;
    REQUIRE(findLandmarks(model, nullptr, out).ok());
    return out.landmarks;
  };
  const std::vector<Landmark> landmarks = findWith(hints);
  const auto place = [&](const char* name) {
    CAPTURE(name);
    REQUIRE(placeOf(landmarks, name));
    return *placeOf(landmarks, name);
  };
  for (const auto& [suffix, side] : {std::pair{"_left", 1.0}, {"_right", -1.0}}) {
    const std::string of = suffix;
    CHECK(place(("eye_centre" + of).c_str()).x == Approx(0.25 * side).margin(0.02));
    CHECK(place(("eye_outer" + of).c_str()).x == Approx(0.4 * side).margin(0.02));
    CHECK(place(("mouth_corner" + of).c_str()).x == Approx(0.2 * side).margin(0.02));
  }
  CHECK(place("lip_upper").y > -0.41);
  CHECK(place("lip_lower").y < -0.39);
  CHECK(place("lip_lower").y > -0.55);
  // Hints that cannot be are no hints.
  for (const float far : {std::numeric_limits<float>::quiet_NaN(), 1e30f}) {
    std::vector<Landmark> odd = hints;
    for (Landmark& hint : odd) hint.position[1] *= far;
    CHECK(findWith(odd).size() == findWith({}).size());
  }
}

TEST_CASE("what is not found is said", "[cages][landmarks]") {
  const FoundLandmarks of = found(plainHead());
  for (const char* name : {"mouth_corner_left", "ear_top_right", "lip_upper"}) {
    CHECK_FALSE(placeOf(of.landmarks, name));
    CHECK(std::find(of.missing.begin(), of.missing.end(), name) != of.missing.end());
  }
}

TEST_CASE("what is nothing like a head has no landmarks", "[cages][landmarks]") {
  OwnedModel ball, car;
  ball.add("ball", sphere({0, 0, 0}, 1));
  car.add("body", ellipsoid({0, 0, 0}, {0.7, 0.5, 2}, 16));  // Its wheels are no eyes.
  for (const double side : {-0.5, 0.5}) car.add("wheel", ellipsoid({side, -0.45, 1.5}, {0.1, 0.25, 0.25}, 12));
  std::vector<OwnedModel> models = {ball, car};
  for (const Vec3& radii : {Vec3{1e-4, 1, 1}, Vec3{1, 1, 1e-4}, Vec3{1, 1e-4, 1}})
    models.emplace_back().add("flat", ellipsoid({0, 0, 0}, radii, 12));
  models.emplace_back().add("thin", {{{0, 0, 0}, {1, 1e-5, 0}, {2, 0, 0}}, {{0, 1, 2}}});
  for (const OwnedModel& model : models) {
    const FoundLandmarks of = found(model);
    CHECK(of.kind == Kind::prop);
    CHECK(of.landmarks.empty());
    CHECK(of.missing.size() == 25);
  }
  FoundLandmarks none;
  CHECK(findLandmarks({}, nullptr, none).code == Code::emptyMesh);
}

TEST_CASE("parts that are called eyes may be anywhere", "[cages][landmarks]") {
  for (const Vec3& eye : {Vec3{30, 0, 0}, Vec3{0.2, 40, 0}, Vec3{0.3, 0, 0}, Vec3{0, 0.5, 1}}) {
    OwnedModel head;
    head.add("skin", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 16));
    head.add("l-eye", sphere(eye, 0.13, 8));
    head.add("r-eye", sphere({-eye.x, eye.y, eye.z}, 0.13, 8));
    for (const Landmark& landmark : found(head).landmarks) CHECK(std::isfinite(landmark.position[0]));
  }
}

TEST_CASE("a head is not tiny beside the distance of its eyes", "[cages][landmarks]") {
  const double thin = GENERATE(0.1, 0.02, 0.001);
  CAPTURE(thin);
  OwnedModel goggles;  // On a thin rod, which is all that is above and behind their middle.
  goggles.add("rod", ellipsoid({0, 0, 0}, {0.4, thin, thin}, 16));
  goggles.add("body", ellipsoid({0, -1, 0}, {0.8, 0.7, 0.6}, 16));
  for (const double side : {0.5, -0.5}) goggles.add("eye", sphere({side, 0, 0}, 0.3, 16));
  const Figure figure = readFigure(goggles.model());
  const std::optional<Eyes> eyes = findNamedEyes(figure);
  REQUIRE(eyes);
  const std::optional<Head> head = makeHead(figure, *eyes);
  REQUIRE(head);
  CHECK(head->frame.unit > 1);
  CHECK(length(eyes->centres[0] - eyes->centres[1]) < head->frame.unit);
}

TEST_CASE("finding landmarks can be cancelled", "[cages][landmarks]") {
  const OwnedModel head = plainHead("mesh", "mesh");
  FoundLandmarks none;
  for (const int last : {0, 1, 2}) {
    int calls = 0;
    CHECK(findLandmarks(
              head.model(), [&](float, const char*) { return calls++ < last; }, none)
              .code == Code::aborted);
  }
}
