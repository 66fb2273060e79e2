#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "cagecast/cages.hpp"
#include "fit/steps.hpp"
#include "fit/warp.hpp"
#include "mesh/surface.hpp"
#include "seed.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// How a head differs from another one: shares by which it is wider, and by which its nose is longer.
struct Shape {
  double width = 1, nose = 1;
};
constexpr Shape kOwn{}, kOther{1.15, 1.4};

/// The surface of a simple head, open at the neck: a point by longitude (0 is the front) and latitude.
Vec3 headPoint(const Shape& shape, double longitude, double latitude, double offset) {
  const double x = std::cos(latitude) * std::sin(longitude), y = std::sin(latitude),
               z = std::cos(latitude) * std::cos(longitude);
  const double bump = 0.25 * shape.nose * std::exp(-12 * (x * x + y * y)) * (z > 0 ? 1 : 0);
  const double r = 1 + offset;
  return {0.75 * shape.width * r * x, 1.1 * r * y, 0.9 * r * z + bump};
}

OwnedModel headMesh(const Shape& shape, std::uint32_t around, std::uint32_t rows, double offset) {
  const double low = -0.9, high = 1.5;  // Nearly closed: a fan of slivers at the pole would be folded by rounding.
  OwnedModel out;
  out.roll(
      around, rows,
      [&](double u, double v) { return headPoint(shape, 2 * kPi * u + kPi, low + v * (high - low), offset); },
      [](double, double) { return true; });
  out.groups.clear();
  out.parts.clear();
  return out;
}

std::vector<Landmark> headLandmarks(const Shape& shape) {
  struct Spot {
    const char* name;
    double longitude, latitude;
  };
  static constexpr Spot kSpots[] = {{"nose_tip", 0, 0},
                                    {"chin", 0, -0.7},
                                    {"crown", 0, 1.5},
                                    {"occiput", 3.14159, 0},
                                    {"ear_top_left", 1.57, 0.1},
                                    {"ear_top_right", -1.57, 0.1},
                                    {"mouth_corner_left", 0.3, -0.4},
                                    {"mouth_corner_right", -0.3, -0.4},
                                    {"eye_centre_left", 0.5, 0.3},
                                    {"eye_centre_right", -0.5, 0.3}};
  std::vector<Landmark> landmarks;
  for (const Spot& spot : kSpots)
    landmarks.push_back({spot.name, toPosition(headPoint(shape, spot.longitude, spot.latitude, 0))});
  return landmarks;
}

/// A template, a model of another shape, and its landmarks; what a test changes before it calls.
struct Heads {
  OwnedModel cage = headMesh(kOwn, 20, 12, 0.04), model = headMesh(kOther, 60, 40, 0);
  std::vector<Landmark> own = headLandmarks(kOwn), given = headLandmarks(kOther);
  std::vector<Joint> joints;
  FittedCage out;

  [[nodiscard]] Template from() const { return {cage.view(), own}; }
  [[nodiscard]] FitOptions options() const {
    FitOptions options;
    options.landmarks = given;
    return options;
  }
  [[nodiscard]] Model target() const {
    Model rigged = model.model();
    rigged.joints = joints;
    return rigged;
  }
  Status fit(const Progress& progress = {}) { return fitCage(from(), target(), options(), progress, out); }
  std::string says(const Status& status) const { return describe(status, from(), target(), options()); }
  std::vector<float> fitted() {
    const Status status = fit();
    INFO(says(status));
    REQUIRE(status.ok());
    CHECK(out.uvs == cage.uvs);
    CHECK(out.indices == cage.indices);
    for (const bool folded : foldedTriangles(weldExactly(out.view()))) CHECK_FALSE(folded);
    return out.positions;
  }
};

double distanceAt(const std::vector<float>& a, const std::vector<float>& b, std::size_t i) {
  return length(Vec3::from(&a[i]) - Vec3::from(&b[i]));
}

std::size_t foldCount(const TemplateCage& cage, const std::vector<Vec3>& positions) {
  const std::vector<bool> folded = foldedTriangles({positions, cage.mesh.triangles});
  return static_cast<std::size_t>(std::count(folded.begin(), folded.end(), true));
}

}  // namespace

TEST_CASE("a cage that is fitted to its own model stays where it is", "[cages][fit]") {
  Heads heads;
  heads.model = headMesh(kOwn, 60, 40, 0);
  heads.given = headLandmarks(kOwn);
  const std::vector<float> fitted = heads.fitted();
  const double diagonal = diagonalOf(weldExactly(heads.cage.view()));
  for (std::size_t i = 0; i < fitted.size(); i += 3)
    if (distanceAt(fitted, heads.cage.positions, i) >= 0.03 * diagonal) FAIL_CHECK("vertex " << i / 3);
}

TEST_CASE("a fitted cage encloses another head, and its points go where they belong", "[cages][fit]") {
  Heads heads;
  const std::vector<float> fitted = heads.fitted();
  CHECK(heads.out.missing.empty());
  CHECK(heads.out.landmarks.size() == heads.given.size());
  const OwnedModel truth = headMesh(kOther, 20, 12, 0.04);
  double sum = 0;
  for (std::size_t i = 0; i < fitted.size(); i += 3) sum += distanceAt(fitted, truth.positions, i);
  CHECK(3 * sum / static_cast<double>(fitted.size()) < 0.02 * diagonalOf(weldExactly(truth.view())));
  std::size_t outside = 0;
  const TriangleMesh skin = weldExactly(heads.model.view());
  for (const SurfacePoint& point : Surface(weldExactly(heads.out.view())).closest(skin.positions))
    outside += point.height > 0 ? 1 : 0;
  CHECK(outside <= skin.positions.size() / 50);
}

TEST_CASE("a turned and scaled model gets a turned and scaled cage", "[cages][fit]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  Heads heads;
  const std::vector<float> upright = heads.fitted();
  Similarity map = shortestRotation({0, 1, 0}, unit({share(random), share(random), share(random)}));
  const double scale = std::pow(10.0, 2 * share(random));
  for (Vec3* axis : {&map.x, &map.y, &map.z}) *axis = scale * *axis;
  map.translation = scale * Vec3{3 * share(random), 3 * share(random), 3 * share(random)};
  heads.model = heads.model.mapped(map);
  for (Landmark& landmark : heads.given) landmark.position = toPosition(map(positionOf(landmark)));
  const std::vector<float> turned = heads.fitted();
  const double diagonal = diagonalOf(weldExactly(heads.model.view()));
  std::vector<double> differences;
  for (std::size_t i = 0; i < upright.size(); i += 3)
    differences.push_back(length(Vec3::from(&turned[i]) - map(Vec3::from(&upright[i]))) / diagonal);
  std::sort(differences.begin(), differences.end());
  // Positions are rounded to floats in both poses; a vertex between two equally near triangles may go to either.
  CHECK(differences[differences.size() * 9 / 10] < 2e-3);
  CHECK(differences.back() < 1e-2);
}

TEST_CASE("what must make no difference to a fit makes none", "[cages][fit]") {
  Heads heads;
  const std::vector<float> before = heads.fitted();
  SECTION("vertices that no triangle uses, of the model and of the template, and an output that owns the template") {
    append(heads.model.positions, {500, 0, 0});
    heads.model.uvs.clear();
    FittedCage inPlace;
    inPlace.positions = heads.cage.positions;
    inPlace.uvs = heads.cage.uvs;
    inPlace.indices = heads.cage.indices;
    append(inPlace.positions, {1e6, 1e6, 1e6});
    inPlace.uvs.insert(inPlace.uvs.end(), {0, 0});
    const Template from{inPlace.view(), heads.own, Kind::head};
    REQUIRE(fitCage(from, heads.target(), heads.options(), {}, inPlace).ok());
    CHECK(inPlace.kind == Kind::head);
    inPlace.positions.resize(before.size());
    CHECK(inPlace.positions == before);
  }
  SECTION("fins") {
    heads.model.addFins();
    heads.model.groups.clear();
    const std::vector<float> finned = heads.fitted();
    for (std::size_t i = 0; i < before.size(); i += 3)
      if (distanceAt(finned, before, i) > 0.05) FAIL_CHECK("vertex " << i / 3);
  }
  SECTION("what else there is") {
    OwnedModel both;
    both.add("head", weldExactly(heads.model.view()));
    both.add("pedestal", sphere({0, -4, 0}, 2));
    heads.model = both;
    // Voxels are larger around both; drawn to the pedestal's hull, or to none, it is 0.04 and more.
    const std::vector<float> withPedestal = heads.fitted();
    for (std::size_t i = 0; i < before.size(); i += 3)
      if (distanceAt(withPedestal, before, i) > 0.025) FAIL_CHECK("vertex " << i / 3);
  }
}

TEST_CASE("where too little is known, a cage is placed by size and symmetry", "[cages][fit]") {
  Heads heads;
  heads.model = headMesh({}, 60, 40, 0);
  const std::vector<Landmark> truth = headLandmarks({});
  const auto isTurned = GENERATE(false, true);
  const double angle = isTurned ? 2.2 : 0.0;
  const auto moved = [&](const Vec3& p) {
    return Vec3{3 * (std::cos(angle) * p.x + std::sin(angle) * p.z) + 5, 3 * p.y,
                3 * (std::cos(angle) * p.z - std::sin(angle) * p.x)};
  };
  heads.model = heads.model.mapped(moved);
  const std::size_t known = GENERATE(0u, 1u, 3u);
  CAPTURE(isTurned, known);
  heads.given.clear();
  for (std::size_t i = 0; i < known; ++i)
    heads.given.push_back({truth[i + 7].name, toPosition(moved(positionOf(truth[i + 7])))});
  (void)heads.fitted();
  CHECK(heads.out.missing.empty());
  REQUIRE(heads.out.guessed.size() == truth.size() - known);
  if (known == 0) CHECK(heads.out.guessed[0] == "eye_centre_left");
  for (const Landmark& landmark : heads.out.landmarks) {
    CAPTURE(landmark.name);
    const bool isGuessed =
        std::find(heads.out.guessed.begin(), heads.out.guessed.end(), landmark.name) != heads.out.guessed.end();
    CHECK(landmark.confidence == (isGuessed ? 0.25f : 1));
    CHECK(length(positionOf(landmark) - moved(*placeOf(truth, landmark.name))) < 0.3);
  }
  // Eyes that are known say where the rest is, though they are a little crooked.
  heads.given = {{"eye_centre_left", toPosition(moved({0.35, -0.2, 0.75}))},
                 {"eye_centre_right", toPosition(moved({-0.35, -0.19, 0.75}))}};
  (void)heads.fitted();
  CHECK(placeOf(heads.out.landmarks, "mouth_corner_left")->y < 3 * -0.5);
  // A guess is no reason to refuse what a person gives.
  heads.given = {{"chin", toPosition(moved({0, 1.2, 0.4}))}};
  CHECK(heads.fit().ok());
}

TEST_CASE("a guess that puts landmarks on one spot is refused", "[cages][fit]") {
  Heads heads;
  for (const char* side : {"left", "right"}) {
    const double sign = side == std::string("left") ? 1 : -1;
    heads.own.push_back({std::string("eye_inner_") + side, toPosition(headPoint(kOwn, sign * 0.45, 0.3, 0))});
    heads.own.push_back({std::string("eye_outer_") + side, toPosition(headPoint(kOwn, sign * 0.55, 0.3, 0))});
  }
  std::erase_if(heads.own, [](const Landmark& landmark) { return landmark.name == "chin"; });
  heads.given.clear();
  // A lamp: both corners of an eye are closest to one edge of its pole.
  heads.model = OwnedModel{};
  heads.model.add("foot", box({0, -1, 0}, {0.75, 0.1, 0.9}));
  heads.model.add("pole", box({0, 0, 0}, {0.05, 1, 0.05}));
  const Status status = heads.fit();
  INFO(heads.says(status));
  CHECK(status.code == Code::noFit);
}

TEST_CASE("a fit reports its progress in small shares, and can be cancelled", "[cages][fit]") {
  Heads heads;
  float before = -1, widest = 0;
  const auto measure = [&](float share, const char*) {
    if (before >= 0) widest = std::max(widest, share - before);
    before = share;
    return true;
  };
  REQUIRE(heads.fit(measure).ok());
  CHECK(widest < 0.1f);
  checkProgress([&](const Progress& progress) { return heads.fit(progress).ok(); }, {-1, 0.4f, 0.7f, 0.95f, 2});
}

TEST_CASE("what cannot be fitted is said in a sentence", "[cages][fit]") {
  struct Fault {
    std::string says;
    Code code;
    Argument argument;
    std::function<void(Heads&)> make;
  };
  const auto withJoints = [](float unit) {
    return [=](Heads& heads) {
      float height = -0.9f;
      for (const auto& [joint, landmark] : {std::pair{"hips", "hips"},
                                            {"upperChest", "chest"},
                                            {"neck", "neck"},
                                            {"head", "head"},
                                            {"jaw", "jaw"},
                                            {"leftUpperArm", "shoulder_left"},
                                            {"rightUpperArm", "shoulder_right"}}) {
        heads.own.push_back({std::string("joint_") + landmark, {0, height, 0}});
        heads.joints.push_back({joint, {0, unit * height, 0}});
        height += 0.3f;
      }
    };
  };
  const auto many = [](std::vector<Landmark>& list) {
    while (list.size() < 301) list.push_back({"spot_" + std::to_string(list.size()), {0, 0, 0}});
  };
  const auto given = Argument::landmarks;
  const Fault faults[] = {
      {"landmarks: the template has no antler; it has nose_tip, chin, crown, occiput, ear_top_left, ear_top_right, "
       "mouth_corner_left, mouth_corner_right, eye_centre_left, eye_centre_right",
       Code::unknownLandmark, given,
       [](Heads& h) {
         h.given.push_back({"antler", {0, 0, 0}});
       }},
      {"landmarks: nose_tip is there twice", Code::landmarkTwice, given,
       [](Heads& h) { h.given.push_back(h.given[0]); }},
      {"landmarks: nose_tip and chin are on one spot; each needs its own", Code::landmarksOnOneSpot, given,
       [](Heads& h) { h.given[1].position = h.given[0].position; }},
      {"landmarks: nose_tip is 36.6 diagonals outside the box of its model; it has to be in its unit and axes",
       Code::landmarkOutside, given,
       [](Heads& h) {
         for (Landmark& landmark : h.given) landmark.position = toPosition(100.0 * positionOf(landmark));
       }},
      {"landmarks: nose_tip is not a finite position", Code::nonFiniteLandmark, given,
       [](Heads& h) { h.given[0].position[1] = NAN; }},
      {"landmarks: ear_top_left is on the other side: left and right are the figure's own, not the viewer's",
       Code::wrongSide, given,
       [](Heads& h) {
         for (Landmark& landmark : h.given) landmark.position[0] *= -1;
       }},
      {"landmarks: eye_centre_left is on the other side: left and right are the figure's own, not the viewer's",
       Code::wrongSide, given, [](Heads& h) { std::swap(h.given[8].position, h.given[9].position); }},
      {"landmarks: crown is 63.5 % of the diagonal away from where the others put it; at most 15 % is expected",
       Code::landmarkAway, given,
       [](Heads& h) {
         h.given[2].position = {0, -1, 0.5f};
       }},
      {"landmarks: ", Code::landmarkAway, given,  // Several in other axes.
       [](Heads& h) {
         for (const std::size_t i : {0u, 1u, 6u, 7u}) {
           float* p = h.given[i].position.data();
           p[1] = -std::exchange(p[2], p[1]);
         }
       }},
      {"landmarks: ", Code::landmarkAway, given,  // All under other names.
       [](Heads& h) {
         const std::vector<Landmark> good = h.given;
         for (std::size_t i = 0; i < good.size(); ++i) h.given[i].position = good[(i + 3) % good.size()].position;
       }},
      {"landmarks: 301 are given, at most 300 are allowed", Code::tooManyLandmarks, given,
       [&](Heads& h) { many(h.given); }},
      {"template.landmarks: 301 are given, at most 300 are allowed", Code::tooManyLandmarks, Argument::from,
       [&](Heads& h) { many(h.own); }},
      {"template.landmarks: 3 are known, at least 4 are needed", Code::tooFewLandmarks, Argument::from,
       [](Heads& h) { h.own.resize(3); }},
      {"template.uvs is missing: the texture is drawn in the cage's UVs, 2 per vertex", Code::missingUvs,
       Argument::from, [](Heads& h) { h.cage.uvs.clear(); }},
      {"template has 20001 triangles and ", Code::tooDetailed, Argument::from,
       [](Heads& h) { h.cage.indices.resize(std::size_t{3} * 20'001, 0); }},
      {"landmarks: only 4 joints are known, too few for a skeleton of 6 bones; give more of them, or landmarks on the "
       "skin",
       Code::tooFewJoints, given,
       [](Heads& h) {
         static constexpr const char* kJoints[] = {"joint_head", "joint_neck", "joint_chest", "joint_spine"};
         h.own.resize(4);
         h.given.resize(4);
         for (std::size_t i = 0; i < 4; ++i) h.own[i].name = h.given[i].name = kJoints[i];
       }},
      {"model.joints: joint_hips is 26.4 diagonals outside the box of the mesh, at most 0.5 are expected; joints have "
       "to be in its unit and axes",
       Code::jointOutside, Argument::model, withJoints(100)},
      {"model.joints: the box of 7 joints is 0.00532 as large as that of the mesh, at least 0.05 is expected; joints "
       "have to be in its unit",
       Code::smallSkeleton, Argument::model, withJoints(0.01f)},
      {"model has nothing to paint: all that is seen of it is excluded", Code::nothingToPaint, Argument::model,
       [](Heads& h) {
         h.model.groups.assign(h.model.positions.size() / 3, 0);
         h.model.parts = {"eyes"};
       }},
      {"model is too thin for a hull: it encloses no volume", Code::noVolume, Argument::model,
       [](Heads& h) {
         // A strip between two layers of the grid, and a template as thin.
         h.model = {};
         h.model.add("strip", {{{-0.2, -1, 0}, {0.2, -1, 0}, {0.2, 1.1, 0}, {-0.2, 1.1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
         const auto flat = [](const Vec3& p) { return Vec3{0.2 * p.x, p.y, 0.001 * p.z}; };
         h.cage = headMesh(kOwn, 20, 12, 0.001).mapped(flat);
         std::erase_if(h.own, [](const Landmark& landmark) { return landmark.name == "occiput"; });
         for (Landmark& landmark : h.own) landmark.position = toPosition(flat(positionOf(landmark)));
         h.given = h.own;
       }},
  };
  for (const auto& [says, code, argument, make] : faults) {
    Heads heads;
    make(heads);
    const Status status = heads.fit();
    CAPTURE(says);
    CHECK(status.code == code);
    CHECK(status.argument == argument);
    CAPTURE(heads.says(status));
    CHECK(heads.says(status).starts_with(says));
  }
  Heads heads;
  withJoints(1)(heads);
  CHECK(heads.fit().ok());
}

TEST_CASE("relaxing unfolds what was moved over its neighbours, and leaves the rest where it is", "[cages][fit]") {
  const OwnedModel mesh = headMesh({}, 24, 16, 0.03);
  const TemplateCage cage = prepareTemplate({mesh.view(), headLandmarks({})});
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::vector<Vec3> positions = cage.mesh.positions;
  std::vector<bool> near(positions.size());
  const auto vertex = static_cast<std::uint32_t>(random() % positions.size());
  near[vertex] = true;
  // Two vertices change places.
  std::swap(positions[vertex], positions[cage.neighbours[vertex][random() % cage.neighbours[vertex].size()]]);
  grow(cage.neighbours, near, 5);
  REQUIRE(foldCount(cage, positions) > 0);
  const std::vector<Vec3> free(positions.size(), Vec3{0, 0, 0});
  CHECK(relax(
      cage, free, [](double) { return true; }, positions));
  CHECK(foldCount(cage, positions) == 0);
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!near[v]) CHECK(length(positions[v] - cage.mesh.positions[v]) == 0);
}

TEST_CASE("dense rings around the hole of an eye make room for it, and do not fold over", "[cages][fit]") {
  constexpr std::uint32_t kAround = 24;
  const auto disc = [](const std::vector<double>& radii, double height) {
    OwnedModel out;
    out.roll(
        kAround, static_cast<std::uint32_t>(radii.size() - 1),
        [&](double u, double v) {
          const double r = radii[static_cast<std::size_t>(std::lround(v * static_cast<double>(radii.size() - 1)))];
          return Vec3{r * std::cos(2 * kPi * u), -r * std::sin(2 * kPi * u), height};
        },
        [](double, double) { return true; });
    return out;
  };
  const std::vector<double> rings{1, 1.1, 1.2, 1.3, 1.5, 2, 3, 16};
  OwnedModel mesh = disc(rings, 0.05);
  const TemplateCage cage = prepareTemplate({mesh.view(), {{"nose_tip", {0, -3, 0}}}});
  OwnedModel ball;
  ball.roll(
      48, 24,
      [](double u, double v) {
        const double around = 2 * kPi * u, up = kPi * (v - 0.5);
        return Vec3{2 * std::cos(up) * std::sin(around), 2 * std::sin(up), 2 * std::cos(up) * std::cos(around) - 2.2};
      },
      [](double, double) { return true; });
  EyedFigure figure;
  figure.componentCount = 2;
  for (const auto& [part, isEye] :
       {std::pair{disc({1.6, 2, 3, 16}, 0), false}, std::pair{disc({0.1, 16}, -5), false}, std::pair{ball, true}}) {
    const TriangleMesh piece = weldExactly(part.view());
    const auto first = static_cast<std::uint32_t>(figure.mesh.positions.size());
    for (const Vec3& p : piece.positions) figure.mesh.positions.push_back(p);
    for (const Triangle3& t : piece.triangles) {
      figure.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      figure.isEye.push_back(isEye);
      figure.components.push_back(isEye ? 1 : 0);
    }
  }
  figure.eyes = {{{0, 0, -2.2}, {0, 0, -2.2}}, {{99, 0, 0}, {99, 0, 0}}};
  std::vector<Vec3> tracks, positions = cage.mesh.positions;
  REQUIRE(fitEyeHoles(
      cage, figure, [](double) { return true; }, tracks, positions));
  const auto radius = [](const Vec3& p) { return std::hypot(p.x, p.y); };
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const double before = radius(cage.mesh.positions[v]);
    if (before < 1.05) CHECK(radius(positions[v]) > 1.55);
    if (before > 10) CHECK(length(positions[v] - cage.mesh.positions[v]) == 0);
  }
  const std::vector<bool> folded = foldedTriangles({positions, cage.mesh.triangles});
  CHECK(std::none_of(folded.begin(), folded.end(), [](bool is) { return is; }));
}

TEST_CASE("a head is not taken for the eye that a landmark is in", "[cages][fit]") {
  OwnedModel mesh;
  mesh.roll(
      40, 24, [](double u, double v) { return headPoint(kOwn, 2 * kPi * u + kPi, -0.9 + 2.4 * v, 0.04); },
      [](double u, double v) { return std::hypot(2 * kPi * std::abs(u - 0.5) - 0.5, -0.9 + 2.4 * v - 0.3) > 0.16; });
  mesh.groups.clear();
  // A cage of a whole figure is large beside its eyes.
  mesh.positions.insert(mesh.positions.end(), {0, -30, 0, 0.1f, -30, 0, 0, -30, 0.1f});
  mesh.uvs.resize(mesh.positions.size() / 3 * 2);
  const auto count = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  mesh.indices.insert(mesh.indices.end(), {count - 3, count - 2, count - 1});
  const std::vector<Landmark> own = headLandmarks(kOwn);
  const TemplateCage cage = prepareTemplate({mesh.view(), own});
  EyedFigure figure;
  figure.mesh = weldExactly(headMesh(kOwn, 60, 40, 0).view());
  figure.components = connectedPieces(figure.mesh, figure.componentCount);
  figure.isEye.resize(figure.mesh.triangles.size());
  figure.eyes = eyePairs(own, own);
  std::vector<Vec3> tracks, positions = cage.mesh.positions;
  REQUIRE(fitEyeHoles(
      cage, figure, [](double) { return true; }, tracks, positions));
  for (std::size_t v = 0; v < positions.size(); ++v) REQUIRE(length(positions[v] - cage.mesh.positions[v]) == 0);
}

TEST_CASE("what was found has no vote against what a person gives", "[cages][fit]") {
  const std::vector<Landmark> from = headLandmarks(kOwn);
  std::vector<Landmark> to = headLandmarks(kOther);
  std::vector<bool> given(from.size()), outvoted;
  const auto isGiven = [](const Landmark& one) {
    return one.name.starts_with("eye_") || one.name.starts_with("mouth");
  };
  for (std::size_t i = 0; i < from.size(); ++i) {
    given[i] = isGiven(from[i]);
    if (!given[i]) to[i].position[1] -= 3;  // All of a face that was found elsewhere.
  }
  CHECK(checkAgreement(from, to, given, 3, outvoted).ok());
  for (std::size_t i = 0; i < from.size(); ++i) CHECK(outvoted[i] == !given[i]);
  CHECK(checkAgreement(from, headLandmarks(kOther), given, 3, outvoted).ok());
  CHECK(std::find(outvoted.begin(), outvoted.end(), true) == outvoted.end());
}

TEST_CASE("a hole of a face is where its given landmark is, whatever the hull says", "[cages][fit]") {
  Heads heads;
  heads.cage = OwnedModel{};
  const auto isHole = [](double longitude, double latitude) {
    return std::hypot(std::abs(longitude) - 0.5, latitude - 0.3) < 0.16 || std::hypot(longitude, latitude + 0.4) < 0.2;
  };
  heads.cage.roll(
      40, 24, [](double u, double v) { return headPoint(kOwn, 2 * kPi * u + kPi, -0.9 + 2.4 * v, 0.04); },
      [&](double u, double v) { return !isHole(2 * kPi * (u - 0.5), -0.9 + 2.4 * v); });
  heads.cage.groups.clear();
  heads.own.push_back({"lip_lower", toPosition(headPoint(kOwn, 0, -0.45, 0))});
  heads.given.push_back({"lip_lower", toPosition(headPoint(kOther, 0, -0.45, 0))});
  std::erase_if(heads.own, [](const Landmark& one) { return one.name.starts_with("mouth"); });
  std::erase_if(heads.given, [](const Landmark& one) { return one.name.starts_with("mouth"); });
  // A beard hangs from the chin, and the mouth is higher than it.
  heads.model = heads.model.mapped([](const Vec3& p) {
    const double beard = std::exp(-12 * (p.x * p.x + (p.y + 0.75) * (p.y + 0.75)));
    return p.z > 0 ? p + Vec3{0, -0.2 * beard, 0.5 * beard} : p;
  });
  for (Landmark& one : heads.given)
    if (one.name == "lip_lower") one.position[1] += 0.1f;
  const Status status = heads.fit();
  REQUIRE(status.ok());
  const TemplateCage cage = prepareTemplate(heads.from());
  TriangleMesh fitted = cage.mesh;
  for (std::size_t v = 0; v < cage.vertexOf.size(); ++v)
    fitted.positions[cage.vertexOf[v]] = Vec3::from(&heads.out.positions[3 * v]);
  const auto place = [](const std::vector<Landmark>& list, const char* name) { return *placeOf(list, name); };
  const Vec3 eyes = 0.5 * (place(heads.own, "eye_centre_left") + place(heads.own, "eye_centre_right"));
  const double face = length(eyes - place(heads.own, "lip_lower"));
  for (const auto& [name, other] : {std::pair{"eye_centre_left", place(heads.own, "eye_centre_right")},
                                    {"eye_centre_right", place(heads.own, "eye_centre_left")},
                                    {"lip_lower", eyes}}) {
    const int hole = holeAt(cage, place(heads.own, name), other);
    REQUIRE(hole >= 0);
    const std::vector<std::uint32_t>& loop = cage.loops[static_cast<std::size_t>(hole)];
    const Vec3 own = middleOf(cage.mesh, loop) - place(heads.own, name);
    const Vec3 there = middleOf(fitted, loop) - place(heads.given, name);
    CAPTURE(name);
    CHECK(std::hypot(there.x - own.x, there.y - own.y) < 0.1 * face);
  }
}

TEST_CASE("a hole of a face that has nothing behind it is closed", "[cages][fit]") {
  const auto isAt = [](double u, double v, double longitude, double latitude, double radius) {
    return std::hypot(2 * kPi * (u - 0.5) - longitude, -0.9 + 2.4 * v - latitude) < radius;
  };
  const auto isMouth = [&](double u, double v, double radius) { return isAt(u, v, 0, -0.4, radius); };
  Heads heads;
  heads.cage = OwnedModel{};
  heads.cage.roll(
      40, 24, [](double u, double v) { return headPoint(kOwn, 2 * kPi * u + kPi, -0.9 + 2.4 * v, 0.04); },
      [&](double u, double v) {
        return !isAt(u, v, 0.5, 0.3, 0.16) && !isAt(u, v, -0.5, 0.3, 0.16) && !isMouth(u, v, 0.2);
      });
  heads.cage.groups.clear();
  heads.model = headMesh(kOwn, 60, 40, 0);
  heads.given = headLandmarks(kOwn);
  constexpr std::uint32_t kPixels = 128;
  std::vector<std::uint8_t> pixels(4 * std::size_t{kPixels} * kPixels, 255);
  std::vector<BaseColor> colors(1);
  std::vector<Landmark> hints;
  const auto openAfter = [&] {
    Model target = heads.model.model();
    target.baseColors = colors;
    target.hints = hints;
    FittedCage out;
    const Status status = fitCage(heads.from(), target, heads.options(), {}, out);
    INFO(heads.says(status));
    REQUIRE(status.ok());
    CHECK((out.indices.size() > heads.cage.indices.size()) == !out.closed.empty());
    return boundaryLoops(weldExactly(out.view())).size();
  };
  const std::size_t all = boundaryLoops(weldExactly(heads.cage.view())).size();
  SECTION("nothing") { CHECK(openAfter() == all - 3); }
  SECTION("colours that are not known") {
    colors[0].isKnown = false;
    CHECK(openAfter() == all);
    colors.clear();
    CHECK(openAfter() == all);
  }
  SECTION("another colour") {
    for (std::uint32_t y = 0; y < kPixels; ++y)
      for (std::uint32_t x = 0; x < kPixels; ++x)
        if (isMouth((x + 0.5) / kPixels, (y + 0.5) / kPixels, 0.15)) pixels[4 * (y * kPixels + x)] = 0;
    colors[0].image = {kPixels, kPixels, pixels};
    CHECK(openAfter() == all - 2);
  }
  SECTION("morph targets") {
    hints = {{"mouth", toPosition(headPoint(kOwn, 0, -0.4, 0))}};
    CHECK(openAfter() == all - 2);
  }
  SECTION("an opening") {
    heads.model = OwnedModel{};
    heads.model.roll(
        60, 40, [](double u, double v) { return headPoint(kOwn, 2 * kPi * u + kPi, -0.9 + 2.4 * v, 0); },
        [&](double u, double v) { return !isMouth(u, v, 0.15); });
    CHECK(openAfter() == all - 2);
  }
  SECTION("eyeballs behind lids that are closed") {
    colors.resize(3);
    heads.model.groups.assign(heads.model.positions.size() / 3, 0);
    heads.model.parts = {"skin"};
    for (const double side : {-1.0, 1.0}) {
      heads.model.add("ball", sphere(headPoint(kOwn, side * 0.5, 0.3, -0.2), 0.12));
      heads.model.uvs.resize(heads.model.positions.size() / 3 * 2);
    }
    CHECK(openAfter() == all - 1);
  }
}

TEST_CASE("a lid fills an outline that is not convex, and faces as the mesh around it", "[cages][fit]") {
  std::vector<Flat> outline{{0, 0}, {4, 0}, {4, 3}, {2, 1}, {0, 3}};  // Counter-clockwise; the mesh is on its right.
  for (const double side : {1.0, -1.0}) {
    const std::vector<Triangle3> lid = lidOf(outline);
    REQUIRE(lid.size() == 3);
    double area = 0;
    for (const auto& [a, b, c] : lid) {
      const Flat &p = outline[a], &q = outline[b], &r = outline[c];
      const double twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
      CHECK(-side * twice > 0);
      area += std::abs(twice) / 2;
    }
    CHECK(area == Approx(8));
    for (Flat& p : outline) p.x = -p.x;
  }
  CHECK(lidOf({{0, 0}, {2, 2}, {2, 0}, {0, 2}, {1, 3}}).empty());
}

TEST_CASE("a jaw of which only the chin is known moves with it", "[cages][fit]") {
  const std::vector<Landmark> own{{"chin", {0, -1, 1}}, {"menton", {0, -1.5F, 0.5F}}, {"ear_lobe_left", {1, 0, 0}}};
  std::vector<Landmark> to{{"chin", {0, -2, 1}}, {"ear_lobe_left", {1, 0, 0}}};
  const std::vector<Anchor> anchors = jawAnchors(own, to);
  REQUIRE(anchors.size() == 2);
  CHECK(length(anchors[0].to - Vec3{0, -2.5, 0.5}) < 1e-6);
  const Vec3 move = anchors[1].to - anchors[1].from;
  CHECK(move.y < 0);
  CHECK(move.y > -1);
  to.push_back({"menton", {0, -2.4F, 0.5F}});
  CHECK(jawAnchors(own, to).empty());
}

TEST_CASE("an eye of which only one corner is known is held by its centre, too", "[cages][fit]") {
  std::vector<Landmark> eye{{"eye_centre_left", {1, 0, 0}}, {"eye_inner_left", {0.8F, 0, 0}}};
  CHECK(landmarkAnchors(eye, eye, false).size() == 2);
  eye.push_back({"eye_outer_left", {1.2F, 0, 0}});
  CHECK(landmarkAnchors(eye, eye, false).size() == 2);
}

TEST_CASE("the outline of a mask is no neck, and may end anywhere on a head", "[cages][fit]") {
  Heads heads;
  heads.cage = OwnedModel{};
  heads.cage.roll(
      24, 12, [](double u, double v) { return headPoint(kOwn, 2 * kPi * u + kPi, -0.9 + 2.4 * v, 0.04); },
      [](double u, double v) { return std::abs(u - 0.5) < 0.2 && v < 0.8; });
  heads.cage.groups.clear();
  const auto isBehind = [](const Landmark& landmark) {
    return landmark.name == "crown" || landmark.name == "occiput" || landmark.name.starts_with("ear");
  };
  std::erase_if(heads.own, isBehind);
  std::erase_if(heads.given, isBehind);
  const TemplateCage mask = prepareTemplate(heads.from());
  CHECK(mask.rim == -1);
  const std::vector<float> fitted = heads.fitted();
  double off = 0;
  for (const std::uint32_t v : heads.cage.indices) {
    const double latitude = -0.9 + 2.4 * static_cast<double>(v / 25) / 12;
    const double longitude = 2 * kPi * static_cast<double>(v % 25) / 24 + kPi;
    const Vec3 wanted = headPoint(kOther, longitude, latitude, 0.04);
    off = std::max(off, length(Vec3::from(&fitted[std::size_t{3} * v]) - wanted));
  }
  CHECK(off < 0.15);
}

TEST_CASE("the neck is the border about as long as the template's and about there, not the longest", "[cages][fit]") {
  const OwnedModel cageMesh = headMesh(kOwn, 20, 12, 0.04), model = headMesh(kOwn, 60, 40, 0);
  const TemplateCage cage = prepareTemplate({cageMesh.view(), headLandmarks(kOwn)});
  const TriangleMesh head = weldExactly(model.view());
  const Axes axes = axesOf(headLandmarks(kOwn));
  const std::vector<Anchor> anchors = rimAnchors(cage, head, axes);
  REQUIRE(anchors.size() == 8);
  // A jacket around the neck, open at its collar and longer at its hem.
  OwnedModel cloth;
  cloth.roll(
      40, 10,
      [](double u, double v) {
        const double wide = 0.7 + 1.3 * (1 - v);
        return Vec3{wide * std::sin(2 * kPi * u), -4 + 3 * v, wide * std::cos(2 * kPi * u)};
      },
      [](double, double) { return true; });
  const TriangleMesh jacket = weldExactly(cloth.view());
  const std::vector<Anchor> dressed = rimAnchors(cage, together(head, jacket), axes);
  REQUIRE(dressed.size() == anchors.size());
  for (std::size_t i = 0; i < anchors.size(); ++i) CHECK(length(dressed[i].to - anchors[i].to) < 1e-9);
  CHECK(rimAnchors(cage, mapped(jacket, [](const Vec3& p) { return p - Vec3{0, 2, 0}; }), axes).empty());
  // What is below the neck is not seen.
  const std::vector<bool> below = belowRim(cage, cage.mesh.positions, together(head, jacket));
  for (std::size_t t = 0; t < below.size(); ++t)
    if (t < head.triangles.size()) REQUIRE_FALSE(below[t]);
  CHECK(std::count(below.begin(), below.end(), true) > std::ptrdiff_t(jacket.triangles.size() / 2));
}

TEST_CASE("a neck may be ragged, and what is far from the template's is none, however long", "[cages][fit]") {
  const OwnedModel cageMesh = headMesh(kOwn, 20, 12, 0.04);
  const TemplateCage cage = prepareTemplate({cageMesh.view(), headLandmarks(kOwn)});
  const TriangleMesh head = weldExactly(headMesh(kOwn, 120, 40, 0).view());
  const Axes axes = axesOf(headLandmarks(kOwn));
  const std::vector<Anchor> smooth = rimAnchors(cage, head, axes);
  REQUIRE(smooth.size() == 8);
  const TriangleMesh ragged = mapped(head, [](const Vec3& p) {
    const double tooth = p.y < -0.85 ? 0.04 * std::cos(60 * std::atan2(p.x / 0.75, p.z / 0.9)) : 0;
    return p + Vec3{0, tooth, 0};  // Its border is 2.5 times as long.
  });
  const std::vector<Anchor> anchors = rimAnchors(cage, ragged, axes);
  REQUIRE(anchors.size() == smooth.size());
  for (std::size_t i = 0; i < anchors.size(); ++i) CHECK(length(anchors[i].to - smooth[i].to) < 0.05);
  const Vec3 away{0, -0.17 * cage.diagonal, 0};
  CHECK(rimAnchors(cage, mapped(head, [&](const Vec3& p) { return p + away; }), axes).empty());
}

TEST_CASE("the template of a head leaves clothes bare, and what no joint of head or neck holds", "[cages][fit]") {
  Model model;
  model.parts = {"Face", "Wolf3D_Outfit_Top", "a", "b", "c", "Body/Skin", "Suit_Head"};
  for (const char* name : {"Hips", "Spine2", "LeftArm", "RightArm", "Neck", "Head"})
    model.joints.push_back({name, {}, static_cast<std::int32_t>(model.joints.size()) - 1});
  const std::vector<std::uint16_t> held = {5, 4, 1, 4, 4, 4, 5};  // a: by the spine.
  std::vector<float> positions;
  std::vector<std::uint32_t> indices, groups, triangleOf;
  std::vector<std::uint16_t> joints;
  for (std::uint32_t p = 0; p < held.size(); ++p) {
    const float y = -static_cast<float>(p);
    positions.insert(positions.end(), {0, y, 0, 1, y, 0, 0, y, 1});
    indices.insert(indices.end(), {3 * p, 3 * p + 1, 3 * p + 2});
    groups.insert(groups.end(), 3, p);
    joints.insert(joints.end(), 3, held[p]);
    triangleOf.push_back(p);
  }
  model.mesh = {positions, indices, {}, groups};
  model.vertexJoints = joints;
  std::vector<Landmark> face{{"nose_tip", {0.2F, 0, 0.2F}}};
  const TriangleMesh skin = weldExactly(model.mesh);
  std::vector<bool> isBelow(held.size(), true);
  isBelow[3] = false;
  const auto beside = [&] { return partsBesideHead(model, skin, triangleOf, isBelow, face); };
  CHECK(beside() == std::vector<std::uint32_t>{1, 2, 4, 6});
  face[0].position[1] = -6;
  CHECK(beside() == std::vector<std::uint32_t>{0, 1, 2, 4});
  // Without names nothing can be said, whatever the numbers of groups.
  model.parts.clear();
  CHECK(beside().empty());
}

TEST_CASE("a rim of very many points, and one that is huge, are read in no time", "[cages][fit]") {
  const OwnedModel cageMesh = headMesh(kOwn, 20, 12, 0.04);
  const TemplateCage cage = prepareTemplate({cageMesh.view(), headLandmarks(kOwn)});
  TriangleMesh target = weldExactly(headMesh(kOwn, 60, 40, 0).view());
  const auto anchors = [&] { return rimAnchors(cage, target, axesOf(headLandmarks(kOwn))); };
  const std::vector<Anchor> few = anchors();
  REQUIRE(few.size() == 8);
  target = weldExactly(headMesh(kOwn, 20000, 2, 0).view());
  const std::vector<Anchor> many = anchors();
  REQUIRE(many.size() == few.size());
  for (std::size_t i = 0; i < many.size(); ++i) CHECK(length(many[i].to - few[i].to) < 0.1);
  for (Vec3& p : target.positions) p = 1e5 * p;
  CHECK(anchors().empty());
}
