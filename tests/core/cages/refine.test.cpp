#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "cagecast/transfer.hpp"
#include "geometry/vec3.hpp"
#include "seed.hpp"
#include "shapes.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

struct Mesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups}; }
};

double bump(const Vec3& direction, const Vec3& at, double height, double width) {
  const double away = std::acos(std::min(1.0, dot(direction, 1 / length(at) * at)));
  return height * std::exp(-away * away / (width * width));
}

const Vec3 kEyes[] = {{0.36, 0.2, 1}, {-0.36, 0.2, 1}};
constexpr double kEyeAngle = 0.17;

double angleToEye(const Vec3& direction) {
  double least = kPi;
  for (const Vec3& eye : kEyes) least = std::min(least, std::acos(dot(direction, 1 / length(eye) * eye)));
  return least;
}

/// A head: longer than wide, with a nose, a chin, two ears and a bump at the back.
double headRadius(const Vec3& d) {
  return 1 / std::sqrt(d.x * d.x / 0.6 + d.y * d.y / 1.1 + d.z * d.z / 0.85) + bump(d, {0, 0, 1}, 0.18, 0.16) +
         bump(d, {0, -0.7, 0.8}, 0.12, 0.25) + bump(d, {1, 0.1, -0.1}, 0.14, 0.18) +
         bump(d, {-1, 0.1, -0.1}, 0.14, 0.18) + bump(d, {0.2, 0.5, -1}, 0.1, 0.3);
}

template <typename Radius, typename Keep>
void addBall(Mesh& mesh, std::uint32_t columns, Vec3 centre, Radius radius, Keep keep) {
  const std::uint32_t rows = columns / 2, first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  const std::uint32_t group = mesh.groups.empty() ? 0 : mesh.groups.back() + 1;
  std::vector<Vec3> directions;
  for (std::uint32_t r = 0; r <= rows; ++r) {
    for (std::uint32_t c = 0; c <= columns; ++c) {
      const double u = static_cast<double>(c) / columns, v = static_cast<double>(r) / rows;
      const double around = c == columns ? 0 : 2 * kPi * u;  // Both sides of the seam are in the same place.
      const Vec3 d{std::sin(kPi * v) * std::sin(around), -std::cos(kPi * v), -std::sin(kPi * v) * std::cos(around)};
      directions.push_back(d);
      const Vec3 p = centre + radius(d) * d;
      for (const double x : {p.x, p.y, p.z}) mesh.positions.push_back(static_cast<float>(x));
      for (const double x : {u, v}) mesh.uvs.push_back(static_cast<float>(x));
      mesh.groups.push_back(group);
    }
  }
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1, e = d + 1;
      for (const auto& t : {std::array{a, e, b}, std::array{a, d, e}}) {
        const Vec3 middle = directions[t[0]] + directions[t[1]] + directions[t[2]];
        if (keep(1 / length(middle) * middle))
          for (const std::uint32_t corner : t) mesh.indices.push_back(first + corner);
      }
    }
  }
}

/// A skin with two openings, and an eye behind each.
Mesh makeHead() {
  Mesh mesh;
  addBall(mesh, 96, {0, 0, 0}, headRadius, [](const Vec3& d) { return angleToEye(d) > kEyeAngle; });
  for (const Vec3& eye : kEyes) {
    const Vec3 d = 1 / length(eye) * eye;
    addBall(
        mesh, 24, (headRadius(d) - 0.2) * d, [](const Vec3&) { return 0.19; }, [](const Vec3&) { return true; });
  }
  return mesh;
}

Mesh makeHeadCage(double offset = 0.04) {
  Mesh mesh;
  addBall(
      mesh, 40, {0, 0, 0}, [&](const Vec3& d) { return headRadius(d) + offset; },
      [](const Vec3& d) { return angleToEye(d) > kEyeAngle; });
  mesh.groups.clear();
  return mesh;
}

constexpr double kDiagonal = 3.2;  ///< Of the head's box, about.

template <typename Map>
Mesh mapped(Mesh mesh, Map map) {
  for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
    const Vec3 p = map(Vec3::from(&mesh.positions[i]));
    mesh.positions[i] = static_cast<float>(p.x);
    mesh.positions[i + 1] = static_cast<float>(p.y);
    mesh.positions[i + 2] = static_cast<float>(p.z);
  }
  return mesh;
}

Mesh moved(const Mesh& mesh, const Vec3& by) {
  return mapped(mesh, [&](const Vec3& p) { return p + by; });
}

Outcome refine(const Mesh& cage, const Mesh& model, Cage& out) {
  Model target;
  target.mesh = model.view();
  Outcome outcome = refineCage(cage.view(), target, {}, {}, out);
  UNSCOPED_INFO("refineCage says: " << outcome.message);
  return outcome;
}

/// Root of the mean square of the distances between vertices, as a share of the diagonal.
double difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    squares += d * d;
  }
  return std::sqrt(squares / static_cast<double>(a.size() / 3)) / kDiagonal;
}

/// Share of the vertices that are inside the head.
double insideOf(const std::vector<float>& positions) {
  double inside = 0;
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    const Vec3 p = Vec3::from(&positions[i]);
    if (length(p) < headRadius(1 / length(p) * p)) inside += 3;
  }
  return inside / static_cast<double>(positions.size());
}

/// Shares of vertices that get what they should: eyes no paint, skin paint.
struct Score {
  double suppressed = 0, kept = 0;
};

Score scoreOf(const std::vector<float>& cagePositions, const Mesh& cage, const Mesh& head) {
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

TEST_CASE("a cage in place stays as it is", "[cages][refine]") {
  const Mesh head = makeHead();
  for (const double offset : {0.01, 0.03, 0.06}) {
    CAPTURE(offset);
    const Mesh cage = makeHeadCage(offset);
    Cage refined;
    refined.kind = Kind::body;  // Of an earlier call.
    REQUIRE(refine(cage, head, refined).ok());
    CHECK(refined.kind == Kind::automatic);
    CHECK((refined.positions == cage.positions));
    CHECK((refined.uvs == cage.uvs));
    CHECK((refined.indices == cage.indices));
  }
}

TEST_CASE("a cage with more room in some places than in others stays as it is", "[cages][refine]") {
  const Mesh head = makeHead();
  const Mesh cage = mapped(makeHeadCage(0.08), [](const Vec3& p) {
    const double away = 0.02 * std::cos(4 * std::atan2(p.x, p.z));
    return p + away / length(p) * p;
  });
  Cage refined;
  REQUIRE(refine(cage, head, refined).ok());
  CHECK((refined.positions == cage.positions));
}

TEST_CASE("a cage that was moved or scaled comes back into place", "[cages][refine]") {
  const Mesh head = makeHead();
  const Mesh cage = makeHeadCage();
  const Score inPlace = scoreOf(cage.positions, cage, head);
  REQUIRE(inPlace.suppressed > 0.99);
  REQUIRE(inPlace.kept > 0.97);
  const auto check = [&](const Mesh& displaced, double tolerance) {
    Cage refined;
    REQUIRE(refine(displaced, head, refined).ok());
    const Score score = scoreOf(refined.positions, cage, head);
    CHECK(score.suppressed > inPlace.suppressed - 0.005);
    CHECK(score.kept > inPlace.kept - 0.005);
    CHECK(difference(refined.positions, cage.positions) < tolerance);
    CHECK((refined.uvs == cage.uvs));
    CHECK((refined.indices == cage.indices));
  };
  for (const double share : {0.01, 0.02, 0.03}) {
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      for (const double side : {1, -1}) {
        const Vec3 by = side * share * kDiagonal * axis;
        CAPTURE(by.x, by.y, by.z);
        check(moved(cage, by), 0.003);
      }
    }
  }
  // A smaller cage is nearer everywhere, which need not be wrong.
  for (const double size : {0.97, 0.98, 0.99, 1.01, 1.02, 1.03}) {
    CAPTURE(size);
    check(mapped(cage, [&](const Vec3& p) { return size * p; }), 0.02);
  }
}

TEST_CASE("a cage that was moved and turned at random comes closer", "[cages][refine]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  const Mesh head = makeHead();
  const Mesh cage = makeHeadCage();
  for (int round = 0; round < 20; ++round) {
    const Vec3 by = 0.02 * kDiagonal * Vec3{share(random), share(random), share(random)};
    const Vec3 turn = 0.06 * Vec3{share(random), share(random), share(random)};
    const Mesh displaced = mapped(cage, [&](const Vec3& p) { return p + by + cross(turn, p); });
    CAPTURE(by.x, by.y, by.z, turn.x, turn.y, turn.z);
    Cage refined;
    REQUIRE(refine(displaced, head, refined).ok());
    const double before = difference(displaced.positions, cage.positions);
    const double after = difference(refined.positions, cage.positions);
    if (refined.positions == displaced.positions)
      CHECK(before < 0.008);
    else
      CHECK(after < 0.006);
  }
}

TEST_CASE("a cage that was bent is bent back", "[cages][refine]") {
  const Mesh head = makeHead();
  const Mesh cage = makeHeadCage();
  const Mesh bent = mapped(cage, [](const Vec3& p) {
    return p + 0.025 * kDiagonal * std::cos(2.5 * p.y) * Vec3{1, 0, 0};
  });
  Cage refined;
  REQUIRE(refine(bent, head, refined).ok());
  // It may slide along the head, but not lie inside.
  CHECK(difference(refined.positions, cage.positions) < difference(bent.positions, cage.positions));
  CHECK(insideOf(bent.positions) > 0.05);
  CHECK(insideOf(refined.positions) == 0);
  // Both sides of the seam moved the same way.
  for (std::size_t row = 0; row <= 20; ++row)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(refined.positions[3 * 41 * row + k] == refined.positions[3 * (41 * row + 40) + k]);
}

TEST_CASE("a cage is brought onto a model that is not manifold, too", "[cages][refine]") {
  Mesh head = makeHead();
  addFins(head.positions, head.indices);
  head.uvs.clear();
  head.groups.resize(head.positions.size() / 3, 0);
  const Mesh cage = makeHeadCage();
  Cage refined;
  REQUIRE(refine(moved(cage, {0.02 * kDiagonal, 0, 0}), head, refined).ok());
  CHECK(difference(refined.positions, cage.positions) < 0.003);
}

TEST_CASE("what a refined cage cannot be made of is said", "[cages][refine]") {
  const Mesh head = makeHead();
  const Mesh cage = makeHeadCage();
  Cage refined;
  const auto messageOf = [&](const Mesh& given, const Mesh& model, Problem problem) {
    const Outcome outcome = refine(given, model, refined);
    CHECK(outcome.problem == problem);
    return outcome.message;
  };
  Mesh broken = cage;
  broken.positions[7] = NAN;
  CHECK(messageOf(broken, head, Problem::badTemplate) == "cage.positions[7] is not a finite number");
  CHECK(messageOf(Mesh{}, head, Problem::badTemplate) == "cage has no vertices");
  broken = cage;
  broken.indices.clear();
  CHECK(messageOf(broken, head, Problem::badTemplate) == "cage has no triangles");
  CHECK(messageOf(cage, Mesh{}, Problem::badModel) == "model has no vertices");
  CHECK(messageOf(moved(cage, {10, 0, 0}), head, Problem::badTemplate)
            .starts_with("cage is not around the model: the distance between them is "));
  CHECK(messageOf(mapped(cage, [](const Vec3& p) { return 100 * p; }), head, Problem::badTemplate)
            .ends_with(" times as large as the model; give both in the same unit"));
  broken = cage;
  for (std::size_t t = 0; t < broken.indices.size(); t += 3) std::swap(broken.indices[t], broken.indices[t + 1]);
  CHECK(messageOf(broken, head, Problem::badTemplate)
            .starts_with("cage does not belong to the model: only 0.0 % of it faces the same way"));
  CHECK(messageOf(mapped(cage, [](const Vec3& p) { return (1.35 + 0.3 * std::sin(8 * p.x)) * p; }), head,
                  Problem::badTemplate)
            .starts_with("cage does not belong to the model: its distances from it differ by "));
  const Mesh wavy = mapped(cage, [](const Vec3& p) { return (1 + 0.2 * std::sin(25 * p.x) * std::sin(25 * p.y)) * p; });
  CHECK(messageOf(wavy, head, Problem::badTemplate).ends_with(" of it would still be inside the model"));
  CHECK(messageOf(mapped(cage, [](const Vec3& p) { return 0.6 * p; }), head, Problem::badTemplate)
            .starts_with("cage is off by "));
  CHECK(messageOf(mapped(cage, [](const Vec3& p) { return 1e-6 * p; }), head, Problem::badTemplate) ==
        "cage has no triangle that is large enough beside the model");
  Model model;
  model.mesh = head.view();
  for (const float reach : {0.0f, -1.0f, NAN, 0.5f}) {
    const Outcome outcome = refineCage(cage.view(), model, {reach}, {}, refined);
    CHECK(outcome.problem == Problem::badOptions);
    CHECK(outcome.message.starts_with("options.reach = "));
  }
}

TEST_CASE("a refinement reports its progress and can be cancelled", "[cages][refine]") {
  const Mesh head = makeHead();
  const Mesh cage = moved(makeHeadCage(), {0.05, 0, 0});
  Model model;
  model.mesh = head.view();
  Cage refined;
  std::vector<float> shares;
  const auto note = [&](float share, const char*) {
    shares.push_back(share);
    return true;
  };
  REQUIRE(refineCage(cage.view(), model, {}, note, refined).ok());
  CHECK(shares.size() > 10);
  CHECK(shares.front() == 0);
  CHECK(shares.back() == 1);
  CHECK(std::is_sorted(shares.begin(), shares.end()));
  for (std::size_t last : {std::size_t{0}, shares.size() / 2, shares.size() - 1}) {
    const Outcome outcome = refineCage(
        cage.view(), model, {}, [&](float, const char*) { return last-- > 0; }, refined);
    CHECK(outcome.problem == Problem::cancelled);
  }
}
