#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 4′: what a small segment has less of, how near to a hole it must be, and what a big triangle
/// is; shares of the diagonal.
constexpr std::uint32_t kFewPoints = 32;
constexpr double kNearHole = 0.01;
constexpr double kBigEdge = 0.06;

bool meets(const BoundaryLoops::Box& box, const BoundaryLoops::Box& loop, double margin) {
  for (int k = 0; k < 3; ++k) {
    if (box.low[k] - margin > loop.high[k] || loop.low[k] > box.high[k] + margin) return false;
  }
  return true;
}

}  // namespace

bool findInteriorSamples(const Points& points, const BoundaryLoops& loops, const Units& units,
                         const PointResults& results, const Array<SegmentStats>& stats, const TransferOptions& options,
                         Arena& arena, InteriorSamples& out) noexcept {
  const auto isSmall = [](const SegmentStats& segment) { return segment.points < kFewPoints; };
  if (loops.count == 0 || std::none_of(stats.begin(), stats.end(), isSmall)) return true;
  const double margin = kNearHole * units.diagonal;
  const double bigEdge = kBigEdge * units.diagonal;
  const Arena::Mark mark = arena.mark();
  auto* boxes = arena.allocate<BoundaryLoops::Box>(stats.size());
  auto* mayVote = arena.allocate<bool>(stats.size());
  auto* triangles = arena.allocate<std::uint32_t>(points.triangleCount);
  if (arena.failed()) return false;

  std::fill(boxes, boxes + stats.size(), BoundaryLoops::Box{});
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t s = results.segments[i];
    if (!isSmall(stats[s])) continue;
    // All that is as near to the point as the cage is: with that, what lies over the point.
    const double around = options.steps.farLoops ? static_cast<double>(results.distances[i]) : 0;
    for (const double side : {-around, around}) boxes[s].grow(Vec3::from(points.at(i)) + Vec3{side, side, side});
  }
  // Small segments mostly have no room for a big edge, and then nobody has to look for one.
  bool anyMayVote = false;
  for (std::uint32_t s = 0; s < stats.size(); ++s) {
    const BoundaryLoops::Box& box = boxes[s];
    mayVote[s] = isSmall(stats[s]) && box.diagonal() >= bigEdge &&
                 std::any_of(loops.boxes, loops.boxes + loops.count,
                             [&](const BoundaryLoops::Box& loop) { return meets(box, loop, margin); });
    anyMayVote = anyMayVote || mayVote[s];
  }
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; anyMayVote && t < points.triangleCount; ++t) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * t;
    if (!mayVote[results.segments[corner[0]]]) continue;
    const Vec3 a = Vec3::from(points.at(corner[0]));
    const Vec3 b = Vec3::from(points.at(corner[1]));
    const Vec3 c = Vec3::from(points.at(corner[2]));
    triangles[count] = t;
    count += std::sqrt(std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)})) >= bigEdge;
  }
  if (count == 0) {
    arena.rewind(mark);
    return true;
  }
  arena.shrink(triangles, count);
  auto* positions = arena.allocate<float>(std::size_t{4} * count * Points::kStride);
  auto* rests = arena.allocate<float>(std::size_t{4} * count * 3);
  if (arena.failed()) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t* corner = points.triangles + std::size_t{3} * triangles[i];
    const Vec3 a = Vec3::from(points.at(corner[0]));
    const Vec3 b = Vec3::from(points.at(corner[1]));
    const Vec3 c = Vec3::from(points.at(corner[2]));
    const Vec3 sum = a + b + c;
    const Vec3 centroids[4] = {1.0 / 6 * (sum + 3 * a), 1.0 / 6 * (sum + 3 * b), 1.0 / 6 * (sum + 3 * c),
                               1.0 / 3 * sum};
    for (std::size_t k = 0; k < 4; ++k)
      Points::split(centroids[k], positions + (4 * i + k) * Points::kStride, rests + (4 * i + k) * 3);
  }
  out.count = count;
  out.triangles = triangles;
  out.points.count = 4 * count;
  out.points.positions = positions;
  out.points.rests = rests;
  return true;
}

}  // namespace cagecast
