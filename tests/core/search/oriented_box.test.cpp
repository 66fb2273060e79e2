// The oriented box around the triangles of a leaf.

#include "search/oriented_box.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "checks.hpp"

using namespace cagecast;

namespace {

constexpr float kCageCentre[4] = {};

Triangle triangleOfCorners(Vec3 a, Vec3 b, Vec3 c) {
  Triangle t{};
  const auto put = [](float(&to)[4], Vec3 p) {
    to[0] = static_cast<float>(p.x);
    to[1] = static_cast<float>(p.y);
    to[2] = static_cast<float>(p.z);
  };
  put(t.a, a);
  put(t.b, b);
  put(t.c, c);
  const Vec3 normal = areaNormal(t.a, t.b, t.c);
  t.normal = RayDirection::along(1 / length(normal) * normal);
  return t;
}

/// The box around a rectangle of four triangles with its middle at 0.
/// @param x,y  Half its sides.
OrientedBox boxOfRectangle(Vec3 x, Vec3 y) {
  const Vec3 corners[4] = {-1 * x - y, x - y, x + y, -1 * x + y};
  Triangle triangles[4];
  for (std::size_t i = 0; i < 4; ++i) triangles[i] = triangleOfCorners({0, 0, 0}, corners[i], corners[(i + 1) % 4]);
  return orientedBoxAround({&triangles[0], &triangles[1], &triangles[2], &triangles[3]}, kCageCentre, 0);
}

/// How far a point is from a box.
double distanceToBox(const OrientedBox& box, Vec3 p) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double at = p.x * static_cast<double>(box.axes[0][k]) + p.y * static_cast<double>(box.axes[1][k]) +
                      p.z * static_cast<double>(box.axes[2][k]);
    const double outside = std::max({static_cast<double>(box.low[k]) - at, at - static_cast<double>(box.high[k]), 0.0});
    squared += outside * outside;
  }
  return std::sqrt(squared);
}

double sizeAlong(const OrientedBox& box, int k) {
  return static_cast<double>(box.high[k]) - static_cast<double>(box.low[k]);
}

Vec3 pointInUnitCube(scenes::Random& random) {
  const auto one = [&] { return static_cast<double>(random.between(-1, 1)); };
  return {one(), one(), one()};
}

}  // namespace

TEST_CASE("the box around a flat rectangle is flat, and turned to within an eighth of a right angle", "[box]") {
  constexpr double kPi = 3.14159265358979;
  for (int i = 0; i < 64; ++i) {
    const double turn = i * kPi / 64;
    const double u = std::cos(turn), v = std::sin(turn);
    const Vec3 tilts[][2] = {{{1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, 0, 1}}, {{0.6, 0, 0.8}, {0, 1, 0}}};
    for (const auto& [along, across] : tilts) {
      const OrientedBox box = boxOfRectangle(4 * (u * along + v * across), 0.5 * (u * across - v * along));
      const double off = kPi / 16;  // As far as a side may be from an axis of the box.
      const double most = 8 * 1 + (8 * 8 + 1 * 1) * std::cos(off) * std::sin(off);
      INFO("turned by " << i << " / 64 of a half turn");
      for (int k = 0; k < 3; ++k) {
        const double axis[3] = {static_cast<double>(box.axes[0][k]), static_cast<double>(box.axes[1][k]),
                                static_cast<double>(box.axes[2][k])};
        CHECK(length(Vec3{axis[0], axis[1], axis[2]}) == Approx(1));
      }
      CHECK(sizeAlong(box, 2) < 1e-5);
      CHECK(sizeAlong(box, 0) * sizeAlong(box, 1) < 1.001 * most);
    }
  }
}

TEST_CASE("a box is never farther from a point than its triangles, whatever their shape and size", "[box]") {
  const std::uint64_t seed = firstSeed();
  for (std::uint64_t round = 0; round < 2000; ++round) {
    scenes::Random random(seed + round);
    INFO("seed " << seed + round);
    const double sizes[] = {1, 1e-3, 1e-22};
    const double size = sizes[random.below(3)];
    const double flat = random.below(2) == 0 ? 1 : 1e-3;  // Along a line, or not.
    const Vec3 line = pointInUnitCube(random);
    std::vector<Triangle> triangles;
    std::vector<Vec3> corners;
    while (triangles.size() < 4) {
      Vec3 points[3];
      for (Vec3& p : points)
        p = size * (static_cast<double>(random.between(-1, 1)) * line + flat * pointInUnitCube(random));
      triangles.push_back(triangleOfCorners(points[0], points[1], points[2]));
      for (const float* p : {triangles.back().a, triangles.back().b, triangles.back().c})
        corners.push_back(Vec3::from(p));
    }
    const OrientedBox box =
        orientedBoxAround({&triangles[0], &triangles[1], &triangles[2], &triangles[3]}, kCageCentre, 0);
    for (const Vec3& corner : corners) {
      CHECK(distanceToBox(box, corner) < 1e-5 * size);
      const Vec3 p = corner + size * pointInUnitCube(random);
      CHECK(distanceToBox(box, p) < (1 + 1e-5) * length(p - corner) + 1e-5 * size);
    }
  }
}
