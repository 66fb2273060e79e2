// Memory that runs out while cages are made, fitted, refined or landmarks are found: an error, and no crash.

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "cagecast/cages.hpp"
#include "out_of_memory/failing.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

constexpr std::size_t kForever = std::numeric_limits<std::size_t>::max();
/// Calls that fail in each way: most of a call's thousands of allocations are made in the same loops.
constexpr std::size_t kCalls = 3;

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
    start(n);
    const Status status = call();
    CHECK(failing::stop() == (status.code == Code::outOfMemory));
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
  out.add("skin", mapped(sphere({0, 0, 0}, 1, 16, 3), [](const Vec3& p) { return Vec3{p.x, -p.y, -p.z}; }));
  for (const double side : {0.3, -0.3}) out.add("eye", sphere({side, 0.1, 0.9}, 0.15, 8));
  return out;
}

MakeOptions coarse() {
  MakeOptions options;
  options.voxels = 20;
  options.triangles = 60;
  return options;
}

}  // namespace

TEST_CASE("wherever memory runs out, a call says so", "[memory]") {
  const OwnedModel owned = headWithEyes();
  const Model model = owned.model();
  const MakeOptions making = coarse();
  Cage cage;
  failHereAndThere([&] { return makeCage(model, making, {}, cage); });
  REQUIRE(makeCage(model, making, {}, cage).ok());
  const Template from{cage.view(),
                      {{"nose_tip", {0, 0, 1}},
                       {"chin", {0, -0.5f, 0.85f}},
                       {"eye_centre_left", {0.3f, 0.1f, 0.9f}},
                       {"eye_centre_right", {-0.3f, 0.1f, 0.9f}},
                       {"lip_lower", {0, -0.3f, 0.95f}}}};
  FitOptions options;
  options.landmarks = from.landmarks;
  failHereAndThere([&] {
    FittedCage fitted;
    return fitCage(from, model, options, {}, fitted);
  });
  failHereAndThere([&] {
    FoundLandmarks found;
    return findLandmarks(model, {}, found);
  });
  Cage moved = cage;
  for (std::size_t i = 0; i < moved.positions.size(); i += 3) moved.positions[i] += 0.03f;
  failHereAndThere([&] {
    Cage refined;
    return refineCage(moved.view(), model, {}, {}, refined);
  });
}
