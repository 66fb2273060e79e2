#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "cagecast/cages.hpp"
#include "fit/anchors.hpp"
#include "fit/relax.hpp"
#include "fit/template_cage.hpp"
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

/// The surface of a simple head, open at the neck: a point by longitude (0 is the front) and latitude.
Vec3 headPoint(const Shape& shape, double longitude, double latitude, double offset) {
  const double x = std::cos(latitude) * std::sin(longitude), y = std::sin(latitude),
               z = std::cos(latitude) * std::cos(longitude);
  const double bump = 0.25 * shape.nose * std::exp(-12 * (x * x + y * y)) * (z > 0 ? 1 : 0);
  const double r = 1 + offset;
  return {0.75 * shape.width * r * x, 1.1 * r * y, 0.9 * r * z + bump};
}

struct HeadMesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices;
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs}; }
};

HeadMesh headMesh(const Shape& shape, std::uint32_t around, std::uint32_t rows, double offset) {
  HeadMesh mesh;
  const double low = -0.9, high = 1.5;  // Nearly closed: a fan of slivers at the pole would be folded by rounding.
  for (std::uint32_t r = 0; r <= rows; ++r)
    for (std::uint32_t a = 0; a <= around; ++a) {
      const double u = static_cast<double>(a % around) / around, v = static_cast<double>(r) / rows;
      const Vec3 p = headPoint(shape, 2 * std::numbers::pi * u + std::numbers::pi, low + v * (high - low), offset);
      for (const double x : {p.x, p.y, p.z}) mesh.positions.push_back(static_cast<float>(x));
      mesh.uvs.push_back(static_cast<float>(a) / static_cast<float>(around));
      mesh.uvs.push_back(static_cast<float>(v));
    }
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t a = 0; a < around; ++a) {
      const std::uint32_t i = r * (around + 1) + a, j = i + around + 1;
      mesh.indices.insert(mesh.indices.end(), {i, i + 1, j + 1});
      mesh.indices.insert(mesh.indices.end(), {i, j + 1, j});
    }
  return mesh;
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
  for (const Spot& spot : kSpots) {
    const Vec3 p = headPoint(shape, spot.longitude, spot.latitude, 0);
    landmarks.push_back({spot.name, {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}});
  }
  return landmarks;
}

constexpr Shape kOwn{}, kOther{1.15, 1.4};

/// A template, a model of another shape, and a call that expects to work.
struct Heads {
  HeadMesh cage = headMesh(kOwn, 24, 14, 0.04), own = headMesh(kOwn, 60, 40, 0), other = headMesh(kOther, 60, 40, 0);
  std::vector<Landmark> landmarks = headLandmarks(kOther);
  FittedCage out;

  [[nodiscard]] Template from() const { return {cage.view(), headLandmarks(kOwn)}; }
  [[nodiscard]] FitOptions options() const {
    FitOptions options;
    options.landmarks = landmarks;
    return options;
  }
  Outcome fit(const HeadMesh& model) { return fitCage(from(), {model.view()}, options(), {}, out); }
};

double diagonalOfView(const MeshView& view) { return diagonalOf(weldExactly(view)); }

}  // namespace

TEST_CASE("a model that encloses no volume is reported as such, by a fit as by making a cage", "[cages][fit]") {
  // A strip between two layers of the grid, and a template as thin.
  HeadMesh strip;
  strip.positions = {-0.2f, -1, 0, 0.2f, -1, 0, 0.2f, 1.1f, 0, -0.2f, 1.1f, 0};
  strip.indices = {0, 1, 2, 0, 2, 3};
  Heads heads;
  heads.cage = headMesh(kOwn, 24, 14, 0.001);
  for (std::size_t i = 0; i < heads.cage.positions.size(); ++i)
    heads.cage.positions[i] *= i % 3 == 0 ? 0.2f : i % 3 == 2 ? 0.001f : 1;
  heads.landmarks = headLandmarks(kOwn);
  std::erase_if(heads.landmarks, [](const Landmark& landmark) { return landmark.name == "occiput"; });
  for (Landmark& landmark : heads.landmarks) {
    landmark.position[0] *= 0.2f;
    landmark.position[2] *= 0.001f;
  }
  const Template from{heads.cage.view(), heads.landmarks};
  const Outcome outcome = fitCage(from, {strip.view()}, heads.options(), {}, heads.out);
  CHECK(outcome.problem == Problem::badModel);
  CHECK(outcome.message == "model is too thin for a hull: it encloses no volume");
}

TEST_CASE("a cage that is fitted to its own model stays where it is", "[cages][fit]") {
  Heads heads;
  heads.landmarks = headLandmarks(kOwn);
  REQUIRE(heads.fit(heads.own).ok());
  REQUIRE(heads.out.indices.size() == heads.cage.indices.size());
  CHECK(heads.out.uvs == heads.cage.uvs);
  const double diagonal = diagonalOfView(heads.cage.view());
  double most = 0;
  for (std::size_t i = 0; i < heads.out.positions.size(); i += 3)
    most = std::max(most, length(Vec3::from(&heads.out.positions[i]) - Vec3::from(&heads.cage.positions[i])));
  CHECK(most < 0.03 * diagonal);
}

TEST_CASE("a fitted cage encloses another head, and its points go where they belong", "[cages][fit]") {
  Heads heads;
  const Outcome outcome = heads.fit(heads.other);
  INFO(outcome.message);
  REQUIRE(outcome.ok());
  CHECK(heads.out.missing.empty());
  CHECK(heads.out.landmarks.size() == heads.landmarks.size());
  const HeadMesh truth = headMesh(kOther, 24, 14, 0.04);
  const double diagonal = diagonalOfView(truth.view());
  double sum = 0;
  for (std::size_t i = 0; i < truth.positions.size(); i += 3)
    sum += length(Vec3::from(&heads.out.positions[i]) - Vec3::from(&truth.positions[i]));
  CHECK(3 * sum / static_cast<double>(truth.positions.size()) < 0.02 * diagonal);
  const TriangleMesh fitted = weldExactly(heads.out.view());
  for (const bool folded : foldedTriangles(fitted)) CHECK_FALSE(folded);
  std::size_t outside = 0;
  const TriangleMesh skin = weldExactly(heads.other.view());
  for (const SurfacePoint& point : Surface(fitted).closest(skin.positions)) outside += point.height > 0 ? 1 : 0;
  CHECK(outside <= skin.positions.size() / 50);
}

TEST_CASE("a turned and scaled model gets a turned and scaled cage", "[cages][fit]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  const Cage upright = heads.out;
  const Vec3 axis{share(random), share(random), share(random)};
  Similarity map = shortestRotation({0, 1, 0}, 1 / length(axis) * axis);
  const double scale = std::pow(10.0, 2 * share(random));
  map.x = scale * map.x;
  map.y = scale * map.y;
  map.z = scale * map.z;
  map.translation = scale * Vec3{3 * share(random), 3 * share(random), 3 * share(random)};
  const auto apply = [&](float* at) {
    const Vec3 p = map(Vec3::from(at));
    at[0] = static_cast<float>(p.x);
    at[1] = static_cast<float>(p.y);
    at[2] = static_cast<float>(p.z);
  };
  HeadMesh turned = heads.other;
  for (std::size_t i = 0; i < turned.positions.size(); i += 3) apply(&turned.positions[i]);
  for (Landmark& landmark : heads.landmarks) apply(landmark.position.data());
  REQUIRE(heads.fit(turned).ok());
  const double diagonal = scale * diagonalOfView(heads.other.view());
  std::vector<double> differences;
  for (std::size_t i = 0; i < upright.positions.size(); i += 3) {
    const Vec3 expected = map(Vec3::from(&upright.positions[i]));
    differences.push_back(length(Vec3::from(&heads.out.positions[i]) - expected) / diagonal);
  }
  std::sort(differences.begin(), differences.end());
  // Positions are rounded to floats in both poses; a vertex between two equally near triangles may go to either.
  CHECK(differences[differences.size() * 9 / 10] < 2e-3);
  CHECK(differences.back() < 1e-2);
}

TEST_CASE("the same call gives the same cage", "[cages][fit]") {
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  const std::vector<float> first = heads.out.positions;
  REQUIRE(heads.fit(heads.other).ok());
  CHECK(heads.out.positions == first);
}

TEST_CASE("a fit can be cancelled", "[cages][fit]") {
  Heads heads;
  float last = 0;
  const Progress upToHalf = [&](float done, const char*) {
    CHECK(done >= last);
    last = done;
    return done < 0.5f;
  };
  const Outcome outcome = fitCage(heads.from(), {heads.other.view()}, heads.options(), upToHalf, heads.out);
  CHECK(outcome.problem == Problem::cancelled);
}

TEST_CASE("a model that is not manifold gets a fitted cage, too", "[cages][fit]") {
  Heads heads;
  addFins(heads.other.positions, heads.other.indices);
  heads.other.uvs.clear();
  const Outcome outcome = heads.fit(heads.other);
  INFO(outcome.message);
  REQUIRE(outcome.ok());
  const TriangleMesh fitted = weldExactly(heads.out.view());
  for (const bool folded : foldedTriangles(fitted)) CHECK_FALSE(folded);
  CHECK(Surface(fitted).closest(headPoint(kOther, 0, 1.2, 0)).height < 0);
}

TEST_CASE("vertices that no triangle uses make no difference to a fit", "[cages][fit]") {
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  const std::vector<float> before = heads.out.positions;
  heads.other.uvs.clear();
  for (const float x : {500.0f, 0.0f, 0.0f}) heads.other.positions.push_back(x);
  REQUIRE(heads.fit(heads.other).ok());
  CHECK(heads.out.positions == before);
}

TEST_CASE("vertices that no triangle of a template uses may be anywhere", "[cages][fit]") {
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  const std::vector<float> before = heads.out.positions;
  for (const float x : {1e6f, 1e6f, 1e6f}) heads.cage.positions.push_back(x);
  heads.cage.uvs.insert(heads.cage.uvs.end(), {0, 0});
  REQUIRE(heads.fit(heads.other).ok());
  heads.out.positions.resize(before.size());
  CHECK(heads.out.positions == before);
}

TEST_CASE("a cage is fitted to what its landmarks are on, whatever else there is", "[cages][fit]") {
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  const std::vector<float> alone = heads.out.positions;
  HeadMesh both = heads.other;
  const auto first = static_cast<std::uint32_t>(both.positions.size() / 3);
  const TriangleMesh pedestal = sphere({0, -4, 0}, 2);
  for (const Vec3& p : pedestal.positions)
    for (const double x : {p.x, p.y, p.z}) both.positions.push_back(static_cast<float>(x));
  for (const Triangle3& t : pedestal.triangles)
    for (const std::uint32_t v : t) both.indices.push_back(first + v);
  both.uvs.clear();
  REQUIRE(heads.fit(both).ok());
  double most = 0;
  for (std::size_t i = 0; i < alone.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(heads.out.positions[i] - alone[i])));
  CHECK(most < 0.02);  // Voxels are larger around both; drawn to the pedestal's hull, or to none, it is 0.04 and more.
}

TEST_CASE("a fitted cage has the kind of its template", "[cages][fit]") {
  Heads heads;
  Template from = heads.from();
  from.kind = Kind::head;
  REQUIRE(fitCage(from, {heads.other.view()}, heads.options(), {}, heads.out).ok());
  CHECK(heads.out.kind == Kind::head);
}

TEST_CASE("a cage can be fitted in place", "[cages][fit]") {
  Heads heads;
  REQUIRE(heads.fit(heads.other).ok());
  FittedCage inPlace;
  inPlace.positions = heads.cage.positions;
  inPlace.uvs = heads.cage.uvs;
  inPlace.indices = heads.cage.indices;
  const Template from{{inPlace.positions, inPlace.indices, inPlace.uvs}, headLandmarks(kOwn)};
  REQUIRE(fitCage(from, {heads.other.view()}, heads.options(), {}, inPlace).ok());
  CHECK(inPlace.positions == heads.out.positions);
  CHECK(inPlace.uvs == heads.out.uvs);
}

TEST_CASE("landmarks that contradict are named", "[cages][fit]") {
  Heads heads;
  const auto messageOf = [&] {
    const Outcome outcome = heads.fit(heads.other);
    CHECK(outcome.problem == Problem::badLandmarks);
    return outcome.message;
  };
  const std::vector<Landmark> good = heads.landmarks;
  SECTION("unknown") {
    heads.landmarks.push_back({"antler", {0, 0, 0}});
    CHECK(messageOf() ==
          "landmarks: the template has no antler; it has nose_tip, chin, crown, occiput, ear_top_left, ear_top_right, "
          "mouth_corner_left, mouth_corner_right, eye_centre_left, eye_centre_right");
  }
  SECTION("twice") {
    heads.landmarks.push_back(good[0]);
    CHECK(messageOf() == "landmarks: nose_tip is there twice");
  }
  SECTION("on one spot") {
    heads.landmarks[1].position = good[0].position;
    CHECK(messageOf() == "landmarks: nose_tip and chin are on one spot; each needs its own");
  }
  SECTION("both eyes on one spot") {
    heads.landmarks[9].position = good[8].position;
    CHECK(messageOf() == "landmarks: eye_centre_left and eye_centre_right are on one spot; each needs its own");
  }
  SECTION("in another unit") {
    for (Landmark& landmark : heads.landmarks)
      for (float& x : landmark.position) x *= 100;
    CHECK(messageOf().find(" diagonals outside the box of its model; it has to be in its unit and axes") !=
          std::string::npos);
  }
  SECTION("not finite") {
    heads.landmarks[0].position[1] = NAN;
    CHECK(messageOf() == "landmarks: nose_tip is not a finite position");
  }
  SECTION("left and right swapped") {
    for (Landmark& landmark : heads.landmarks) landmark.position[0] = -landmark.position[0];
    CHECK(messageOf() ==
          "landmarks: ear_top_left is on the other side: left and right are the figure's own, not the viewer's");
  }
  SECTION("one pair swapped") {
    std::swap(heads.landmarks[8].position, heads.landmarks[9].position);
    CHECK(messageOf() ==
          "landmarks: eye_centre_left is on the other side: left and right are the figure's own, not the viewer's");
  }
  SECTION("too few") {
    heads.landmarks.resize(1);
    CHECK(messageOf().find("at least 4 are needed; please give some of ") != std::string::npos);
  }
  SECTION("far off") {
    heads.landmarks[2].position = {0, -1, 0.5f};
    CHECK(messageOf().rfind("landmarks: crown is ", 0) == 0);
  }
  SECTION("several in other axes") {
    for (const std::size_t i : {0u, 1u, 6u, 7u}) {
      float* p = heads.landmarks[i].position.data();
      p[1] = -std::exchange(p[2], p[1]);
    }
    CHECK(messageOf().find("away from where the others put it") != std::string::npos);
  }
  SECTION("all under other names") {
    for (std::size_t i = 0; i < good.size(); ++i) heads.landmarks[i].position = good[(i + 3) % good.size()].position;
    CHECK(messageOf().find("landmarks: ") == 0);
  }
}

TEST_CASE("a skeleton in another unit than its mesh is an error", "[cages][fit]") {
  const std::pair<const char*, const char*> kJoints[] = {{"hips", "hips"},
                                                         {"upperChest", "chest"},
                                                         {"neck", "neck"},
                                                         {"head", "head"},
                                                         {"jaw", "jaw"},
                                                         {"leftUpperArm", "shoulder_left"},
                                                         {"rightUpperArm", "shoulder_right"}};
  const auto fitted = [&](float unit) {
    Heads heads;
    Template from = heads.from();
    Model model{heads.other.view()};
    float height = -0.9f;
    for (const auto& [joint, landmark] : kJoints) {
      from.landmarks.push_back({std::string("joint_") + landmark, {0, height, 0}});
      model.joints.push_back({joint, {0, unit * height, 0}});
      height += 0.3f;
    }
    return fitCage(from, model, heads.options(), {}, heads.out);
  };
  CHECK(fitted(1).ok());
  const Outcome large = fitted(100), small = fitted(0.01f);
  CHECK(large.problem == Problem::badModel);
  CHECK(large.message ==
        "model.joints: joint_hips is 26.4 diagonals outside the box of the mesh, at most 0.5 are expected; joints have "
        "to be in its unit and axes");
  CHECK(small.problem == Problem::badModel);
  CHECK(small.message ==
        "model.joints: the box of 7 joints is 0.00532 as large as that of the mesh, at least 0.05 is expected; joints "
        "have to be in its unit");
}

TEST_CASE("no more landmarks are taken than can be checked in a moment", "[cages][fit]") {
  Heads heads;
  for (int i = 0; i < 291; ++i) heads.landmarks.push_back({"spot_" + std::to_string(i), {0, 0, 0}});
  Outcome outcome = heads.fit(heads.other);
  CHECK(outcome.problem == Problem::badLandmarks);
  CHECK(outcome.message == "landmarks: 301 are given, at most 300 are allowed");
  Template from = heads.from();
  from.landmarks = heads.landmarks;
  outcome = fitCage(from, {heads.other.view()}, {}, {}, heads.out);
  CHECK(outcome.problem == Problem::badTemplate);
  CHECK(outcome.message == "template.landmarks: 301 are given, at most 300 are allowed");
}

TEST_CASE("landmarks that are needed are those that the template has", "[cages][fit]") {
  Heads heads;
  Template from = heads.from();
  for (std::size_t i = 0; i < from.landmarks.size(); ++i) from.landmarks[i].name = "spot_" + std::to_string(i);
  const Outcome outcome = fitCage(from, {heads.other.view()}, {}, {}, heads.out);
  CHECK(outcome.problem == Problem::badLandmarks);
  CHECK(outcome.message ==
        "landmarks: 0 are known, at least 4 are needed; please give some of spot_0, spot_1, spot_2, spot_3, spot_4, "
        "spot_5, spot_6, spot_7, spot_8, spot_9");
}

TEST_CASE("a template that cannot be fitted is refused", "[cages][fit]") {
  Heads heads;
  Template from = heads.from();
  const auto messageOf = [&] {
    const Outcome outcome = fitCage(from, {heads.other.view()}, {}, {}, heads.out);
    CHECK(outcome.problem == Problem::badTemplate);
    return outcome.message;
  };
  SECTION("no UVs") {
    from.cage.uvs = {};
    CHECK(messageOf() == "template.cage: it has no UVs; a cage needs 2 numbers per vertex");
  }
  SECTION("too few landmarks") {
    from.landmarks.resize(3);
    CHECK(messageOf() == "template: it has 3 landmarks; at least 4 are needed");
  }
}

TEST_CASE("relaxing unfolds what was moved over its neighbours, and leaves the rest where it is", "[cages][fit]") {
  const HeadMesh mesh = headMesh({}, 24, 16, 0.03);
  const std::vector<Landmark> landmarks = headLandmarks({});
  const TemplateCage cage = prepareTemplate({mesh.view(), landmarks});
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::vector<Vec3> positions = cage.mesh.positions;
  std::vector<bool> near(positions.size());
  const auto vertex = static_cast<std::uint32_t>(random() % positions.size());
  near[vertex] = true;
  grow(cage, near);
  // Two vertices change places.
  const std::uint32_t other = cage.neighbours[vertex][random() % cage.neighbours[vertex].size()];
  std::swap(positions[vertex], positions[other]);
  for (int ring = 0; ring < 4; ++ring) grow(cage, near);
  const auto foldCount = [&] {
    const std::vector<bool> folded = foldedTriangles({positions, cage.mesh.triangles});
    return std::count(folded.begin(), folded.end(), true);
  };
  REQUIRE(foldCount() > 0);
  relax(cage, std::vector<Vec3>(positions.size(), Vec3{0, 0, 0}), positions);
  CHECK(foldCount() == 0);
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!near[v]) CHECK(length(positions[v] - cage.mesh.positions[v]) == 0);
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

TEST_CASE("joints that are too few for a skeleton are an error", "[cages][fit]") {
  Heads heads;
  Template from = heads.from();
  static constexpr const char* kJoints[] = {"joint_head", "joint_neck", "joint_chest", "joint_spine"};
  from.landmarks.resize(4);
  heads.landmarks.resize(4);
  for (std::size_t i = 0; i < 4; ++i) from.landmarks[i].name = heads.landmarks[i].name = kJoints[i];
  const Outcome outcome = fitCage(from, {heads.other.view()}, heads.options(), {}, heads.out);
  CHECK(outcome.problem == Problem::badLandmarks);
  CHECK(outcome.message ==
        "landmarks: only 4 joints are known, too few for a skeleton of 6 bones; give more of them, or landmarks on the "
        "skin");
}

TEST_CASE("an eye of which only one corner is known is held by its centre, too", "[cages][fit]") {
  std::vector<Landmark> eye{{"eye_centre_left", {1, 0, 0}}, {"eye_inner_left", {0.8F, 0, 0}}};
  CHECK(landmarkAnchors(eye, eye, false).size() == 2);
  eye.push_back({"eye_outer_left", {1.2F, 0, 0}});
  CHECK(landmarkAnchors(eye, eye, false).size() == 2);
}

TEST_CASE("a rim that is huge beside the template's has its anchors", "[cages][fit]") {
  const HeadMesh cageMesh = headMesh(kOwn, 24, 14, 0.04), model = headMesh(kOwn, 60, 40, 0);
  const TemplateCage cage = prepareTemplate({cageMesh.view(), headLandmarks(kOwn)});
  TriangleMesh target = weldExactly(model.view());
  const auto anchors = [&] { return rimAnchors(cage, target, axesOf(headLandmarks(kOwn))); };
  const std::vector<Anchor> small = anchors();
  REQUIRE(small.size() == 8);
  constexpr double kScale = 1e5;
  for (Vec3& p : target.positions) p = kScale * p;
  const std::vector<Anchor> huge = anchors();
  REQUIRE(huge.size() == small.size());
  for (std::size_t i = 0; i < huge.size(); ++i) CHECK(length(1 / kScale * huge[i].to - small[i].to) < 0.1);
}
