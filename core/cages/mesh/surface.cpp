#include "mesh/surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>

#include "base/arena.hpp"
#include "base/tolerances.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "mesh/bounds.hpp"
#include "search/cage_tree.hpp"
#include "search/closest_point_search.hpp"
#include "search/ray_search.hpp"

namespace cagecast::cages {

struct Surface::Trees {
  Arena arena;
  Units units;
  cagecast::Cage cage;
  CageTree tree;
  Vec3 centre{};    ///< Of the box: coordinates relative to it have smaller rounding errors.
  double edge = 0;  ///< The typical length of an edge, scaled.

  [[nodiscard]] Vec3 scaled(const Vec3& p) const { return static_cast<double>(units.scale) * (p - centre); }
  [[nodiscard]] Vec3 unscaled(const Vec3& p) const { return 1 / static_cast<double>(units.scale) * p + centre; }
};

namespace {

/// A triangle is a needle if its height is less than this share of the mesh's diagonal: the search takes floats, in
/// which it has no certain plane.
constexpr double kNeedle = 1e-6;
/// Points are searched for together if they are within this many edges of the first: those farther apart have different
/// triangles near them, and each would be tested against all.
constexpr double kGroupEdges = 2;
/// A mesh with a smaller diagonal is a point: a float does not hold what would scale it.
constexpr double kPoint = 1e-30;
/// How far from the centre points are searched from, in diagonals: `sceneSize` allows for eight.
constexpr double kReach = 6;

/// Whether each triangle is a needle; none of them, if all are.
std::vector<bool> needlesIn(const TriangleMesh& mesh, double diagonal) {
  std::vector<bool> out;
  for (const Triangle3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t[0]];
    const Vec3 ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
    const double longest = std::max({length(ab), length(ac), length(ac - ab)});
    out.push_back(length(cross(ab, ac)) <= kNeedle * diagonal * longest);
  }
  if (std::find(out.begin(), out.end(), false) == out.end()) out.assign(out.size(), false);
  return out;
}

/// What is closest to a point that is not finite: nothing.
constexpr SurfacePoint kNowhere{0, {0, 0, 0}, {1, 0, 0}, std::numeric_limits<double>::infinity(), 0};

/// If memory has run out, does what `operator new` does then: throws `std::bad_alloc`, or ends the program if that is
/// compiled without exceptions.
void checkMemory(const Arena& arena) {
  if (!arena.failed()) return;
#ifdef __cpp_exceptions
  throw std::bad_alloc();
#else
  std::abort();
#endif
}

}  // namespace

Surface::Surface(const TriangleMesh& mesh) : trees_(std::make_unique<Trees>()) {
  Trees& trees = *trees_;
  const Bounds bounds = boundsOf(mesh);
  trees.centre = bounds.middle();
  const double diagonal = bounds.diagonal();
  if (diagonal < kPoint) return;
  int exponent = 0;
  std::frexp(diagonal, &exponent);
  trees.units.scale = static_cast<float>(std::ldexp(1.0, 1 - exponent));
  trees.units.diagonal = diagonal * static_cast<double>(trees.units.scale);
  trees.units.sceneSize = static_cast<float>(8 * trees.units.diagonal);
  std::vector<float> positions;
  positions.reserve(3 * mesh.positions.size());
  for (const Vec3& p : mesh.positions) append(positions, trees.scaled(p));
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * mesh.triangles.size());
  const std::vector<bool> isNeedle = needlesIn(mesh, diagonal);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    // A needle becomes a point, which is left out: its neighbours are as near.
    for (const std::uint32_t v : mesh.triangles[i]) indices.push_back(isNeedle[i] ? mesh.triangles[i][0] : v);
  }
  const double perTriangle = 2 * areaOf(mesh) / static_cast<double>(mesh.triangles.size());
  trees.edge = static_cast<double>(trees.units.scale) * std::sqrt(perTriangle);
  const std::vector<float> uvs(2 * mesh.positions.size(), 0.0f);
  Units identity = trees.units;
  identity.scale = 1;  // Positions are scaled already.
  if (gatherCage({positions, indices, uvs}, identity, trees.arena, trees.cage))
    buildCageTree(trees.cage, identity, trees.arena, trees.tree);
  checkMemory(trees.arena);
}

Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;
Surface::~Surface() = default;

std::vector<SurfacePoint> Surface::closest(std::span<const Vec3> points) const {
  Trees& trees = *trees_;
  const std::uint32_t triangleCount = trees.cage.count;
  if (triangleCount == 0) {
    std::vector<SurfacePoint> out;
    for (const Vec3& p : points)
      out.push_back(isFinite(p) ? SurfacePoint{0, trees.centre, {1, 0, 0}, length(p - trees.centre), 0} : kNowhere);
    return out;
  }
  const Arena::Scope scope(trees.arena);
  auto* found = trees.arena.allocate<std::uint32_t>(triangleCount);
  auto* candidates = trees.arena.allocate<Candidate>(triangleCount);
  // The search takes floats; the slack allows for the rounding of the points.
  ClosestPointSearch search(trees.tree, trees.units.diagonal + static_cast<double>(trees.units.sceneSize), trees.arena);
  checkMemory(trees.arena);
  std::vector<SurfacePoint> out(points.size());
  constexpr std::uint32_t kGroup = ClosestPointSearch::kGroup;
  float group[4 * kGroup] = {};
  const double most = kReach * trees.units.diagonal;
  const auto inReach = [&](const Vec3& p) { return length(p) > most ? most / length(p) * p : p; };
  for (std::size_t first = 0, next = 0; first < points.size(); first = next) {
    if (!isFinite(points[first])) {
      out[first] = kNowhere;
      ++next;
      continue;
    }
    const Vec3 start = inReach(trees.scaled(points[first]));
    std::uint32_t count = 0;
    for (; next < points.size() && count < kGroup; ++next, ++count) {
      const Vec3 p = inReach(trees.scaled(points[next]));
      if (!(length(p - start) <= kGroupEdges * trees.edge)) break;
      group[4 * count] = static_cast<float>(p.x);
      group[4 * count + 1] = static_cast<float>(p.y);
      group[4 * count + 2] = static_cast<float>(p.z);
    }
    search.search(group, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 p = trees.scaled(points[first + i]);
      const std::uint32_t candidateCount = search.candidates(i, found);
      if (candidateCount == 0) {
        out[first + i] = kNowhere;
        continue;
      }
      for (std::uint32_t c = 0; c < candidateCount; ++c)
        candidates[c] = {found[c], closestPointOnTriangle(trees.cage.triangles[found[c]], p)};
      const Candidate& best = nearestOf(candidates, candidateCount, trees.units.diagonal);
      const CageTriangle& triangle = trees.cage.triangles[best.cageTriangle];
      SurfacePoint& point = out[first + i];
      const double toModel = 1 / static_cast<double>(trees.units.scale);
      point.triangle = triangle.index;
      point.position = trees.unscaled(positionOf(triangle, best.point));
      point.weights = {1 - best.point.v - best.point.w, best.point.v, best.point.w};
      point.distance = best.point.distance * toModel;
      point.height = best.point.height * toModel;
    }
  }
  return out;
}

SurfacePoint Surface::closest(const Vec3& point) const { return closest(std::span(&point, 1))[0]; }

std::vector<double> Surface::distances(std::span<const SurfaceRay> rays, double from) const {
  Trees& trees = *trees_;
  std::vector<double> out(rays.size(), std::numeric_limits<double>::infinity());
  if (trees.cage.count == 0) return out;
  const Arena::Scope scope(trees.arena);
  const auto scale = static_cast<double>(trees.units.scale);
  RaySearch search(trees.tree.rays, from * scale, trees.arena);
  checkMemory(trees.arena);
  const std::size_t most = std::min<std::size_t>(RaySearch::kMaxRays, rays.size());
  std::vector<Ray> chunk(most);
  std::vector<RayDirection> directions(most);
  const auto hit = std::make_unique<bool[]>(most);
  for (std::size_t first = 0; first < rays.size(); first += most) {
    const auto count = static_cast<std::uint32_t>(std::min(most, rays.size() - first));
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 origin = trees.scaled(rays[first + i].origin);
      const double exact[3] = {origin.x, origin.y, origin.z};
      float position[3];
      float rest[3];
      for (int k = 0; k < 3; ++k) {
        position[k] = static_cast<float>(exact[k]);
        rest[k] = static_cast<float>(exact[k] - static_cast<double>(position[k]));
      }
      directions[i] = RayDirection::along(rays[first + i].direction);
      chunk[i].startAt(position, rest);
      chunk[i].direction = &directions[i];
      chunk[i].end = std::numeric_limits<double>::infinity();
    }
    search.search(chunk.data(), count, hit.get(), RaySearch::Find::nearest);
    for (std::uint32_t i = 0; i < count; ++i)
      if (hit[i]) out[first + i] = chunk[i].end / scale;
  }
  return out;
}

double Surface::distance(const SurfaceRay& ray) const { return distances(std::span(&ray, 1))[0]; }

std::vector<RayHit> Surface::trace(std::span<const SurfaceRay> rays, double from) const {
  const std::vector<double> far = distances(rays, from);
  std::vector<RayHit> out(rays.size(), {std::numeric_limits<double>::infinity(), 0});
  std::vector<Vec3> hitPoints;
  std::vector<std::size_t> hitRays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (std::isinf(far[i])) continue;
    out[i].distance = far[i];
    hitRays.push_back(i);
    hitPoints.push_back(rays[i].origin + far[i] * rays[i].direction);
  }
  // The ray search tells how far; the triangle is the one that the hit lies on.
  const std::vector<SurfacePoint> on = closest(hitPoints);
  for (std::size_t i = 0; i < on.size(); ++i) out[hitRays[i]].triangle = on[i].triangle;
  return out;
}

}  // namespace cagecast::cages
