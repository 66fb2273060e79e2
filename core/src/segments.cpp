#include <bit>
#include <cmath>

#include "steps.hpp"
#include "union_find.hpp"

namespace cagecast {
namespace {

/// Areas are added up as whole numbers of a tiny unit, so that the sums do not depend on the order of the triangles.
/// A triangle inside the box of a target of diagonal < 2 has an area < 2; the sum of all stays within 63 bits.
class AreaUnit {
 public:
  explicit AreaUnit(std::uint32_t triangleCount) : perArea_(std::ldexp(1.0, 60 - static_cast<int>(std::bit_width(triangleCount)))) {}
  [[nodiscard]] std::int64_t third(double doubleArea) const { return static_cast<std::int64_t>(doubleArea / 6 * perArea_); }
  [[nodiscard]] double area(std::int64_t units) const { return static_cast<double>(units) / perArea_; }

 private:
  double perArea_;
};

struct Sums {
  std::int64_t all, exposed, covered;
};

}  // namespace

bool findSegments(const Points& points, std::uint32_t vertexCount, const Units& units, Scratch& scratch,
                  PointResults& results, Array<SegmentStats>& stats) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* parents = scratch.take<std::uint32_t>(points.count);
  if (scratch.failed()) return false;
  UnionFind sets(parents, points.count);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    sets.join(corner[0], corner[1]);
    sets.join(corner[0], corner[2]);
  }

  sets.flatten(points.count);

  // Number the components in the order in which the vertices meet them.
  std::fill(results.segments, results.segments + points.count, UINT32_MAX);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t root = parents[points.ofVertex[v]];
    if (results.segments[root] == UINT32_MAX) results.segments[root] = count++;
  }
  for (std::uint32_t i = 0; i < points.count; ++i) results.segments[i] = results.segments[parents[i]];

  auto* sums = scratch.take<Sums>(count);
  if (scratch.failed() || !stats.reset(count)) return false;
  std::fill(sums, sums + count, Sums{});
  std::fill(stats.begin(), stats.end(), SegmentStats{});
  const AreaUnit unit(points.triangleCount);
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    const std::int64_t third = unit.third(points.doubleAreas[t]);
    Sums& sum = sums[results.segments[corner[0]]];
    std::int64_t exposed = 0;
    std::int64_t covered = 0;
    for (int i = 0; i < 3; ++i) {
      const Zone zone = results.zones[corner[i]];
      exposed += zone != Zone::occluded;
      covered += zone == Zone::cosmetic;
    }
    sum.all += 3 * third;
    sum.exposed += exposed * third;
    sum.covered += covered * third;
  }
  for (std::uint32_t i = 0; i < points.count; ++i) ++stats[results.segments[i]].points;
  const double toInput = 1.0 / units.scale / units.scale;
  for (std::uint32_t s = 0; s < count; ++s) {
    stats[s].area = unit.area(sums[s].all) * toInput;
    stats[s].exposedArea = unit.area(sums[s].exposed) * toInput;
    stats[s].coveredArea = unit.area(sums[s].covered) * toInput;
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
