#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <new>
#include <utility>

#include "geometry/triangle.hpp"
#include "steps/areas.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 6: where a ray begins above its point, as a share of the diagonal, and how many good ones
/// restore it.
constexpr double kLift = 1e-4;
constexpr unsigned kEnough = 2;

/// docs/method.md, step 6: the directions, evenly over the hemisphere about z by the golden angle: z = 1 − (k + 0.5) /
/// 12, azimuth k · 2.399963229728653. First those that are good most often (k = 4, 5, 8, 9, 10), so that many points
/// need no others.
constexpr double kDirections[][3] = {
    {-0.7686917180988453, -0.13597074143449128, 0.625},
    {0.7092551110048801, -0.4511700452553088, 0.5416666666666667},
    {0.8984796285317633, 0.3281233193008084, 0.29166666666666663},
    {-0.9040634576660739, 0.37318425306420056, 0.20833333333333337},
    {0.42052166140780717, -0.8986303646588055, 0.125},
    {0.28565227501671, 0.0, 0.9583333333333334},
    {-0.3569771731011225, 0.32702033252495366, 0.875},
    {0.05341303173720899, -0.6086139473669074, 0.7916666666666666},
    {0.42948366578740593, 0.5601853886979745, 0.7083333333333333},
    {-0.23073121154526574, 0.8583086062567528, 0.45833333333333337},
    {-0.4272722474213815, -0.8226867122930099, 0.375},
    {0.2990239565674109, 0.9533354930388671, 0.04166666666666663},
};
constexpr unsigned kDirectionCount = static_cast<unsigned>(std::size(kDirections));
/// A point looks in the first so many directions, then, if that does not decide, up to the next of these. Fewer at a
/// time would save rays, but many rays that begin close together are quicker than few.
constexpr unsigned kStages[] = {5, kDirectionCount - 1, kDirectionCount};
/// How many directions a point looks in next, which has looked in so many.
constexpr unsigned nextStage(unsigned asked) {
  return *std::upper_bound(std::begin(kStages), std::end(kStages), asked) - asked;
}
/// Points that look at once.
constexpr std::uint32_t kMostLooks = HitSearch::kMostRays / kStages[0];

/// Normals that cancel out to this share of the areas are none.
constexpr double kCancelled = 1e-6;
/// Triangles that differ in area by less than this share are equally large.
constexpr double kSameArea = 1e-12;

/// Here and below nothing branches on what nobody can guess.
bool isZero(Vec3 v) { return (v.x == 0) & (v.y == 0) & (v.z == 0); }

/// The occluded points of the segments that are looked at, and which triangles join them.
class Occluded {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  Occluded(const Points& points, const PointResults& results, const Array<SegmentStats>& stats, Arena& arena) noexcept
      : points_(points),
        isOccluded_(arena.allocate<bool>(points.count)),
        isQueued_(arena.allocate<bool>(points.count)),
        starts_(arena.allocate<std::uint32_t>(std::size_t{points.count} + 1)) {
    auto* joining = arena.allocate<std::uint32_t>(points.triangleCount);
    if (arena.failed()) return;
    for (std::uint32_t p = 0; p < points.count; ++p) {
      isOccluded_[p] = (results.zones[p] == Zone::occluded) & (stats[results.segments[p]].coveredArea > 0);
    }
    std::fill(isQueued_, isQueued_ + points.count, false);
    std::fill(starts_, starts_ + points.count + 1, 0u);
    const auto occludedAt = [&](const std::uint32_t* corner) {
      return unsigned{isOccluded_[corner[0]]} + unsigned{isOccluded_[corner[1]]} + unsigned{isOccluded_[corner[2]]};
    };
    // Those with any corner that is occluded are listed first: few are, and where they begin and end nobody can guess.
    std::uint32_t listed = 0;
    for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
      joining[listed] = t;
      listed += occludedAt(points.triangles + std::size_t{3} * t) > 0;
    }
    std::uint32_t joiningCount = 0;
    for (std::uint32_t i = 0; i < listed; ++i) {
      const std::uint32_t* corner = points.triangles + std::size_t{3} * joining[i];
      const unsigned occluded = occludedAt(corner);
      for (int k = 0; k < 3; ++k) {
        isQueued_[corner[k]] = isQueued_[corner[k]] | ((occluded < 3) & isOccluded_[corner[k]]);
        starts_[corner[k]] += occluded > 1;
      }
      joining[joiningCount] = joining[i];
      joiningCount += occluded > 1;
    }
    std::uint32_t total = 0;
    for (std::uint32_t p = 0; p <= points.count; ++p) total += std::exchange(starts_[p], total);
    triangles_ = arena.allocate<std::uint32_t>(total);
    if (arena.failed()) return;
    for (std::uint32_t i = 0; i < joiningCount; ++i) {
      const std::uint32_t* corner = points.triangles + std::size_t{3} * joining[i];
      for (int k = 0; k < 3; ++k) triangles_[starts_[corner[k]]++] = joining[i];
    }
    // Each start has become its end, which is the next one's start.
  }

  /// 1 per point: whether it is occluded, and of a segment that is looked at.
  [[nodiscard]] const bool* asks() const noexcept { return isOccluded_; }

  /// Queues the points joined by an edge to one that is not occluded, in their order: neighbours look together.
  std::uint32_t queueRim(std::uint32_t* queue) const noexcept {
    std::uint32_t count = 0;
    for (std::uint32_t p = 0; p < points_.count; ++p) {
      queue[count] = p;
      count += isQueued_[p];
    }
    return count;
  }

  /// Queues the occluded neighbours of a point that were never queued.
  std::uint32_t queueNeighbours(std::uint32_t point, std::uint32_t* queue, std::uint32_t count) noexcept {
    for (std::uint32_t i = point == 0 ? 0 : starts_[point - 1]; i < starts_[point]; ++i) {
      const std::uint32_t* corner = points_.triangles + std::size_t{3} * triangles_[i];
      for (int k = 0; k < 3; ++k) count = put(corner[k], queue, count);
    }
    return count;
  }

 private:
  std::uint32_t put(std::uint32_t point, std::uint32_t* queue, std::uint32_t count) noexcept {
    if (isQueued_[point] || !isOccluded_[point]) return count;
    isQueued_[point] = true;
    queue[count] = point;
    return count + 1;
  }

  const Points& points_;
  bool* isOccluded_;
  bool* isQueued_;
  std::uint32_t* starts_;  ///< 1 per point: the end of its triangles.
  std::uint32_t* triangles_ = nullptr;
};

/// Which way points look.
struct Outlooks {
  Vec3* normals;     ///< 1 per point: of unit length, or zero if it has none.
  bool* isTwoSided;  ///< 1 per point: whether it looks the other way as well.
  bool* isTurned;    ///< 1 per segment: whether its normals disagree with the cage's, on the whole.
};

/// Sums the area normals of the triangles at a point. They are rounded first, to 2^-33 of the area at the point: such
/// sums are exact, and so do not depend on the order of the triangles.
class NormalSums {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  NormalSums(const AreaUnit& unit, const std::int64_t* areas, std::uint32_t pointCount, Vec3* sums,
             Arena& arena) noexcept
      : unit_(unit), areas_(areas), large_(arena.allocate<double>(pointCount)), sums_(sums) {
    if (arena.failed()) return;
    for (std::uint32_t p = 0; p < pointCount; ++p) large_[p] = unit.area(areas[p] + 1) * kLarge;
  }
  void add(std::uint32_t point, Vec3 areaNormal) noexcept {
    // Added to so large a number, and taken from it again, only the bits that all terms have remain.
    const double large = large_[point];
    sums_[point] =
        sums_[point] + Vec3{areaNormal.x + large - large, areaNormal.y + large - large, areaNormal.z + large - large};
  }
  /// Brings the sum of a point to unit length, or to zero if the normals cancel out.
  void normalize(std::uint32_t point) noexcept {
    const double size = length(sums_[point]);
    const double all = 6 * unit_.area(areas_[point]);  // As long as all together would be.
    sums_[point] = size > kCancelled * all ? 1 / size * sums_[point] : Vec3{0, 0, 0};
  }

 private:
  static constexpr double kLarge = 0x1.8p21;
  const AreaUnit& unit_;
  const std::int64_t* areas_;
  double* large_;  ///< 1 per point.
  Vec3* sums_;
};

/// Finds the outlooks of the points of those segments that `isWanted`.
/// @param asks          1 per point: whether it is going to look.
/// With `bothSides`, where all triangles have copies in reverse winding, a point that asks looks along the sum of the
/// normals, each turned to the side of the largest triangle, and against it.
/// @param[out] outlooks  Taken from `arena`.
/// @return false if memory ran out.
bool findOutlooks(const Points& points, const Cage& cage, const Units& units, const PointResults& results,
                  const PointAreas& areas, std::uint32_t segmentCount, const bool* isWanted, const bool* asks,
                  const TransferOptions& options, Arena& arena, Outlooks& outlooks) noexcept {
  Vec3* normals = outlooks.normals = arena.allocate<Vec3>(points.count);
  outlooks.isTwoSided = arena.allocate<bool>(points.count);
  outlooks.isTurned = arena.allocate<bool>(segmentCount);
  const Arena::Mark mark = arena.mark();
  auto* agreement = arena.allocate<std::int64_t>(segmentCount);
  const AreaUnit unit(points.triangleCount, units.diagonal);
  NormalSums sums(unit, areas.all, points.count, normals, arena);
  if (arena.failed()) return false;
  std::fill(normals, normals + points.count, Vec3{0, 0, 0});
  std::fill(outlooks.isTwoSided, outlooks.isTwoSided + points.count, false);
  std::fill(agreement, agreement + segmentCount, 0);
  const auto eachWanted = [&](auto call) {
    for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
      const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
      if (isWanted[results.segments[corner[0]]]) call(t, corner);
    }
  };
  const auto normalOf = [&](const std::uint32_t* corner) {
    return areaNormal(points.at(corner[0]), points.at(corner[1]), points.at(corner[2]));
  };
  eachWanted([&](std::uint32_t, const std::uint32_t* corner) {
    const Vec3 normal = normalOf(corner);
    for (int i = 0; i < 3; ++i) sums.add(corner[i], normal);
  });
  bool anyCancelled = false;
  for (std::uint32_t p = 0; p < points.count; ++p) {
    const std::uint32_t s = results.segments[p];
    if (!isWanted[s]) continue;
    sums.normalize(p);
    anyCancelled = anyCancelled | (asks[p] & isZero(normals[p]));
    const double agrees = dot(normals[p], cage.triangles[results.triangles[p]].normal.exact);
    // Of a closed part inside and outside cancel out, but what is inside of it is occluded.
    const bool counts = !(options.steps.exposedSide & asks[p]);
    agreement[s] += static_cast<std::int64_t>(static_cast<double>(areas.all[p]) * agrees) * counts;
  }
  for (std::uint32_t s = 0; s < segmentCount; ++s) outlooks.isTurned[s] = agreement[s] < 0;

  if (anyCancelled && options.steps.bothSides) {
    auto* largest = arena.allocate<std::uint32_t>(points.count);
    if (arena.failed()) return false;
    std::fill(largest, largest + points.count, UINT32_MAX);
    for (std::uint32_t p = 0; p < points.count; ++p) {
      outlooks.isTwoSided[p] = isWanted[results.segments[p]] && asks[p] && isZero(normals[p]);
    }
    const auto eachTwoSided = [&](auto call) {
      eachWanted([&](std::uint32_t t, const std::uint32_t* corner) {
        for (int i = 0; i < 3; ++i) {
          if (outlooks.isTwoSided[corner[i]]) call(t, corner, corner[i]);
        }
      });
    };
    eachTwoSided([&](std::uint32_t t, const std::uint32_t*, std::uint32_t p) {
      if (largest[p] == UINT32_MAX || points.doubleAreas[t] > points.doubleAreas[largest[p]] * (1 + kSameArea))
        largest[p] = t;
    });
    eachTwoSided([&](std::uint32_t, const std::uint32_t* corner, std::uint32_t p) {
      const Vec3 normal = normalOf(corner);
      const bool isTurned = dot(normal, normalOf(points.triangles + std::size_t{3} * largest[p])) < 0;
      sums.add(p, isTurned ? -1 * normal : normal);
    });
    for (std::uint32_t p = 0; p < points.count; ++p) {
      if (outlooks.isTwoSided[p]) sums.normalize(p);
    }
  }
  arena.rewind(mark);
  return true;
}

/// Looks from points to the cage.
class Lookout {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  Lookout(const Points& points, const Outlooks& outlooks, const RayTree& target, const RayTree& cage, double diagonal,
          Arena& arena) noexcept
      : points_(points),
        outlooks_(outlooks),
        lift_(kLift * diagonal),
        pastTarget_(target, kRayStart * diagonal, arena),
        toCage_(cage, -kRayStart * diagonal, arena),
        looks_(arena.allocate<Look>(kMostLooks)),
        directions_(arena.allocate<RayDirection>(HitSearch::kMostRays)),
        rays_(arena.allocate<Ray>(HitSearch::kMostRays)),
        ofRay_(arena.allocate<std::uint16_t>(HitSearch::kMostRays)),
        hit_(arena.allocate<bool>(HitSearch::kMostRays)) {}

  [[nodiscard]] bool isIdle() const noexcept { return lookCount_ == 0; }
  /// For a point, to whichever sides it looks.
  [[nodiscard]] bool hasRoom() const noexcept { return lookCount_ + 2 <= kMostLooks; }

  /// Lets a point that has a normal look.
  /// @param isTurned  Whether it looks against its normal.
  /// @pre There is room.
  void add(std::uint32_t point, bool isTurned) noexcept {
    looks_[lookCount_++] = {point, isTurned, 0, 0};
    if (outlooks_.isTwoSided[point]) looks_[lookCount_++] = {point, !isTurned, 0, 0};
  }

  /// Looks in some more directions from the points added, and forgets those that this decides.
  /// @param restore  Takes a point with enough good rays.
  template <typename Restore>
  void look(Restore restore) noexcept {
    std::uint32_t looking = 0;
    std::uint32_t rayCount = 0;
    for (; looking < lookCount_; ++looking) {
      const unsigned more = nextStage(looks_[looking].asked);
      if (rayCount + more > HitSearch::kMostRays) break;
      std::fill(ofRay_ + rayCount, ofRay_ + rayCount + more, static_cast<std::uint16_t>(looking));
      setRays(looks_[looking], more, rayCount);
      rayCount += more;
    }
    pastTarget_.search(rays_, rayCount, hit_);
    std::uint32_t free = 0;
    for (std::uint32_t r = 0; r < rayCount; ++r) {
      if (hit_[r]) continue;
      ofRay_[free] = ofRay_[r];
      rays_[free++] = rays_[r];
    }
    toCage_.search(rays_, free, hit_);
    for (std::uint32_t r = 0; r < free; ++r)
      looks_[ofRay_[r]].good = static_cast<std::uint8_t>(looks_[ofRay_[r]].good + hit_[r]);

    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < lookCount_; ++i) {
      const Look& look = looks_[i];
      const bool isSeen = look.good >= kEnough;
      if (isSeen) restore(look.point);
      const bool isDecided = isSeen || look.good + kDirectionCount - look.asked < kEnough;
      looks_[left] = look;
      left += !isDecided;
    }
    lookCount_ = left;
  }

 private:
  /// A point that looks to one side.
  struct Look {
    std::uint32_t point;
    bool isTurned;
    std::uint8_t asked;  ///< In how many directions it has looked,
    std::uint8_t good;   ///< and how many of these were good.
  };

  /// Makes the next rays of a look.
  void setRays(Look& look, unsigned more, std::uint32_t first) noexcept {
    const Vec3 normal = (look.isTurned ? -1 : 1) * outlooks_.normals[look.point];
    const Vec3 across = cross(normal, std::abs(normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    const Vec3 t1 = 1 / length(across) * across;
    const Vec3 t2 = cross(normal, t1);
    float position[Points::kStride];
    float rest[3];
    Points::split(points_.exactly(look.point) + lift_ * normal, position, rest);
    for (std::uint32_t r = first; r < first + more; ++r) {
      const double(&d)[3] = kDirections[look.asked++];
      // In place: a direction that is copied right after it was written stalls.
      new (&directions_[r]) RayDirection(RayDirection::along(d[2] * normal + (d[0] * t1 + d[1] * t2)));
      Ray& ray = rays_[r];
      ray.startAt(position, rest);
      ray.direction = &directions_[r];
      ray.end = std::numeric_limits<double>::infinity();
    }
  }

  const Points& points_;
  const Outlooks& outlooks_;
  double lift_;
  HitSearch pastTarget_;
  HitSearch toCage_;
  Look* looks_;
  std::uint32_t lookCount_ = 0;
  RayDirection* directions_;
  Ray* rays_;
  std::uint16_t* ofRay_;  ///< The place of its look.
  bool* hit_;
};

}  // namespace

bool recheckOccluded(const Points& points, const Cage& cage, const CageTree& cageTree, const RayTree& targetTree,
                     const Units& units, const PointResults& results, const PointAreas& areas,
                     const Array<SegmentStats>& stats, const TransferOptions& options, Arena& arena,
                     std::uint32_t* recovery) noexcept {
  const auto segmentCount = static_cast<std::uint32_t>(stats.size());
  const Arena::Mark mark = arena.mark();
  auto* queue = arena.allocate<std::uint32_t>(points.count);
  auto* isWanted = arena.allocate<bool>(segmentCount);
  Occluded occluded(points, results, stats, arena);
  if (arena.failed()) return false;
  std::uint32_t end = occluded.queueRim(queue);
  if (end > 0) {
    std::fill(isWanted, isWanted + segmentCount, false);
    for (std::uint32_t i = 0; i < end; ++i) isWanted[results.segments[queue[i]]] = true;
    Outlooks outlooks;
    if (!findOutlooks(points, cage, units, results, areas, segmentCount, isWanted, occluded.asks(), options, arena,
                      outlooks))
      return false;
    Lookout lookout(points, outlooks, targetTree, cageTree.rays, units.diagonal, arena);
    if (arena.failed()) return false;
    // What is seen does not depend on who asks, so neither does what is restored in the end on the order of the queue.
    for (std::uint32_t begin = 0; begin < end || !lookout.isIdle();) {
      for (; begin < end && lookout.hasRoom(); ++begin) {
        const std::uint32_t p = queue[begin];
        if (!isZero(outlooks.normals[p])) lookout.add(p, outlooks.isTurned[results.segments[p]]);
      }
      lookout.look([&](std::uint32_t p) {
        recovery[p] = Recovery::always;
        end = occluded.queueNeighbours(p, queue, end);
      });
    }
  }
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
