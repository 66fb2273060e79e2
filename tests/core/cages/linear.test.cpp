#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include "fit/warp.hpp"
#include "linear/dense.hpp"
#include "linear/sparse_system.hpp"
#include "seed.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

struct Random {
  std::mt19937 engine{static_cast<std::uint32_t>(firstSeed())};
  double operator()() { return std::uniform_real_distribution<double>(-1, 1)(engine); }
  Vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
};

}  // namespace

TEST_CASE("eigenvectors are only stretched, and square to each other", "[cages][linear]") {
  INFO("CAGECAST_SEED=" << firstSeed());
  Random random;
  for (int round = 0; round < 50; ++round) {
    SquareMatrix<4> matrix{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k <= i; ++k) matrix[i][k] = matrix[k][i] = round < 5 ? double(i == k) : random();
    const auto pairs = eigenpairsOf(matrix);
    for (std::size_t a = 0; a < 4; ++a) {
      if (a > 0) CHECK(pairs[a].value >= pairs[a - 1].value);
      for (std::size_t i = 0; i < 4; ++i) {
        double image = 0;
        for (std::size_t k = 0; k < 4; ++k) image += matrix[i][k] * pairs[a].vector[k];
        CHECK(image == Approx(pairs[a].value * pairs[a].vector[i]).margin(1e-12));
      }
      for (std::size_t b = 0; b < 4; ++b) {
        double product = 0;
        for (std::size_t k = 0; k < 4; ++k) product += pairs[a].vector[k] * pairs[b].vector[k];
        CHECK(product == Approx(a == b ? 1 : 0).margin(1e-12));
      }
    }
  }
}

TEST_CASE("systems of equations are solved, dense and sparse", "[cages][linear]") {
  INFO("CAGECAST_SEED=" << firstSeed());
  Random random;
  constexpr std::uint32_t kSize = 12;
  // A' A + I, with a row and a column of zeros in the dense one.
  std::vector<SparseEntry> factor;
  for (std::uint32_t i = 0; i < kSize; ++i)
    for (const std::uint32_t k : {i, (i * 5 + 3) % kSize, i}) factor.push_back({i, k, random()});
  const std::vector<SparseEntry> entries = squared(collapsed(factor), std::vector<double>(kSize, 1));
  SparseSystem system(kSize, entries);
  std::vector<double> dense((kSize + 1) * (kSize + 1)), right, rightDense;
  const auto add = [&](std::uint32_t row, std::uint32_t column, double value) {
    system.add(row, column, value);
    dense[(kSize + 1) * row + column] += value;
  };
  for (const SparseEntry& entry : entries) add(entry.row, entry.column, entry.value);
  for (std::uint32_t i = 0; i < kSize; ++i) add(i, i, 1);
  for (std::uint32_t i = 0; i < kSize; ++i) right.push_back(random());
  rightDense = right;
  rightDense.push_back(0);
  REQUIRE(system.factorize());
  const std::vector<double> x = system.solve(right), y = solveDense(dense, rightDense, kSize + 1);
  for (std::uint32_t i = 0; i < kSize; ++i) {
    double sum = 0;
    for (std::uint32_t k = 0; k < kSize; ++k) sum += dense[(kSize + 1) * i + k] * x[k];
    CHECK(sum == Approx(right[i]).margin(1e-10));
    CHECK(y[i] == Approx(x[i]).margin(1e-10));
  }
  CHECK(y[kSize] == 0);
  system.clear();
  for (std::uint32_t i = 0; i < kSize; ++i) system.add(i, i, i == 3 ? 0 : 1);
  CHECK_FALSE(system.factorize());
}

TEST_CASE("a factorisation reports its progress by work, and can be cancelled", "[cages][linear]") {
  // The Laplacian of a square, plus 1.
  constexpr std::uint32_t kSide = 200, kSize = kSide * kSide;
  std::vector<SparseEntry> entries;
  for (std::uint32_t i = 0; i < kSize; ++i) {
    entries.push_back({i, i, 5});
    if (i % kSide > 0) entries.push_back({i, i - 1, -1});
    if (i >= kSide) entries.push_back({i, i - kSide, -1});
  }
  SparseSystem system(kSize, entries);
  for (const SparseEntry& entry : entries) system.add(entry.row, entry.column, entry.value);
  std::vector<double> shares;
  REQUIRE(system.factorize([&](double share) {
    shares.push_back(share);
    return true;
  }));
  REQUIRE(shares.size() > 3);
  CHECK(shares.front() == 0);
  for (std::size_t i = 1; i < shares.size(); ++i) {
    CHECK(shares[i] > shares[i - 1]);
    // As much work between any two, but for the last row.
    CHECK(shares[i] - shares[i - 1] < 1.1 * shares[1]);
  }
  CHECK(shares.back() <= 1);
  CHECK(shares.back() > 1 - 1.1 * shares[1]);
  const std::vector<double> right(kSize, 1.0);
  const std::vector<double> whole = system.solve(right);
  for (const std::size_t last : {std::size_t{1}, std::size_t{3}}) {
    std::size_t calls = 0;
    CHECK_FALSE(system.factorize([&](double) { return ++calls < last; }));
    CHECK(calls == last);
  }
  REQUIRE(system.factorize());
  CHECK(system.solve(right) == whole);
}

TEST_CASE("a similarity is found again from points, and a rotation from two directions", "[cages][linear]") {
  INFO("CAGECAST_SEED=" << firstSeed());
  Random random;
  for (int round = 0; round < 20; ++round) {
    const Vec3 from = 1 / 1.7 * Vec3{1, 1, std::sqrt(0.89)};  // Of unit length.
    Vec3 to = random.vector();
    to = round == 0 ? -1.0 * from : 1 / length(to) * to;
    Similarity map = shortestRotation(from, to);
    CHECK(length(map.turned(from) - to) < 1e-9);
    CHECK(dot(cross(map.x, map.y), map.z) == Approx(1));
    map.scale = 0.3 + round;
    for (Vec3* axis : {&map.x, &map.y, &map.z}) *axis = map.scale * *axis;
    map.translation = random.vector();
    std::vector<Vec3> points, images, mirrored;
    for (int i = 0; i < 5; ++i) {
      points.push_back(random.vector());
      images.push_back(map(points.back()));
      mirrored.push_back({-images.back().x, images.back().y, images.back().z});
    }
    const Similarity found = fitSimilarity(points, images);
    CHECK(found.scale == Approx(map.scale));
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(length(found(points[i]) - images[i]) < 1e-9 * map.scale);
      CHECK(length(found.inverse(images[i]) - points[i]) < 1e-9);
    }
    const Similarity turned = fitSimilarity(points, mirrored);
    CHECK(dot(cross(turned.x, turned.y), turned.z) > 0);
  }
}

TEST_CASE("a warp carries its anchors where they belong, and is smooth between", "[cages][linear]") {
  INFO("CAGECAST_SEED=" << firstSeed());
  Random random;
  std::vector<Anchor> anchors;
  for (int i = 0; i < 12; ++i) {
    const Vec3 p = random.vector();
    anchors.push_back({p, p + 0.1 * random.vector()});
  }
  const Warp warp(anchors, 2);
  for (const Anchor& anchor : anchors) CHECK(length(warp(anchor.from) - anchor.to) < 1e-9);
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = random.vector(), step = 1e-3 * random.vector();
    CHECK(length(warp(p + step) - warp(p)) < 3e-3);
  }
  anchors[0].slack = 1;
  CHECK(length(Warp(anchors, 2)(anchors[0].from) - anchors[0].to) > 1e-3);
}
