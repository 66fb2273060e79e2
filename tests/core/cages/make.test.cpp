#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "cagecast/cages.hpp"
#include "landmarks/landmark_list.hpp"
#include "make/hole_marker.hpp"
#include "make/steps.hpp"
#include "mesh/surface.hpp"
#include "painted_egg.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

/// The numbers of the parts with some names.
std::vector<std::uint32_t> partsNamed(const OwnedModel& model, const std::vector<std::string>& names) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t p = 0; p < model.parts.size(); ++p)
    if (std::find(names.begin(), names.end(), model.parts[p]) != names.end()) out.push_back(p);
  return out;
}

std::vector<std::uint32_t> allParts(const OwnedModel& model) { return partsNamed(model, model.parts); }

/// A ball of a head that looks along +z, open below, with two eyes that stand out a little.
OwnedModel head() {
  OwnedModel out;
  out.add("skin", mapped(sphere({0, 0, 0}, 1, 24, 4), [](const Vec3& p) { return Vec3{p.x, -p.y, -p.z}; }));
  out.add("l-eye", sphere({0.35, 0.2, 0.8}, 0.2, 12));
  out.add("r-eye", sphere({-0.35, 0.2, 0.8}, 0.2, 12));
  return out;
}

TriangleMesh meshOf(const Cage& cage) { return weldExactly(cage.view()); }

Cage made(const Model& model, MakeOptions options = {}) {
  // Quicker than by default.
  if (options.voxels == 0) options.voxels = 60;
  if (options.triangles == 0) options.triangles = 300;
  Cage cage;
  const Status status = makeCage(model, options, {}, cage);
  CAPTURE(describe(status, model));
  REQUIRE(status.ok());
  return cage;
}

bool hasHoleAt(const TriangleMesh& mesh, const Vec3& spot, double within) {
  const auto loops = boundaryLoops(mesh);
  return std::any_of(loops.begin(), loops.end(),
                     [&](const auto& loop) { return length(middleOf(mesh, loop) - spot) < within; });
}

std::string faultOf(const Model& model, MakeOptions options = {}) {
  if (options.voxels == 0) options.voxels = 60;
  Cage cage;
  const Status status = makeCage(model, options, {}, cage);
  CHECK((status.argument == Argument::model || status.code == Code::badOption));
  return describe(status, model);
}

}  // namespace

TEST_CASE("a made cage is around its model, with holes over eyes and at the neck", "[cages][make]") {
  OwnedModel model = head();
  const Cage cage = made(model.model());
  const TriangleMesh mesh = meshOf(cage);
  CHECK(cage.uvs.size() / 2 == cage.positions.size() / 3);
  CHECK(std::all_of(cage.uvs.begin(), cage.uvs.end(), [](float x) { return x >= 0 && x <= 1; }));
  CHECK(boundaryLoops(mesh).size() == 3);
  for (const double x : {-0.35, 0.35}) CHECK(hasHoleAt(mesh, {x, 0.2, 1}, 0.2));
  CHECK(hasHoleAt(mesh, {0, -1, 0}, 0.3));
  const Surface surface(mesh);
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}}) {
    const SurfacePoint point = surface.closest(direction);
    CHECK(point.height < 0);
    CHECK(point.distance < 0.12);
  }
  // The same in every run, and with vertices that no triangle uses.
  append(model.positions, {500, 0, 0});
  model.groups.push_back(0);
  const Cage again = made(model.model());
  CHECK(again.positions == cage.positions);
  CHECK(again.uvs == cage.uvs);
  CHECK(again.indices == cage.indices);
}

TEST_CASE("strands of hair and visors are no necks", "[cages][make]") {
  OwnedModel model = head();
  TriangleMesh strand, visor;
  for (std::uint32_t k = 0; k < 12; ++k) {
    const double down = 0.1 + 0.1 * k;
    for (const double aside : {-0.05, 0.05})
      strand.positions.push_back(1.03 * Vec3{-std::sin(down), std::cos(down), aside * std::sin(down)});
    if (k == 11) break;
    strand.triangles.push_back({2 * k, 2 * k + 2, 2 * k + 1});
    strand.triangles.push_back({2 * k + 1, 2 * k + 2, 2 * k + 3});
  }
  visor.positions = {{-0.5, 0.5, 1.05}, {0.5, 0.5, 1.05}, {0.5, -0.5, 1.05}, {-0.5, -0.5, 1.05}, {0, 0, 1.1}};
  for (std::uint32_t k = 0; k < 4; ++k) visor.triangles.push_back({4, (k + 1) % 4, k});
  model.add("strand", strand);
  model.add("visor", visor);
  MakeOptions options;
  options.kind = Kind::head;
  const std::vector<std::uint32_t> all = allParts(model);
  options.parts.keep = all;
  const TriangleMesh mesh = meshOf(made(model.model(), options));
  REQUIRE(boundaryLoops(mesh).size() == 1);
  CHECK(hasHoleAt(mesh, {0, -1, 0}, 0.3));
}

TEST_CASE("an ignored part is not there: the cage is as without it", "[cages][make]") {
  OwnedModel model = head();
  const Cage expected = made(model.model());
  model.add("cloak", sphere({0, -3, 0}, 2, 12));
  MakeOptions options;
  const std::vector<std::uint32_t> cloak = partsNamed(model, {"cloak"});
  options.parts.ignore = cloak;
  const Cage cage = made(model.model(), options);
  CHECK(cage.positions == expected.positions);
  CHECK(cage.uvs == expected.uvs);
  const std::vector<std::uint32_t> all = allParts(model);
  options.parts.ignore = all;
  CHECK(faultOf(model.model(), options) == "model has no triangles; at least one is needed");
  const std::vector<std::uint32_t> none{9};
  options.parts.ignore = none;
  CHECK(faultOf(model.model(), options) == "options.parts.ignore has group 9, of which there is no vertex");
}

TEST_CASE("names say what is excluded, unless lists of parts do", "[cages][make]") {
  const OwnedModel model = head();
  MakeOptions options;
  const std::vector<std::uint32_t> left = partsNamed(model, {"l-eye"});
  options.parts.keep = left;
  const TriangleMesh mesh = meshOf(made(model.model(), options));
  CHECK_FALSE(hasHoleAt(mesh, {0.35, 0.2, 1}, 0.2));
  CHECK(hasHoleAt(mesh, {-0.35, 0.2, 1}, 0.2));
}

TEST_CASE("wheels without a name are known by their shape", "[cages][make]") {
  OwnedModel car;
  const auto box = [](const Vec3& low, const Vec3& high) {
    return mapped(sphere({0, 0, 0}, 1, 24), [&](const Vec3& p) {
      const double r = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      const Vec3 half = 0.5 * (high - low);
      return 0.5 * (low + high) + Vec3{half.x * p.x / r, half.y * p.y / r, half.z * p.z / r};
    });
  };
  car.add("mesh", box({-0.8, 0.25, -2}, {0.8, 1.3, 2}));
  const auto disc = [](double x, double z, double radius, double thick) {
    return mapped(sphere({0, 0, 0}, 1, 24), [&](const Vec3& p) {
      return Vec3{x + 0.5 * thick * std::clamp(3 * p.x, -1.0, 1.0), radius * p.y + 0.35, z + radius * p.z};
    });
  };
  for (const double x : {-0.85, 0.85})
    for (const double z : {-1.2, 1.2}) {
      car.add("mesh", disc(x, z, 0.35, 0.25));
      car.add("mesh", disc(x * 1.1, z, 0.2, 0.12));  // The rim.
    }
  car.add("mesh", box({-0.3, 0, -2.1}, {0.3, 0.3, -1.8}));  // Something else on the ground.
  Model model = car.model();
  std::vector<std::uint32_t> triangleOf;
  const std::vector<bool> wheels = wheelsOf(weldExactly(model.mesh, nullptr, &triangleOf));
  for (std::size_t t = 0; t < wheels.size(); ++t) {
    const std::uint32_t part = car.groups[car.indices[std::size_t{3} * triangleOf[t]]];
    if (wheels[t] != (part >= 1 && part <= 8)) FAIL_CHECK("triangle " << t << " of part " << part);
  }
  const TriangleMesh cage = meshOf(made(model));
  for (const double z : {-1.2, 1.2}) CHECK(hasHoleAt(cage, {1, 0.35, z}, 0.35));
  // A heap of coins has none.
  OwnedModel coins;
  for (int i = 0; i < 100; ++i) coins.add("mesh", disc(i, 0, 0.35, 0.25));
  const std::vector<bool> none = wheelsOf(weldExactly(coins.view()));
  CHECK(std::find(none.begin(), none.end(), true) == none.end());
}

TEST_CASE("grounds and backdrops are left out", "[cages][make]") {
  const OwnedModel model = head();
  const Cage alone = made(model.model());
  OwnedModel onGround = model;
  const auto plate = [](const Vec3& corner, const Vec3& a, const Vec3& b) {
    return TriangleMesh{{corner, corner + a, corner + a + b, corner + b}, {{0, 1, 2}, {0, 2, 3}}};
  };
  onGround.add("plane", plate({-5, -1.1, 5}, {10, 0, 0}, {0, 0, -10}));
  onGround.add("wall", plate({-5, -1.1, -3}, {10, 0, 0}, {0, 9, 0}));
  const Cage cage = made(onGround.model());
  CHECK(cage.positions == alone.positions);
  CHECK(cage.kind == alone.kind);
  // What is as wide as the rest is part of it.
  OwnedModel sole = model;
  sole.add("sole", plate({-1, -1.1, 1}, {2, 0, 0}, {0, 0, -2}));
  CHECK(made(sole.model()).positions != alone.positions);
}

TEST_CASE("hair, a beard and brows leave no face bare", "[cages][make]") {
  OwnedModel model = head();
  const auto shell = [](double low, double high, double z) {
    TriangleMesh out = sphere({0, 0, 0}, 1.12, 24);
    std::erase_if(out.triangles, [&](const Triangle3& t) {
      const Vec3 c = centroid(out, t);
      return c.y < low || c.y > high || c.z < z;
    });
    return out;
  };
  model.add("fringe_hair", shell(0.5, 2, -2));
  model.add("beard", shell(-0.9, -0.1, 0.2));
  const TriangleMesh cage = meshOf(made(model.model()));
  const Surface surface(cage);
  // In front of the forehead and the chin; the back of the head has a hole, as hair is not to be painted.
  for (const Vec3& spot : {Vec3{0, 0.65, 0.9}, Vec3{0.2, 0.6, 0.95}, Vec3{0, -0.5, 1}, Vec3{-0.3, -0.5, 0.95}}) {
    const SurfaceRay ray{spot, Vec3{0, 0, 1}};
    CHECK(std::isfinite(surface.trace({&ray, 1})[0].distance));
  }
  for (const double x : {-0.35, 0.35}) CHECK(hasHoleAt(cage, {x, 0.2, 1}, 0.25));
  const SurfaceRay behind{{0, 0.8, -0.6}, {0, 0, -1}};
  CHECK(std::isinf(surface.trace({&behind, 1})[0].distance));
  // Where there is nothing but hair, there is no face.
  OwnedModel wig;
  wig.add("hair", sphere({0, 0, 0}, 1, 24));
  Model known = wig.model();
  for (const auto& [name, x] : {std::pair{"eye_inner_left", 0.1f},
                                {"eye_outer_left", 0.4f},
                                {"eye_inner_right", -0.1f},
                                {"eye_outer_right", -0.4f}})
    known.hints.push_back({name, {x, 0.2f, 0.9f}});
  CHECK(faultOf(known) == "model has nothing to paint: all that is seen of it is excluded");
}

TEST_CASE("a mark, as by a brush, gets its hole", "[cages][make]") {
  OwnedModel model;
  model.add("ball", sphere({2, 0, 0}, 1, 32));
  const TriangleMesh ball = weldExactly({model.positions, model.indices});
  for (const Triangle3& t : ball.triangles) model.marks.push_back(ball.positions[t[0]].z > 0.93 ? 1 : 0);
  const TriangleMesh mesh = meshOf(made(model.model()));
  REQUIRE(boundaryLoops(mesh).size() == 1);
  CHECK(hasHoleAt(mesh, {2, 0, 1}, 0.15));
  model.marks.assign(model.marks.size(), 0);
  CHECK(boundaryLoops(meshOf(made(model.model()))).empty());
}

TEST_CASE("a hole over a part that stays covered is widened farther each time", "[cages][make]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 32);
  const Surface surface(ball);
  std::vector<bool> isMarked;
  for (const Triangle3& t : ball.triangles) isMarked.push_back(ball.positions[t[0]].z > 0.9);
  const MarkedMesh marked{&ball, &surface, isMarked};
  TriangleMesh hull = sphere({0, 0, 0}, 1.02, 48);
  const TriangleMesh closed = hull;  // A cage that covers the part as if it had no hole.
  HoleMarker marker(marked, 0.05, hull);
  REQUIRE(marker.mark(0, {}));
  const auto open = [&] {
    const std::vector<double> field = marker.field();
    return std::count_if(field.begin(), field.end(), [](double share) { return share > 0.5; });
  };
  double covered = 0;
  for (int time = 0; time < 4; ++time) {
    const auto before = open();
    REQUIRE(marker.widen(closed, {}, covered));
    CHECK(covered == 1);
    CHECK(open() > before);
  }
  TriangleMesh with = cutHoles(hull, marker.field());
  const auto before = open();
  REQUIRE(marker.widen(with, {}, covered));
  CHECK(covered == 0);
  CHECK(open() == before);
  CHECK_FALSE(marker.widen(
      closed, [](float, const char*) { return false; }, covered));
  CHECK(open() == before);
}

TEST_CASE("a cage has about as many triangles as asked for", "[cages][make]") {
  const OwnedModel model = head();
  for (const std::uint32_t triangles : {200u, 1000u}) {
    MakeOptions options;
    options.triangles = triangles;
    const std::size_t count = made(model.model(), options).indices.size() / 3;
    CHECK(count > triangles * 9 / 10);
    CHECK(count < triangles * 21 / 20);
  }
}

TEST_CASE("many triangles that are asked for are left", "[cages][make]") {
  TriangleMesh simple;
  REQUIRE(simplify(sphere({0, 0, 0}, 1, 200), {20000, 0.01}, {}, simple));
  CHECK(simple.triangles.size() > 19000);
  CHECK(simple.triangles.size() <= 20000);
}

TEST_CASE("a part of thousands of needles is looked at about as often as one of few triangles", "[cages][make]") {
  OwnedModel model;
  model.add("body", sphere({0, 0, 0}, 1));
  TriangleMesh tube;
  constexpr std::uint32_t kSides = 4000;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double around = 2 * 3.14159265358979 * i / kSides;
    for (const double x : {-0.45, 0.45})
      tube.positions.push_back({x, 0.95 + 0.12 * std::cos(around), 0.12 * std::sin(around)});
    const std::uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % kSides), d = c + 1;
    tube.triangles.push_back({a, c, b});
    tube.triangles.push_back({b, c, d});
  }
  model.add("window", tube);
  // Each call of the callback stands for some thousand points.
  int calls = 0;
  const Progress counting = [&](float, const std::string& stage) {
    calls += stage == "holes";
    return true;
  };
  MakeOptions options;
  options.voxels = 60;
  Cage cage;
  REQUIRE(makeCage(model.model(), options, counting, cage).ok());
  CHECK(boundaryLoops(meshOf(cage)).size() == 1);
  CHECK(calls < 200);
}

TEST_CASE("a cage does not depend on the model's unit, place or winding", "[cages][make]") {
  OwnedModel model = head();
  const std::size_t loops = boundaryLoops(meshOf(made(model.model()))).size();
  for (float& x : model.positions) x = 100 * x + 50;
  for (std::size_t i = 0; i < model.indices.size(); i += 3) std::swap(model.indices[i], model.indices[i + 1]);
  const TriangleMesh mesh = meshOf(made(model.model()));
  CHECK(boundaryLoops(mesh).size() == loops);
  CHECK(hasHoleAt(mesh, {85, 70, 150}, 20));
  CHECK(Surface(mesh).closest(Vec3{50, 150, 50}).height < 0);
  // So far away that floats are about 0.1 % of the model apart.
  for (float& x : model.positions) x += 4e6f;
  CHECK(boundaryLoops(meshOf(made(model.model()))).size() == loops);
}

TEST_CASE("making a cage can be cancelled, and tells how far it is", "[cages][make]") {
  const OwnedModel model = head();
  MakeOptions options;
  options.voxels = 50;
  Cage cage;
  checkProgress([&](const Progress& progress) { return makeCage(model.model(), options, progress, cage).ok(); },
                {-1, 0.2f, 0.4f, 0.55f, 0.7f, 0.9f, 1});
}

TEST_CASE("looking for eyes by their shape can be cancelled", "[cages][make]") {
  OwnedModel model = head();
  std::fill(model.parts.begin(), model.parts.end(), "mesh");
  MakeOptions options;
  options.kind = Kind::head;
  Cage cage;
  std::string stage;
  const auto stops = [&](float, const char* what) {
    stage = what;
    return false;
  };
  CHECK(makeCage(model.model(), options, stops, cage).code == Code::aborted);
  CHECK(stage == "landmarks");
}

TEST_CASE("lengths that the grid is too coarse for count as the least that it can show", "[cages][make]") {
  const OwnedModel model = head();
  MakeOptions options;
  options.closing = options.offset = 0.0005f;
  const std::vector<std::uint32_t> all = allParts(model);
  options.parts.keep = all;
  for (const std::uint32_t voxels : {16u, 40u}) {
    CAPTURE(voxels);
    options.voxels = voxels;
    const Cage cage = made(model.model(), options);
    CHECK(length(Vec3::from(&cage.positions[0])) < 1.6);
    CHECK(diagonalOf(meshOf(cage)) > 3);
  }
}

TEST_CASE("a model that is not manifold gets its cage", "[cages][make]") {
  OwnedModel model = head();
  model.addFins();
  const TriangleMesh mesh = meshOf(made(model.model()));
  CHECK(boundaryLoops(mesh).size() == 3);
  CHECK(hasHoleAt(mesh, {0.35, 0.2, 1}, 0.2));
  CHECK(Surface(mesh).closest(Vec3{0, 1, 0}).height < 0);
}

TEST_CASE("a spike that is flattened to a double sheet is removed", "[cages][make]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 12);
  TriangleMesh mesh = ball;
  const auto [a, b, other] = mesh.triangles[40];
  const auto c = static_cast<std::uint32_t>(mesh.positions.size()), d = c + 1;
  mesh.positions.push_back(1.5 * mesh.positions[b]);
  mesh.positions.push_back(1.5 * mesh.positions[a]);
  for (const Triangle3& t : {Triangle3{b, a, d}, {b, d, c}, {a, b, c}, {a, c, d}}) mesh.triangles.push_back(t);
  TriangleMesh simple;
  REQUIRE(simplify(mesh, {static_cast<std::uint32_t>(mesh.triangles.size()), 0.01}, {}, simple));
  CHECK(simple.triangles.size() == ball.triangles.size());
  CHECK(diagonalOf(simple) == diagonalOf(ball));
}

TEST_CASE("a made cage knows the kind of its model", "[cages][make]") {
  const OwnedModel model = head();
  MakeOptions options;
  options.voxels = 40;
  CHECK(made(model.model(), options).kind == Kind::head);
  options.kind = Kind::prop;
  CHECK(made(model.model(), options).kind == Kind::prop);
  options.kind = static_cast<Kind>(77);
  CHECK(faultOf(model.model(), options) == "options.kind = 77 is not a kind");
}

TEST_CASE("pieces that lie a little too far apart are bridged, all of them or none", "[cages][make]") {
  // A figure of boxes, as robots are.
  const auto robot = [](double gap) {
    OwnedModel model;
    const auto add = [&](const char* name, Vec3 low, Vec3 high) {
      model.add(name, mapped(sphere({0, 0, 0}, 1, 8), [&](const Vec3& p) {
                  const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
                  const Vec3 q = 0.5 / most * p, size = high - low;
                  return 0.5 * (low + high) + Vec3{q.x * size.x, q.y * size.y, q.z * size.z};
                }));
    };
    add("torso", {-0.25, 0.8, -0.15}, {0.25, 1.4, 0.15});
    add("head", {-0.15, 1.4 + gap, -0.15}, {0.15, 1.7 + gap, 0.15});
    for (const double side : {-1.0, 1.0}) {
      const auto between = [&](double from, double to, double low, double high, double deep) {
        add("limb", {std::min(side * from, side * to), low, -deep}, {std::max(side * from, side * to), high, deep});
      };
      between(0.25 + gap, 0.4 + gap, 0.8, 1.4, 0.075);
      between(0.05, 0.23, 0, 0.82, 0.1);
    }
    return model;
  };
  const OwnedModel near = robot(0.06);
  const Cage cage = made(near.model());
  CHECK(cage.kind == Kind::body);
  const Surface surface(meshOf(cage));
  const auto isInside = [&](const Vec3& p) { return surface.closest(p).height < 0; };
  for (const Vec3& middle : {Vec3{0, 1.1, 0}, {0, 1.6, 0}, {0.4, 1.1, 0}, {-0.4, 1.1, 0}, {0.14, 0.4, 0}})
    CHECK(isInside(middle));
  const std::string apart =
      "model is in pieces that lie too far apart for one cage: make one for each, leave out some, or bridge wider gaps";
  CHECK(faultOf(robot(0.2).model()) == apart);
  MakeOptions options;
  options.closing = 0.008f;
  options.voxels = 80;
  CHECK(faultOf(near.model(), options) == apart);
  // What is not painted may be left out.
  const std::vector<std::uint32_t> others = partsNamed(near, {"head", "limb"});
  options.parts.exclude = others;
  const Cage torso = made(near.model(), options);
  CHECK(Surface(meshOf(torso)).closest(Vec3{0, 1.1, 0}).height < 0);
}

TEST_CASE("what no cage can be made for is said in a sentence", "[cages][make]") {
  OwnedModel model = head();
  MakeOptions options;
  const std::vector<std::uint32_t> all = allParts(model);
  options.parts.exclude = all;
  CHECK(faultOf(model.model(), options) == "model has nothing to paint: all that is seen of it is excluded");
  CHECK(faultOf({}) == "model has no vertices; at least one is needed");
  MakeOptions closing, offset, voxels, triangles;
  closing.closing = -1;
  offset.offset = NAN;
  voxels.voxels = 1000;
  triangles.triangles = 3;
  CHECK(faultOf(model.model(), closing) == "options.closing = -1 is not within 0.0005..0.2");
  CHECK(faultOf(model.model(), offset) == "options.offset = nan is not within 0.0005..0.2");
  CHECK(faultOf(model.model(), voxels) == "options.voxels = 1000 is not within 16..400");
  CHECK(faultOf(model.model(), triangles) == "options.triangles = 3 is not within 50..20000");
}

TEST_CASE("a thing as compact as a head is one if it has eyes", "[cages][make]") {
  const auto bust = [](double eyesAt) {
    OwnedModel out;
    out.add("mesh", sphere({0, 0, 0}, 1, 24));
    for (const double x : {-0.35, 0.35}) out.add("mesh", sphere({x, 0.2, eyesAt}, 0.2, 12));
    return out;
  };
  const OwnedModel closed = bust(0.8);
  CHECK(kindOf(closed.model()) == Kind::prop);
  const Cage cage = made(closed.model());
  CHECK(cage.kind == Kind::head);
  const TriangleMesh mesh = meshOf(cage);
  CHECK(boundaryLoops(mesh).size() == 2);
  for (const double x : {-0.35, 0.35}) CHECK(hasHoleAt(mesh, {x, 0.2, 1}, 0.2));
  CHECK(made(bust(0).model()).kind == Kind::prop);
  MakeOptions options;
  const std::vector<std::uint32_t> all = allParts(closed);
  options.parts.keep = all;
  CHECK(boundaryLoops(meshOf(made(closed.model(), options))).empty());
  options = {.kind = Kind::prop};
  CHECK(boundaryLoops(meshOf(made(closed.model(), options))).empty());
}

TEST_CASE("eyes that are only painted get holes", "[cages][make]") {
  const PaintedEgg egg({});
  const Cage cage = made(egg.model());
  CHECK(cage.kind == Kind::head);
  CHECK(findLandmark(cage.landmarks, "eye_centre_left") != nullptr);
  const TriangleMesh mesh = meshOf(cage);
  CHECK(boundaryLoops(mesh).size() == 2);
  for (const double x : {-kEye.x, kEye.x}) CHECK(hasHoleAt(mesh, {x, kEye.y, 0.8}, 0.1));
  MakeOptions options;
  const std::vector<std::uint32_t> kept{0};
  options.parts.keep = kept;
  CHECK(boundaryLoops(meshOf(made(egg.model(), options))).empty());
  // Where the colour of the eyes is that of the skin, nothing would be kept bare by holes.
  const Bytes clay{150, 150, 150};
  const Look bust{.skin = clay, .hair = clay, .white = clay, .iris = clay, .lips = clay};
  const PaintedEgg blank(bust);
  CHECK(boundaryLoops(meshOf(made(blank.model()))).empty());
}

TEST_CASE("loose eyes below hair get holes", "[cages][make]") {
  OwnedModel model = head();
  model.parts = {"mesh", "mesh", "mesh"};
  model.add("hair", ellipsoid({0, 0.9, -0.3}, {0.6, 0.4, 0.6}));
  const TriangleMesh mesh = meshOf(made(model.model()));
  for (const double x : {-0.35, 0.35}) CHECK(hasHoleAt(mesh, {x, 0.2, 1}, 0.25));
}

TEST_CASE("bones say what is up", "[cages][make]") {
  OwnedModel figure;
  figure.add("figure", ellipsoid({0, 0, 0}, {0.4, 1, 0.15}));
  Model rigged = figure.model();
  const auto add = [&](const char* name, float x, float y) { rigged.joints.push_back({name, {x, y, 0}, -1}); };
  add("hips", 0, 0);
  add("neck", 0, 0.7f);
  add("head", 0, 0.8f);
  for (const float side : {-1.0f, 1.0f}) {
    add(side < 0 ? "rightUpperLeg" : "leftUpperLeg", 0.1f * side, 0);
    add(side < 0 ? "rightLowerLeg" : "leftLowerLeg", 0.1f * side, -0.4f);
    add(side < 0 ? "rightFoot" : "leftFoot", 0.1f * side, -0.9f);
  }
  CHECK(kindOf(rigged) == Kind::body);
  // The same with z up, as Blender has it, and with x up.
  for (int turn = 0; turn < 2; ++turn) {
    for (std::size_t i = 0; i < figure.positions.size(); i += 3)
      std::rotate(&figure.positions[i], &figure.positions[i + 2], &figure.positions[i] + 3);
    for (Joint& joint : rigged.joints)
      std::rotate(joint.position.begin(), joint.position.begin() + 2, joint.position.end());
    rigged.mesh.positions = figure.positions;
    CHECK(kindOf(rigged) == Kind::body);
  }
  // On all fours, the head is not where the feet are not.
  for (Joint& joint : rigged.joints)
    if (joint.name.ends_with("Foot")) joint.position = {0, 0.3f, 0};
  CHECK(kindOf(rigged) != Kind::body);
}

TEST_CASE("the kind of a model is seen from its proportions, parts and joints", "[cages][make]") {
  CHECK(kindOf(head().model()) == Kind::head);
  OwnedModel car, figure;
  car.add("body", ellipsoid({0, 0, 0}, {2, 1, 4}));
  car.add("wheels", sphere({0, -1, 3}, 0.3));
  CHECK(kindOf(car.model()) == Kind::prop);
  figure.add("figure", ellipsoid({0, 0, 0}, {2, 4, 0.7}));
  CHECK(kindOf(figure.model()) == Kind::body);
  // The legs of a rig count where they are in the model.
  const OwnedModel bust = head();
  Model rigged = bust.model();
  rigged.joints = {{"LeftUpLeg", {0, -5, 0}, -1}};
  CHECK(kindOf(rigged) == Kind::head);
  rigged = car.model();
  rigged.joints = {{"front_leg.L", {0, 0, 0}, -1}};
  CHECK(kindOf(rigged) == Kind::prop);
}
