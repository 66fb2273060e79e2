#include <algorithm>
#include <cmath>

#include "steps.hpp"
#include "triangle.hpp"

namespace cagecast {
namespace {

/// SPEC §1: planes whose distance is within this share of the diagonal of the farthest are equally far.
constexpr double kTiePlane = 1e-7;

/// A triangle that could be the nearest, in double.
struct Candidate {
  std::uint32_t slot;
  double distance;
  double planeDistance;
};

struct Corners {
  explicit Corners(const CageTriangle& t) : a(Vec3::from(t.a)), b(Vec3::from(t.b)), c(Vec3::from(t.c)) {}
  Vec3 a, b, c;
};

/// Picks, of the triangles that could be the nearest, the one that SPEC's tie rule names: of those within
/// `kTieDistance` of the nearest the one whose plane is farthest from p, of equals the first.
std::uint32_t nearestOf(const Cage& cage, Vec3 p, double diagonal, const std::uint32_t* found, std::uint32_t count,
                        Candidate* candidates) {
  double least = INFINITY;
  for (std::uint32_t i = 0; i < count; ++i) {
    const CageTriangle& t = cage.triangles[found[i]];
    const Corners corners(t);
    const double distance = std::sqrt(closestPoint(p, corners.a, corners.b, corners.c).squaredDistance);
    candidates[i] = {found[i], distance, std::abs(dot(p - corners.a, t.normal.exact))};
    least = std::min(least, distance);
  }
  double farthest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (candidates[i].distance <= least + kTieDistance * diagonal) farthest = std::max(farthest, candidates[i].planeDistance);
  }
  std::uint32_t first = UINT32_MAX;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Candidate& c = candidates[i];
    if (c.distance > least + kTieDistance * diagonal || c.planeDistance < farthest - kTiePlane * diagonal) continue;
    first = std::min(first, c.slot);
  }
  return first;
}

}  // namespace

bool projectPoints(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* found = scratch.take<std::uint32_t>(cage.count);
  auto* candidates = scratch.take<Candidate>(cage.count);
  if (scratch.failed()) return false;

  for (std::uint32_t i = 0; i < points.count; ++i) {
    const Vec3 p = Vec3::from(points.at(i));
    const std::uint32_t count = nearTriangles(tree, points.at(i), units.diagonal, found);
    const std::uint32_t slot = count == 1 ? found[0] : nearestOf(cage, p, units.diagonal, found, count, candidates);

    const CageTriangle& t = cage.triangles[slot];
    const Corners corners(t);
    const ClosestPoint q = closestPoint(p, corners.a, corners.b, corners.c);
    for (int k = 0; k < 2; ++k) {
      const auto uv = [&](int corner) { return static_cast<double>(t.uvs[2 * corner + k]); };
      results.uvs[2 * i + static_cast<std::uint32_t>(k)] = static_cast<float>(q.u * uv(0) + q.v * uv(1) + q.w * uv(2));
    }
    results.distances[i] = static_cast<float>(std::sqrt(q.squaredDistance));
    results.triangles[i] = slot;
    results.zones[i] = Zone::cosmetic;
    // Strictly inside its triangle, q = p − h·n for the height h of p over the plane, so the ray hits it at −h.
    results.meetsCage[i] = q.inside && -dot(p - corners.a, t.normal.exact) > -kRayStart * units.diagonal;
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
