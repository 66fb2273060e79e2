// Memory that runs out while cages are made, fitted, refined or landmarks are found: `std::bad_alloc`, and no crash.

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <new>

#include "cagecast/cages.hpp"
#include "out_of_memory/failing.hpp"
#include "shapes.hpp"

using namespace cagecast::cages;

namespace {

constexpr std::size_t kForever = std::numeric_limits<std::size_t>::max();
/// Calls that fail in each way: most of a call's thousands of allocations are made in the same loops.
constexpr std::size_t kCalls = 8;

/// Lets `call` run out of memory at allocations spread evenly over it.
/// @param start  What lets allocations fail after so many.
template <typename Call>
void failHereAndThere(const Call& call, void (*start)(std::size_t)) {
  start(kForever);
  const bool succeeds = call().ok();
  failing::stop();
  REQUIRE(succeeds);
  const std::size_t count = kForever - failing::left;
  for (std::size_t n = 0; n < count; n += std::max<std::size_t>(1, count / kCalls)) {
    INFO("allocation " << n << " of " << count);
    bool isShort = false;
    start(n);
    try {
      (void)call();
    } catch (const std::bad_alloc&) {
      isShort = true;
    }
    CHECK(failing::stop() == isShort);
  }
}
template <typename Call>
void failHereAndThere(const Call& call) {
  failHereAndThere(call, failing::start);
  failHereAndThere(call, failing::startOneMalloc);
}

/// A head with its neck open and two loose eyes.
OwnedModel headWithEyes() {
  OwnedModel out;
  const TriangleMesh head = sphere({0, 0, 0}, 1, 16);
  std::vector<bool> isKept;
  for (const Triangle3& t : head.triangles) isKept.push_back(head.positions[t[0]].y > -0.8);
  out.add("skin", subset(head, isKept));
  out.add("eye_l", sphere({0.3, 0.1, 0.9}, 0.15, 8));
  out.add("eye_r", sphere({-0.3, 0.1, 0.9}, 0.15, 8));
  return out;
}

MakeOptions coarse() {
  MakeOptions options;
  options.voxels = 24;
  options.triangles = 100;
  return options;
}

}  // namespace

TEST_CASE("wherever memory runs out while a surface is searched, it says so", "[memory]") {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 6);
  const std::vector<SurfaceRay> rays = {{{0, 0, 2}, {0, 0, -1}}};
  failHereAndThere([&] {
    const Surface surface(ball);
    (void)surface.trace(rays, 0);
    return Outcome{};
  });
}

TEST_CASE("wherever memory runs out while a cage is made or refined, that is bad_alloc", "[memory]") {
  const OwnedModel model = headWithEyes();
  Cage cage;
  failHereAndThere([&] { return makeCage(model.model(), coarse(), {}, cage); });
  REQUIRE(makeCage(model.model(), coarse(), {}, cage).ok());
  for (std::size_t i = 0; i < cage.positions.size(); i += 3) cage.positions[i] += 0.03f;
  failHereAndThere([&] {
    Cage refined;
    return refineCage(cage.view(), model.model(), {}, {}, refined);
  });
}

TEST_CASE("wherever memory runs out while a cage is fitted or landmarks are found, that is bad_alloc", "[memory]") {
  const OwnedModel model = headWithEyes();
  Cage cage;
  REQUIRE(makeCage(model.model(), coarse(), {}, cage).ok());
  Template from;
  from.cage = cage.view();
  from.kind = Kind::head;
  from.landmarks = {{"nose_tip", {0, 0, 1}},
                    {"chin", {0, -0.5f, 0.85f}},
                    {"eye_centre_left", {0.3f, 0.1f, 0.9f}},
                    {"eye_centre_right", {-0.3f, 0.1f, 0.9f}},
                    {"lip_lower", {0, -0.3f, 0.95f}}};
  FitOptions options;
  options.landmarks = from.landmarks;
  failHereAndThere([&] {
    FittedCage fitted;
    return fitCage(from, model.model(), options, {}, fitted);
  });
  failHereAndThere([&] {
    FoundLandmarks found;
    return findLandmarks(model.model(), {}, found);
  });
}
