#include "steps/interior_samples.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast {
namespace {

using LoopBox = BoundaryLoops::Box;

/// docs/method.md, step 7: a small segment has fewer points than this.
constexpr std::uint32_t kFewPoints = 32;
/// A segment is near a hole if it is no farther from it than this share of the diagonal.
constexpr double kNearHole = 0.01;
/// A triangle is large if its longest edge is at least this share of the diagonal.
constexpr double kLargeEdge = 0.06;

bool isSmall(const SegmentStats& segment) { return segment.points < kFewPoints; }

bool areWithin(double distance, const LoopBox& a, const LoopBox& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.low[k] - distance > b.high[k] || b.low[k] > a.high[k] + distance) return false;
  }
  return true;
}

struct Corners {
  Vec3 a, b, c;
  Corners(const Points& points, std::uint32_t triangle) {
    const std::uint32_t* const corner = points.triangles + std::size_t{3} * triangle;
    a = Vec3::from(points.at(corner[0]));
    b = Vec3::from(points.at(corner[1]));
    c = Vec3::from(points.at(corner[2]));
  }
  [[nodiscard]] double longestEdge() const {
    return std::sqrt(std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)}));
  }
};

/// Finds the small segments near a hole that are large enough for a large triangle.
/// @param[out] isSampled  1 per segment.
/// @return Whether there is any.
bool findSampledSegments(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats, bool* isSampled) {
  const Arena::Scope scope(scene.arena);
  auto* boxes = scene.arena.allocate<LoopBox>(stats.size());
  if (scene.arena.failed()) return false;
  std::fill(boxes, boxes + stats.size(), LoopBox{});
  for (std::uint32_t i = 0; i < data.points.count; ++i) {
    const std::uint32_t s = data.segments[i];
    if (!isSmall(stats[s])) continue;
    // The box takes in all that is as near to the point as the cage is: so also the cage above it.
    const auto around = static_cast<double>(data.distances[i]);
    for (const double side : {-around, around}) {
      boxes[s].grow(Vec3::from(data.points.at(i)) + Vec3{side, side, side});
    }
  }
  const BoundaryLoops& loops = scene.loops;
  bool isAny = false;
  for (std::uint32_t s = 0; s < stats.size(); ++s) {
    const auto isNear = [&](const LoopBox& loop) { return areWithin(scene.length(kNearHole), boxes[s], loop); };
    isSampled[s] = isSmall(stats[s]) && boxes[s].diagonal() >= scene.length(kLargeEdge) &&
                   std::any_of(loops.boxes, loops.boxes + loops.count, isNear);
    isAny = isAny || isSampled[s];
  }
  return isAny;
}

/// Finds the large triangles of some segments.
/// @return How many there are.
std::uint32_t findLargeTriangles(const Scene& scene, const PointData& data, const bool* isSampled,
                                 std::uint32_t* triangles) {
  const Points& points = data.points;
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < points.triangleCount; ++t) {
    if (!isSampled[data.segments[points.triangles[std::size_t{3} * t]]]) continue;
    triangles[count] = t;
    count += Corners(points, t).longestEdge() >= scene.length(kLargeEdge);
  }
  return count;
}

}  // namespace

void placeInteriorSamples(const Scene& scene, const PointData& data, const Array<SegmentStats>& stats,
                          InteriorSamples& out) noexcept {
  if (scene.loops.count == 0 || std::none_of(stats.begin(), stats.end(), isSmall)) return;
  Arena& arena = scene.arena;
  auto* triangles = arena.allocate<std::uint32_t>(data.points.triangleCount);
  std::uint32_t count = 0;
  {
    const Arena::Scope scope(arena);
    auto* isSampled = arena.allocate<bool>(stats.size());
    if (arena.failed()) return;
    if (findSampledSegments(scene, data, stats, isSampled)) {
      count = findLargeTriangles(scene, data, isSampled, triangles);
    }
  }
  arena.shrink(triangles, count);
  if (count == 0) return;

  auto* positions = arena.allocate<float>(std::size_t{4} * count * Points::kStride);
  auto* positionLow = arena.allocate<float>(std::size_t{4} * count * 3);
  if (arena.failed()) return;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = Corners(data.points, triangles[i]);
    const Vec3 sum = a + b + c;
    // The centroids of the four triangles between the corners and the middles of the edges.
    const Vec3 samples[4] = {1.0 / 6 * (sum + 3 * a), 1.0 / 6 * (sum + 3 * b), 1.0 / 6 * (sum + 3 * c), 1.0 / 3 * sum};
    for (std::size_t k = 0; k < 4; ++k)
      Points::split(samples[k], positions + (4 * i + k) * Points::kStride, positionLow + (4 * i + k) * 3);
  }
  Points points;
  points.count = 4 * count;
  points.positions = positions;
  points.positionLow = positionLow;
  out.triangleCount = count;
  out.triangles = triangles;
  out.data = PointData(points, scene.options, arena);
}

}  // namespace cagecast
