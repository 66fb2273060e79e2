// Rays and triangles: single precision finds what double precision decides, for triangles of any shape and size.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "checks.hpp"
#include "search/box.hpp"
#include "search/ray_search.hpp"

using namespace cagecast;

namespace {

/// Triangles in a tree of one or two leaves, four in each.
struct SmallTree {
  std::vector<float> positions;  ///< 4 per corner.
  std::vector<std::uint32_t> corners;
  Node node{};
  RayTree tree;

  /// @param points  The corners of the triangles.
  SmallTree(const std::vector<Vec3>& points, float sceneSize) {
    REQUIRE((points.size() == 12 || points.size() == 24));
    Box boxes[4] = {{}, {}, Box::farAway(), Box::farAway()};
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      corners.push_back(i);
      const float at[4] = {static_cast<float>(points[i].x), static_cast<float>(points[i].y),
                           static_cast<float>(points[i].z), 0};
      positions.insert(positions.end(), at, at + 4);
      boxes[i / 12].grow(simd::load(positions.data() + std::size_t{4} * i));
    }
    for (std::size_t leaf = 0; leaf < 2; ++leaf) {
      const bool isUsed = 12 * leaf < points.size();
      boxes[leaf] = isUsed ? boxes[leaf].padded(Box::kPadding * sceneSize) : Box::farAway();
    }
    setBoxes(node, boxes);
    std::fill(node.child, node.child + 4, leafOf(0));
    node.child[1] = leafOf(4);
    tree = {&node, positions.data(), corners.data(), sceneSize};
  }
  [[nodiscard]] Vec3 corner(std::uint32_t i) const { return Vec3::from(positions.data() + std::size_t{4} * i); }
  /// Where a ray hits a triangle in double precision.
  [[nodiscard]] double distance(std::uint32_t triangle, const Ray& ray) const {
    return hitDistance(RayLeaf(tree, leafOf(triangle / 4 * 4), 0, 0), static_cast<int>(triangle % 4), ray);
  }
};

double numberIn(scenes::Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random.between(0, 1));
}

Vec3 pointInCube(scenes::Random& random, double size) {
  return {numberIn(random, -size, size), numberIn(random, -size, size), numberIn(random, -size, size)};
}

/// Rays, and what they need to live.
struct Rays {
  std::vector<RayDirection> directions;
  std::vector<Ray> rays;

  explicit Rays(std::size_t count) { directions.reserve(count); }
  void add(Vec3 from, Vec3 towards) {
    const Vec3 way = towards - from;
    directions.push_back(RayDirection::along(1 / length(way) * way));
    Ray ray{};
    const double origin[3] = {from.x, from.y, from.z};
    for (int k = 0; k < 3; ++k) {
      ray.position[k] = static_cast<float>(origin[k]);
      ray.positionLow[k] = static_cast<float>(origin[k] - static_cast<double>(ray.position[k]));
    }
    ray.direction = &directions.back();
    rays.push_back(ray);
  }
};

/// Whether each ray is hit, and where first.
struct Hits {
  bool hit[RaySearch::kMaxRays];
  std::vector<Ray> rays;

  Hits(const SmallTree& tree, const Rays& of, double from, RaySearch::Find find) : rays(of.rays) {
    Arena arena;
    RaySearch search(tree.tree, from, arena);
    search.search(rays.data(), static_cast<std::uint32_t>(rays.size()), hit, find);
  }
};

}  // namespace

TEST_CASE("rays meet what double precision says, along edges and at corners of triangles of any size", "[rays]") {
  std::size_t hits = 0, misses = 0;
  const std::uint64_t seed = firstSeed();
  for (std::uint64_t round = 0; round < 600; ++round) {
    scenes::Random random(seed + round);
    INFO("seed " << seed + round);
    const double sceneSize = round % 2 == 0 ? 1 : 64;
    const double sizes[] = {1e-4, 1e-2, 0.3};
    const double size = sceneSize * sizes[random.below(3)];
    const Vec3 centre = pointInCube(random, sceneSize / 4);
    std::vector<Vec3> points;
    for (int t = 0; t < 8; ++t) {
      // A corner far from the other two, or not.
      const double narrow = random.below(2) == 0 ? 1 : 1e-3;
      const Vec3 near = centre + pointInCube(random, size);
      points.push_back(centre + pointInCube(random, size));
      points.push_back(near);
      points.push_back(near + pointInCube(random, narrow * size));
      std::rotate(points.end() - 3, points.end() - 3 + random.below(3), points.end());
    }
    const SmallTree tree(points, static_cast<float>(sceneSize));
    Rays rays(64);
    for (int i = 0; i < 64; ++i) {
      const std::uint32_t t = random.below(8), k = random.below(3);
      const Vec3 a = tree.corner(3 * t + k), b = tree.corner(3 * t + (k + 1) % 3);
      const double shares[] = {0, 1e-4, numberIn(random, 0, 1)};
      const double beside[] = {0, 1e-8, 1e-7, 1e-6, 1e-5};
      const Vec3 towards =
          a + shares[random.below(3)] * (b - a) + pointInCube(random, sceneSize * beside[random.below(5)]);
      const double away[] = {sceneSize / 5, 3 * size, 1e-5 * sceneSize};
      rays.add(towards + pointInCube(random, away[random.below(3)]), towards);
    }
    for (const double from : {1e-5 * sceneSize, -1e-5 * sceneSize}) {
      std::vector<double> firsts;
      for (const Ray& ray : rays.rays) {
        double first = std::numeric_limits<double>::infinity();
        for (std::uint32_t t = 0; t < 8; ++t) {
          const double distance = tree.distance(t, ray);
          if (distance > from) first = std::min(first, distance);
        }
        firsts.push_back(first);
      }
      const auto check = [&](const Rays& ended, double share) {
        const Hits any(tree, ended, from, RaySearch::Find::any), nearest(tree, ended, from, RaySearch::Find::nearest);
        for (std::size_t r = 0; r < firsts.size(); ++r) {
          const bool isHit = std::isfinite(firsts[r]) && firsts[r] <= ended.rays[r].end;
          INFO("ray " << r << " from " << from << ", first hit at " << firsts[r] << ", which times " << share
                      << " is its end");
          CHECK(any.hit[r] == isHit);
          CHECK(nearest.hit[r] == isHit);
          if (isHit) CHECK(nearest.rays[r].end == firsts[r]);
          ++(isHit ? hits : misses);
        }
      };
      check(rays, std::numeric_limits<double>::infinity());
      for (const double share : {0.6, 1 - 1e-7, 1.0, 1 + 1e-7, 1.7}) {
        Rays ended = rays;
        for (std::size_t r = 0; r < firsts.size(); ++r) ended.rays[r].end = share * firsts[r];
        check(ended, share);
      }
    }
  }
  CHECK(hits > 10'000);
  CHECK(misses > 10'000);
}

TEST_CASE("a ray through the middle of a triangle hits it, however small, and one beside it does not", "[rays]") {
  for (const double size : {1.0, 1e-2, 1e-4, 1e-6}) {
    const Vec3 a{0, 0, 0}, b{size, 0, 0}, c{0, size, 0};
    const SmallTree tree({a, b, c, a, b, c, a, b, c, a, b, c}, 1);
    Rays rays(4);
    for (const double side : {1.0, -1.0}) {
      rays.add({0.1, 0.2, side * 0.5}, {size / 3, size / 3, 0});
      rays.add({0.1, 0.2, side * 0.5}, {size * 0.6, size * 0.6, 0});
    }
    const Hits found(tree, rays, 1e-5, RaySearch::Find::nearest);
    for (const std::size_t r : {0u, 2u}) {
      INFO("size " << size << ", ray " << r);
      CHECK(found.hit[r]);
      CHECK(!found.hit[r + 1]);
    }
  }
}

TEST_CASE("no ray passes between triangles that share an edge, from either side", "[rays]") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
  const SmallTree tree({a, b, c, a, c, d, a, b, c, a, c, d}, 2);
  Rays rays(18);
  for (const double side : {0.5, -0.5}) {
    for (int i = 0; i <= 8; ++i) rays.add({i / 8.0, i / 8.0, side}, {i / 8.0, i / 8.0, 0});
  }
  const Hits found(tree, rays, 1e-5, RaySearch::Find::any);
  for (std::size_t r = 0; r < rays.rays.size(); ++r) {
    INFO("ray " << r);
    CHECK(found.hit[r]);
    CHECK(tree.distance(0, rays.rays[r]) == 0.5);
    CHECK(tree.distance(1, rays.rays[r]) == 0.5);
  }
}
