#include "steps/twins.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/heap_sort.hpp"

namespace cagecast {
namespace {

/// docs/method.md, section 5″: twins have equally many points. By what share the area of the larger may exceed that of
/// the smaller.
constexpr double kAreaTolerance = 0.01;
/// By what share their extents may differ.
constexpr double kExtentTolerance = 0.02;
/// A segment is compared with this many kinds at most, the latest ones. In the order of `Order`, twins are seldom
/// farther apart.
constexpr std::uint32_t kMaxKinds = 8;

/// Segments in an order in which twins are close together: by points, area and number.
class Order {
 public:
  Order(const Array<SegmentStats>& stats, Arena& arena) noexcept
      : stats_(stats), segments_(arena.allocate<std::uint64_t>(stats.size())) {
    if (arena.failed()) return;
    for (std::uint32_t s = 0; s < count(); ++s) segments_[s] = s;
    heapSort(segments_, segments_ + count(), [&](std::uint64_t s, std::uint64_t t) {
      const SegmentStats& a = stats[static_cast<std::uint32_t>(s)];
      const SegmentStats& b = stats[static_cast<std::uint32_t>(t)];
      return std::tie(a.points, a.area, s) < std::tie(b.points, b.area, t);
    });
  }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(stats_.size()); }
  [[nodiscard]] std::uint32_t operator[](std::uint32_t i) const { return static_cast<std::uint32_t>(segments_[i]); }

  /// Whether no other segment has as many points as segment i of the order.
  [[nodiscard]] bool isAlone(std::uint32_t i) const {
    const auto hasAsMany = [&](std::uint32_t j) { return stats_[(*this)[j]].points == stats_[(*this)[i]].points; };
    return !(i > 0 && hasAsMany(i - 1)) && !(i + 1 < count() && hasAsMany(i + 1));
  }

 private:
  const Array<SegmentStats>& stats_;
  std::uint64_t* segments_;
};

/// Finds the extents of segments: sums of the squared distances of the points from their mean.
/// @param isAlone       1 per segment: whether its extent is not needed.
/// @param[out] extents  1 per segment.
void findExtents(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats, const bool* isAlone,
                 double* extents) {
  Arena& arena = scene.arena;
  const Points& points = data.points;
  const Arena::Scope scope(arena);
  const std::size_t count = stats.size();
  auto* centres = arena.allocate<Vec3>(count);
  auto* shares = arena.allocate<double>(count);                // Of a point in the mean of its segment.
  auto* listed = arena.allocate<std::uint32_t>(points.count);  // The points of those segments.
  if (arena.failed()) return;
  for (std::uint32_t s = 0; s < count; ++s) {
    shares[s] = 1.0 / stats[s].points;
    centres[s] = {0, 0, 0};
    extents[s] = 0;
  }
  std::uint32_t listedCount = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    listed[listedCount] = i;
    listedCount += !isAlone[data.segments[i]];
  }
  const auto eachPoint = [&](auto call) {
    for (std::uint32_t i = 0; i < listedCount; ++i) call(data.segments[listed[i]], Vec3::from(points.at(listed[i])));
  };
  eachPoint([&](std::uint32_t s, Vec3 p) { centres[s] = centres[s] + shares[s] * p; });
  eachPoint([&](std::uint32_t s, Vec3 p) { extents[s] += dot(p - centres[s], p - centres[s]); });
}

}  // namespace

void findTwins(const Scene& scene, const PointData& data, Array<SegmentStats>& stats) noexcept {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const Order order(stats, arena);
  const std::uint32_t count = order.count();
  auto* extents = arena.allocate<double>(count);
  auto* isAlone = arena.allocate<bool>(count);
  auto* kinds = arena.allocate<std::uint32_t>(count);  // The first segment of each kind.
  if (arena.failed()) return;
  for (std::uint32_t i = 0; i < count; ++i) isAlone[order[i]] = order.isAlone(i);
  findExtents(scene, data, stats, isAlone, extents);
  if (arena.failed()) return;

  std::uint32_t kindCount = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t s = order[i];
    const auto isTwinOf = [&](std::uint32_t first) {
      return stats[s].points == stats[first].points && stats[s].area <= (1 + kAreaTolerance) * stats[first].area &&
             std::abs(extents[s] - extents[first]) <= kExtentTolerance * extents[first];
    };
    const std::uint32_t oldest = kindCount - std::min(kMaxKinds, kindCount);
    std::uint32_t kind = kindCount;
    while (kind > oldest && !isTwinOf(kinds[kind - 1])) --kind;
    const bool isNew = kind == oldest;
    if (isNew) kinds[kindCount++] = s;
    stats[s].twinOf = isNew ? s : kinds[kind - 1];
  }
}

}  // namespace cagecast
