#include "steps/recheck/facing.hpp"

#include <algorithm>
#include <cmath>

#include "base/area_unit.hpp"
#include "geometry/triangle.hpp"

namespace cagecast {
namespace {

/// Normals cancel out if their sum is shorter than this share of the sum of their lengths.
constexpr double kCancelled = 1e-6;
/// Triangles whose areas differ by less than this share are equally large.
constexpr double kSameSize = 1e-12;

bool isZero(Vec3 v) { return (v.x == 0) & (v.y == 0) & (v.z == 0); }

/// Area normals at a point are rounded to the last bit of this many times the point's area. An area normal is twice as
/// long as the area of its triangle, of which the point has a third, so 6 areas are the sum of the lengths. The last
/// bit of 2^19 times that sum is at most 2^-33 of it: sums of normals then need some 34 of the 53 bits of a double.
constexpr double kRoundTo = 0x1.8p21;  // 6 · 2^19

/// Sums of the area normals of the triangles at each point. Normals are rounded to 2^-33 of the sum of their lengths
/// first: then the sums are exact, and do not depend on the order of the triangles.
class NormalSums {
 public:
  /// @param sums  1 per point: zero before.
  NormalSums(const AreaUnit& unit, const PointData& data, Vec3* sums, Arena& arena) noexcept
      : unit_(unit), areas_(data.areas), roundTo_(arena.allocate<double>(data.points.count)), sums_(sums) {
    if (arena.failed()) return;
    for (std::uint32_t p = 0; p < data.points.count; ++p) roundTo_[p] = unit.area(areas_[p] + 1) * kRoundTo;
  }
  void add(std::uint32_t point, Vec3 areaNormal) noexcept {
    // Adding a number this large, and taking it away again, rounds to its last bit.
    const double r = roundTo_[point];
    sums_[point] = sums_[point] + Vec3{areaNormal.x + r - r, areaNormal.y + r - r, areaNormal.z + r - r};
  }
  /// Brings the sum of a point to unit length, or to zero if the normals cancel out.
  void normalize(std::uint32_t point) noexcept {
    const double size = length(sums_[point]);
    const double sumOfLengths = 6 * unit_.area(areas_[point]);
    sums_[point] = size > kCancelled * sumOfLengths ? 1 / size * sums_[point] : Vec3{0, 0, 0};
  }

 private:
  AreaUnit unit_;
  const std::int64_t* areas_;
  double* roundTo_;  ///< 1 per point.
  Vec3* sums_;
};

/// The triangles of the chosen segments.
struct ChosenTriangles {
  const PointData& data;
  std::span<const bool> isChosen;

  /// @param call  Takes a triangle and its corners.
  template <typename Call>
  void each(Call call) const {
    const Points& points = data.points;
    for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
      const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
      if (isChosen[data.segments[corner[0]]]) call(t, corner);
    }
  }
};

Vec3 normalOf(const Points& points, const std::uint32_t* corner) {
  return areaNormal(points.at(corner[0]), points.at(corner[1]), points.at(corner[2]));
}

/// Finds the normals of two-sided points, whose sums are zero before.
void sumTwoSided(const Scene& scene, const ChosenTriangles& triangles, const bool* isTwoSided, NormalSums& sums) {
  const Points& points = triangles.data.points;
  const Arena::Scope scope(scene.arena);
  constexpr std::uint32_t kNone = UINT32_MAX;
  auto* largest = scene.arena.allocate<std::uint32_t>(points.count);  // Triangle at each point.
  if (scene.arena.failed()) return;
  std::fill(largest, largest + points.count, kNone);
  const auto eachTwoSided = [&](auto call) {
    triangles.each([&](std::uint32_t t, const std::uint32_t* corner) {
      for (int i = 0; i < 3; ++i) {
        if (isTwoSided[corner[i]]) call(t, corner, corner[i]);
      }
    });
  };
  eachTwoSided([&](std::uint32_t t, const std::uint32_t*, std::uint32_t p) {
    if (largest[p] == kNone || points.doubleAreas[t] > points.doubleAreas[largest[p]] * (1 + kSameSize)) largest[p] = t;
  });
  eachTwoSided([&](std::uint32_t, const std::uint32_t* corner, std::uint32_t p) {
    const Vec3 normal = normalOf(points, corner);
    const bool isAgainst = dot(normal, normalOf(points, points.triangles + std::size_t{3} * largest[p])) < 0;
    sums.add(p, isAgainst ? -1 * normal : normal);
  });
  for (std::uint32_t p = 0; p < points.count; ++p) {
    if (isTwoSided[p]) sums.normalize(p);
  }
}

}  // namespace

void findFacing(const Scene& scene, const PointData& data, std::span<const bool> isChosen, const bool* isOccluded,
                Facing& out) noexcept {
  Arena& arena = scene.arena;
  const Points& points = data.points;
  const std::size_t segmentCount = isChosen.size();
  out.normals = arena.allocate<Vec3>(points.count);
  out.isTwoSided = arena.allocate<bool>(points.count);
  out.isTurned = arena.allocate<bool>(segmentCount);
  const Arena::Scope scope(arena);
  // Area whose normals agree with the cage's, less the area whose normals oppose them.
  auto* agreement = arena.allocate<std::int64_t>(segmentCount);
  NormalSums sums(points.areaUnit(), data, out.normals, arena);
  if (arena.failed()) return;
  std::fill(out.normals, out.normals + points.count, Vec3{0, 0, 0});
  std::fill(out.isTwoSided, out.isTwoSided + points.count, false);
  std::fill(agreement, agreement + segmentCount, 0);
  const ChosenTriangles triangles{data, isChosen};
  triangles.each([&](std::uint32_t, const std::uint32_t* corner) {
    const Vec3 normal = normalOf(points, corner);
    for (int i = 0; i < 3; ++i) sums.add(corner[i], normal);
  });
  // The outside and the inside of a closed part would cancel out, so only exposed points count: its inside is occluded.
  bool isAnyCancelled = false;
  for (std::uint32_t p = 0; p < points.count; ++p) {
    const std::uint32_t s = data.segments[p];
    if (!isChosen[s]) continue;
    sums.normalize(p);
    isAnyCancelled = isAnyCancelled | (isOccluded[p] & isZero(out.normals[p]));
    const double agrees = dot(out.normals[p], scene.cage.triangles[data.cageTriangles[p]].normal.exact);
    agreement[s] += static_cast<std::int64_t>(static_cast<double>(data.areas[p]) * agrees) * !isOccluded[p];
  }
  for (std::size_t s = 0; s < segmentCount; ++s) out.isTurned[s] = agreement[s] < 0;

  if (!isAnyCancelled) return;
  for (std::uint32_t p = 0; p < points.count; ++p) {
    out.isTwoSided[p] = isChosen[data.segments[p]] && isOccluded[p] && isZero(out.normals[p]);
  }
  sumTwoSided(scene, triangles, out.isTwoSided, sums);
}

}  // namespace cagecast
