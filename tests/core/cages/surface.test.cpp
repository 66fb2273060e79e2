#include "mesh/surface.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/closest_point.hpp"
#include "seed.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

TriangleMesh randomMesh(std::mt19937& random, std::size_t triangles, Vec3 centre, double size) {
  std::uniform_real_distribution<double> share(-1, 1);
  TriangleMesh mesh;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const Vec3 at = centre + size * Vec3{share(random), share(random), share(random)};
    for (int i = 0; i < 3; ++i)
      mesh.positions.push_back(at + 0.2 * size * Vec3{share(random), share(random), share(random)});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

/// The distance to a triangle, by another formula than the library's: to its plane, its edges and its corners.
double distanceTo(const TriangleMesh& mesh, const Triangle3& t, const Vec3& p) {
  const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
  const Vec3 n = cross(b - a, c - a);
  double least = std::numeric_limits<double>::infinity();
  const Vec3 corners[] = {a, b, c};
  bool inside = true;
  for (int i = 0; i < 3; ++i) {
    const Vec3 from = corners[i], edge = corners[(i + 1) % 3] - from;
    const double along = std::min(1.0, std::max(0.0, dot(p - from, edge) / dot(edge, edge)));
    least = std::min(least, length(p - (from + along * edge)));
    inside = inside && dot(cross(edge, p - from), n) >= 0;
  }
  return inside ? std::abs(dot(p - a, n)) / length(n) : least;
}

}  // namespace

TEST_CASE("closest points on a surface are those of brute force", "[cages][surface]") {
  const auto seed = static_cast<std::uint32_t>(firstSeed());
  INFO("CAGECAST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-2, 2);
  const Vec3 centre{3, -20, 7};
  const TriangleMesh mesh = randomMesh(random, 200, centre, 5);
  const Surface surface(mesh);
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back(centre + 5 * Vec3{share(random), share(random), share(random)});
  const std::vector<SurfacePoint> found = surface.closest(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle3& t : mesh.triangles) least = std::min(least, distanceTo(mesh, t, points[i]));
    CHECK(found[i].distance == Approx(least).margin(1e-4));
    CHECK(length(found[i].position - points[i]) == Approx(found[i].distance).margin(1e-4));
    const Triangle3& t = mesh.triangles[found[i].triangle];
    const Vec3 blended = found[i].weights[0] * mesh.positions[t[0]] + found[i].weights[1] * mesh.positions[t[1]] +
                         found[i].weights[2] * mesh.positions[t[2]];
    CHECK(length(blended - found[i].position) < 1e-4);
  }
}

TEST_CASE("a ray meets the first triangle on its way", "[cages][surface]") {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 3}, {1, 0, 3}, {0, 1, 3}};
  mesh.triangles = {{3, 4, 5}, {0, 1, 2}};
  const Surface surface(mesh);
  const SurfaceRay rays[] = {{{0.2, 0.2, 0}, {0, 0, 1}}, {{0.2, 0.2, 2}, {0, 0, 1}}, {{0.8, 0.8, 0}, {0, 0, 1}}};
  const std::vector<RayHit> hits = surface.trace(rays);
  CHECK(hits[0].distance == Approx(1));
  CHECK(hits[0].triangle == 1);
  CHECK(hits[1].distance == Approx(1));
  CHECK(hits[1].triangle == 0);
  CHECK(std::isinf(hits[2].distance));
}

TEST_CASE("a surface that has shrunk to a point is searched, too", "[cages][surface]") {
  const Vec3 points[] = {{2, 0, 0}, {0, 0, -3}, {0, 1, 0}};
  for (const double size : {0.0, 1e-300, 1e-31, 1e-29, 1e-16}) {
    INFO("size " << size);
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Surface surface(mesh);
    const std::vector<SurfacePoint> found = surface.closest(points);
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i].triangle == 0);
      CHECK(found[i].distance == Approx(length(points[i])));
      CHECK(length(found[i].position) <= 1e-15);
      CHECK(std::isfinite(found[i].height));
      CHECK(found[i].weights[0] + found[i].weights[1] + found[i].weights[2] == Approx(1));
    }
    const SurfaceRay rays[] = {{{1, 1, 1}, {0, 0, 1}}};
    CHECK(std::isinf(surface.trace(rays)[0].distance));
  }
}

TEST_CASE("needles around a pole do not lead a search astray", "[cages][surface]") {
  // Corners at the pole that differ by rounding only.
  constexpr std::uint32_t kRings = 16, kSectors = 32;
  TriangleMesh mesh;
  for (std::uint32_t r = 0; r <= kRings; ++r)
    for (std::uint32_t s = 0; s < kSectors; ++s) {
      const double theta = M_PI * r / kRings, phi = 2 * M_PI * s / kSectors;
      mesh.positions.push_back({std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
    }
  for (std::uint32_t r = 0; r < kRings; ++r)
    for (std::uint32_t s = 0; s < kSectors; ++s) {
      const std::uint32_t a = r * kSectors + s, b = r * kSectors + (s + 1) % kSectors;
      mesh.triangles.push_back({a, b, a + kSectors});
      mesh.triangles.push_back({b, b + kSectors, a + kSectors});
    }
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i) {
    const double theta = M_PI - i * 1e-3, phi = 0.7 * i;
    points.push_back(1.03 * Vec3{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
  }
  for (const SurfacePoint& point : Surface(mesh).closest(points)) {
    CHECK(point.distance > 0.0299);
    CHECK(point.distance < 0.05);
  }
}

TEST_CASE("a point that is not finite is far from everything, and leaves others as they are", "[cages][surface]") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kFar = std::numeric_limits<double>::infinity();
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto isPoint = GENERATE(false, true);
  if (!isPoint) mesh.triangles = {{0, 1, 2}};
  if (isPoint) mesh.triangles = {{0, 0, 0}};
  const Surface surface(mesh);
  const Vec3 points[] = {{kNaN, 0, 0}, {0, 0, 1}, {0, kNaN, 0}, {0, 0, kFar}, {0, 0, 2}, {kNaN, kNaN, kNaN}};
  const std::vector<SurfacePoint> found = surface.closest(points);
  REQUIRE(found.size() == 6);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CAPTURE(isPoint, i);
    CHECK(found[i].triangle == 0);
    CHECK(isFinite(found[i].position));
    if (i == 1 || i == 4)
      CHECK(found[i].distance == Approx(points[i].z));
    else
      CHECK(found[i].distance == kFar);
  }
  const SurfaceRay rays[] = {{{kNaN, 0, 1}, {0, 0, -1}}, {{0.2, 0.2, 1}, {kNaN, 0, -1}}, {{0.2, 0.2, 1}, {0, 0, -1}}};
  const std::vector<RayHit> hits = surface.trace(rays);
  CHECK(std::isinf(hits[0].distance));
  CHECK(std::isinf(hits[1].distance));
  if (!isPoint) CHECK(hits[2].distance == Approx(1));
}
