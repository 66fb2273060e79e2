#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "cagecast/transfer.hpp"
#include "seed.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

double bump(const Vec3& direction, const Vec3& at, double height, double width) {
  const double away = std::acos(std::min(1.0, dot(direction, 1 / length(at) * at)));
  return height * std::exp(-away * away / (width * width));
}

const Vec3 kEyes[] = {unit({0.36, 0.2, 1}), unit({-0.36, 0.2, 1})};

/// A head: longer than wide, with a nose, a chin, two ears and a bump at the back.
double headRadius(const Vec3& d) {
  return 1 / std::sqrt(d.x * d.x / 0.6 + d.y * d.y / 1.1 + d.z * d.z / 0.85) + bump(d, {0, 0, 1}, 0.18, 0.16) +
         bump(d, {0, -0.7, 0.8}, 0.12, 0.25) + bump(d, {1, 0.1, -0.1}, 0.14, 0.18) +
         bump(d, {-1, 0.1, -0.1}, 0.14, 0.18) + bump(d, {0.2, 0.5, -1}, 0.1, 0.3);
}

Vec3 directionAt(double u, double v) {
  return {-std::sin(kPi * v) * std::sin(2 * kPi * u), -std::cos(kPi * v), -std::sin(kPi * v) * std::cos(2 * kPi * u)};
}

/// With an opening over each eye.
OwnedModel rolledHead(std::uint32_t columns, double offset) {
  OwnedModel out;
  out.roll(
      columns, columns / 2,
      [&](double u, double v) { return (headRadius(directionAt(u, v)) + offset) * directionAt(u, v); },
      [](double u, double v) {
        constexpr double kEyeAngle = 0.17;
        return std::max(dot(directionAt(u, v), kEyes[0]), dot(directionAt(u, v), kEyes[1])) < std::cos(kEyeAngle);
      });
  return out;
}

OwnedModel makeHead() {
  OwnedModel out = rolledHead(80, 0);
  for (const Vec3& eye : kEyes)
    out.roll(
        24, 12, [&](double u, double v) { return (headRadius(eye) - 0.2) * eye + 0.19 * directionAt(u, v); },
        [](double, double) { return true; });
  return out;
}

OwnedModel makeHeadCage(double offset = 0.04) { return rolledHead(32, offset); }

constexpr double kDiagonal = 3.2;  ///< Of the head's box, about.

OwnedModel moved(const OwnedModel& mesh, const Vec3& by) {
  return mesh.mapped([&](const Vec3& p) { return p + by; });
}

Cage refined(const OwnedModel& cage, const OwnedModel& head) {
  Cage out;
  out.kind = Kind::body;  // Of an earlier call.
  const Model model = head.model();
  const Status status = refineCage(cage.view(), model, {}, {}, out);
  INFO(describe(status, cage.view(), model, RefineOptions()));
  REQUIRE(status.ok());
  CHECK(out.kind == Kind::automatic);
  CHECK((out.uvs == cage.uvs));
  CHECK((out.indices == cage.indices));
  return out;
}

/// Root of the mean square of the distances between vertices, as a share of the diagonal.
double difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    squares += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return std::sqrt(squares / static_cast<double>(a.size() / 3)) / kDiagonal;
}

/// Share of the vertices that are inside the head.
double insideOf(const std::vector<float>& positions) {
  double inside = 0;
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    const Vec3 p = Vec3::from(&positions[i]);
    if (length(p) < headRadius(unit(p))) inside += 3;
  }
  return inside / static_cast<double>(positions.size());
}

/// Shares of vertices that get what they should: eyes no paint, skin paint.
struct Score {
  double suppressed = 0, kept = 0;
};

Score scoreOf(const std::vector<float>& cagePositions, const OwnedModel& cage, const OwnedModel& head) {
  Workspace workspace;
  TransferResult result;
  REQUIRE(transfer({cagePositions, cage.indices, cage.uvs}, head.view(), {}, workspace, result).ok());
  double eyes = 0, suppressed = 0, skin = 0, kept = 0;
  for (std::size_t v = 0; v < head.groups.size(); ++v) {
    const bool painted = result.zones.zones[v] == Zone::cosmetic;
    const bool isEye = head.groups[v] > 0;
    (isEye ? eyes : skin) += 1;
    if (isEye != painted) (isEye ? suppressed : kept) += 1;
  }
  return {suppressed / eyes, kept / skin};
}

}  // namespace

TEST_CASE("a cage in place stays as it is, also with more room in some places than in others", "[cages][refine]") {
  const OwnedModel head = makeHead();
  const OwnedModel wavy =
      makeHeadCage(0.08).mapped([](const Vec3& p) { return p + 0.02 * std::cos(4 * std::atan2(p.x, p.z)) * unit(p); });
  for (const OwnedModel& cage : {makeHeadCage(0.01), makeHeadCage(0.03), makeHeadCage(0.06), wavy})
    CHECK((refined(cage, head).positions == cage.positions));
}

TEST_CASE("a cage that was moved or scaled comes back into place", "[cages][refine]") {
  const OwnedModel head = makeHead(), cage = makeHeadCage();
  const Score inPlace = scoreOf(cage.positions, cage, head);
  REQUIRE(inPlace.suppressed > 0.99);
  REQUIRE(inPlace.kept > 0.97);
  const auto check = [&](const OwnedModel& displaced, double tolerance) {
    const Cage back = refined(displaced, head);
    const Score score = scoreOf(back.positions, cage, head);
    CHECK(score.suppressed > inPlace.suppressed - 0.005);
    CHECK(score.kept > inPlace.kept - 0.005);
    CHECK(difference(back.positions, cage.positions) < tolerance);
  };
  for (const Vec3& by : {Vec3{0.01, 0, 0}, {-0.03, 0, 0}, {0, 0.03, 0}, {0, -0.02, 0}, {0, 0, 0.02}, {0, 0, -0.03}}) {
    CAPTURE(by.x, by.y, by.z);
    check(moved(cage, kDiagonal * by), 0.003);
  }
  // A smaller cage is nearer everywhere, which need not be wrong.
  for (const double size : {0.97, 0.99, 1.01, 1.03}) {
    CAPTURE(size);
    check(cage.mapped([&](const Vec3& p) { return size * p; }), 0.02);
  }
  OwnedModel rough = head;
  rough.addFins();
  CHECK(difference(refined(moved(cage, {0.02 * kDiagonal, 0, 0}), rough).positions, cage.positions) < 0.003);
}

TEST_CASE("a cage that was moved and turned at random comes closer", "[cages][refine]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  const OwnedModel head = makeHead(), cage = makeHeadCage();
  for (int round = 0; round < 10; ++round) {
    const Vec3 by = 0.02 * kDiagonal * Vec3{share(random), share(random), share(random)};
    const Vec3 turn = 0.06 * Vec3{share(random), share(random), share(random)};
    const OwnedModel displaced = cage.mapped([&](const Vec3& p) { return p + by + cross(turn, p); });
    CAPTURE(by.x, by.y, by.z, turn.x, turn.y, turn.z);
    const Cage back = refined(displaced, head);
    const bool stays = back.positions == displaced.positions;
    CHECK(difference(back.positions, cage.positions) < (stays ? 0.008 : 0.006));
  }
}

TEST_CASE("a cage that was bent is bent back", "[cages][refine]") {
  const OwnedModel head = makeHead(), cage = makeHeadCage();
  const OwnedModel bent = cage.mapped([](const Vec3& p) {
    return p + 0.025 * kDiagonal * std::cos(2.5 * p.y) * Vec3{1, 0, 0};
  });
  const Cage back = refined(bent, head);
  // It may slide along the head, but not lie inside.
  CHECK(difference(back.positions, cage.positions) < difference(bent.positions, cage.positions));
  CHECK(insideOf(bent.positions) > 0.05);
  CHECK(insideOf(back.positions) == 0);
  // Both sides of the seam moved the same way.
  for (std::size_t row = 0; row <= 16; ++row)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(back.positions[3 * 33 * row + k] == back.positions[3 * (33 * row + 32) + k]);
}

TEST_CASE("what a refined cage cannot be made of is said", "[cages][refine]") {
  const OwnedModel head = makeHead(), cage = makeHeadCage();
  const auto scaled = [&](const std::function<double(const Vec3&)>& by) {
    return cage.mapped([&](const Vec3& p) { return by(p) * p; });
  };
  OwnedModel broken = cage, inside = cage;
  broken.positions[7] = NAN;
  for (std::size_t t = 0; t < inside.indices.size(); t += 3) std::swap(inside.indices[t], inside.indices[t + 1]);
  const struct {
    OwnedModel cage, model;
    Code code;
    std::string says;
  } faults[] = {
      {broken, head, Code::nonFinitePosition, "cage.positions[7] = NaN is not a finite number"},
      {{}, head, Code::emptyMesh, "cage has no vertices; at least one is needed"},
      {cage, {}, Code::emptyMesh, "model has no vertices; at least one is needed"},
      {moved(cage, {10, 0, 0}), head, Code::cageApart,
       "cage is not around the model: the distance between them is 237.8 % of the model's diagonal, more than "
       "options.reach, 5.0 %"},
      {scaled([](const Vec3&) { return 100; }), head, Code::cageTooLarge,
       "cage is 102 times as large as the model; give both in the same unit"},
      {scaled([](const Vec3&) { return 1e-6; }), head, Code::vanishingCage,
       "cage has no triangle that is large enough beside the model"},
      {inside, head, Code::cageFacesAway,
       "cage does not belong to the model: only 0.0 % of it faces the same way as the model beneath it"},
      {scaled([](const Vec3& p) { return 1.35 + 0.3 * std::sin(8 * p.x); }), head, Code::cageUneven,
       "cage does not belong to the model: its distances from it differ by "},
      {scaled([](const Vec3& p) { return 1 + 0.2 * std::sin(25 * p.x) * std::sin(25 * p.y); }), head, Code::cageInside,
       "cage cannot be brought into place: "},
      {scaled([](const Vec3&) { return 0.6; }), head, Code::cageOff, "cage is off by "},
  };
  for (const auto& fault : faults) {
    Cage none;
    const Model model = fault.model.model();
    const Status status = refineCage(fault.cage.view(), model, {}, {}, none);
    CAPTURE(fault.says, describe(status, fault.cage.view(), model, RefineOptions()));
    CHECK(status.code == fault.code);
    CHECK(status.argument == (fault.model.positions.empty() ? Argument::model : Argument::cage));
    CHECK(describe(status, fault.cage.view(), model, RefineOptions()).starts_with(fault.says));
  }
  for (const float reach : {0.0f, -1.0f, NAN, 0.5f}) {
    Cage none;
    const Status status = refineCage(cage.view(), head.model(), {reach}, {}, none);
    CHECK(status.code == Code::badOption);
    CHECK(describe(status, cage.view(), head.model(), {reach}).starts_with("options.reach = "));
  }
}

TEST_CASE("a refinement reports its progress and can be cancelled", "[cages][refine]") {
  const OwnedModel head = makeHead(), cage = moved(makeHeadCage(), {0.05, 0, 0});
  Cage out;
  checkProgress([&](const Progress& progress) { return refineCage(cage.view(), head.model(), {}, progress, out).ok(); },
                {-1, 0.03f, 0.06f, 0.2f, 2});
}
