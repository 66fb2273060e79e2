#include "steps/motion/motion.hpp"

#include <algorithm>
#include <limits>

#include "base/tolerances.hpp"
#include "search/ray_search.hpp"
#include "steps/motion/posed.hpp"
#include "steps/normal_ray.hpp"
#include "steps/recheck/facing.hpp"
#include "steps/recheck/visibility_test.hpp"
#include "steps/typical_depth.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 13: a pose moves what it moves by more than this share of the diagonal.
constexpr double kMoves = 1e-4;
/// A point may lie deeper than is typical by this share of the diagonal of the box around what the pose moves.
constexpr double kMaxDeeperOfMoved = 0.05;

/// What is known of the points at rest, and becomes known in poses.
struct Known {
  PointData& data;
  const Array<SegmentStats>& stats;
  HiderRecords& records;

  /// Whether nothing hides an occluded point any more.
  [[nodiscard]] bool isFree(std::uint32_t p) const {
    return data.hiddenBy[p] == 0 ? data.recovery[p] == Recovery::always : records.isFree(data.hiddenBy[p]);
  }
};

/// The box around what a pose moves, at rest and in the pose.
struct MovedBox {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = -1 * low;

  MovedBox(const Scene& scene, std::span<const float> pose) noexcept {
    const std::span<const float> rest = scene.targetMesh.positions;
    const auto scale = static_cast<double>(scene.units.scale);
    const double least = scene.length(kMoves);
    for (std::size_t i = 0; i < pose.size(); i += 3) {
      if (pose[i] == rest[i] && pose[i + 1] == rest[i + 1] && pose[i + 2] == rest[i + 2]) continue;
      const Vec3 from = scale * Vec3::from(&rest[i]);
      const Vec3 to = scale * Vec3::from(&pose[i]);
      if (!(length(to - from) > least)) continue;
      add(from);
      add(to);
    }
  }
  [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
  [[nodiscard]] bool contains(Vec3 p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
  }
  [[nodiscard]] double diagonal() const { return length(high - low); }

 private:
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

/// Why an occluded point is looked at in a pose.
enum Reason : std::uint8_t {
  kNoReason = 0,
  kHidden = 1,  ///< It may be painted, if it is seen.
  kAtLoop = 2,  ///< It may explain a hole, if it is bare.
};

/// Finds the occluded points that are looked at in a pose.
/// @param[out] reasons  1 per point: a sum of `Reason`.
/// @return Whether there is any.
bool findReasons(const Scene& scene, const Known& known, const MovedBox& moved, std::uint8_t* reasons) {
  const auto& [data, stats, records] = known;
  const double deepest = scene.length(TypicalDepth(stats).mean()) + kMaxDeeperOfMoved * moved.diagonal();
  bool isAny = false;
  for (std::uint32_t p = 0; p < data.points.count; ++p) {
    reasons[p] = kNoReason;
    if (data.visibility[p] != Visibility::occluded || !moved.contains(data.points.exactly(p))) continue;
    const bool isHidden = stats[data.segments[p]].coveredArea > 0 &&
                          static_cast<double>(data.distances[p]) <= deepest && !known.isFree(p);
    const bool isAtLoop = scene.options.steps.holes && scene.loops.touches(data.cageTriangles[p]);
    reasons[p] = static_cast<std::uint8_t>((isHidden ? kHidden : kNoReason) | (isAtLoop ? kAtLoop : kNoReason));
    isAny = isAny || reasons[p] != kNoReason;
  }
  return isAny;
}

/// Tests points of a posed target.
class PoseTest {
 public:
  /// Allocates from the scene's arena.
  PoseTest(const Posed& posed, HiderRecords& records) noexcept
      : posed_(posed), records_(records), hits_(posed.points.segments, RaySearch::kMaxRays, posed.scene.arena) {}

  /// @param chosen      The points to test, ascending.
  /// @param[out] found  1 per point of the pose: the record of what hides it; 0 if it is not seen.
  void run(std::span<const std::uint32_t> chosen, std::size_t segmentCount, std::uint32_t* found) noexcept {
    Arena& arena = posed_.scene.arena;
    auto* left = arena.allocate<std::uint32_t>(chosen.size());
    if (arena.failed()) return;
    const std::uint32_t leftCount = sendNormalRays(chosen, found, left);
    if (leftCount > 0 && !arena.failed()) lookAround({left, leftCount}, segmentCount, found);
    if (hits_.failed() || records_.failed()) arena.fail();
  }

 private:
  /// @param[out] left  The points that their own segment hides.
  /// @return How many these are.
  std::uint32_t sendNormalRays(std::span<const std::uint32_t> chosen, std::uint32_t* found, std::uint32_t* left) {
    const Scene& scene = posed_.scene;
    const Arena::Scope scope(scene.arena);
    auto* rays = scene.arena.allocate<Ray>(RaySearch::kMaxRays);
    auto* hitsOwn = scene.arena.allocate<bool>(RaySearch::kMaxRays);
    RaySearch search(scene.targetTree, scene.length(kRayStart), scene.arena);
    if (scene.arena.failed()) return 0;
    std::uint32_t leftCount = 0;
    while (!chosen.empty()) {
      const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(RaySearch::kMaxRays, chosen.size()));
      for (std::uint32_t r = 0; r < count; ++r) {
        hits_.own[r] = posed_.points.segments[chosen[r]];
        setNormalRay(rays[r], posed_.points, scene.cage, chosen[r]);
      }
      search.search(rays, count, hitsOwn, hits_);
      for (std::uint32_t r = 0; r < count; ++r) {
        if (hitsOwn[r]) {
          left[leftCount++] = chosen[r];
        } else {
          found[chosen[r]] = records_.add(1, {&r, 1}, hits_);
        }
      }
      chosen = chosen.subspan(count);
    }
    return leftCount;
  }

  /// Sends the twelve rays of step 9.
  void lookAround(std::span<const std::uint32_t> left, std::size_t segmentCount, std::uint32_t* found) {
    const Scene& scene = posed_.scene;
    const PointData& points = posed_.points;
    auto* isChosen = scene.arena.allocate<bool>(segmentCount);
    auto* isOccluded = scene.arena.allocate<bool>(points.points.count);
    if (scene.arena.failed()) return;
    std::fill(isChosen, isChosen + segmentCount, false);
    for (const std::uint32_t p : left) isChosen[points.segments[p]] = true;
    for (std::uint32_t p = 0; p < points.points.count; ++p)
      isOccluded[p] = points.visibility[p] == Visibility::occluded;
    Facing facing;
    findFacing(scene, points, {isChosen, segmentCount}, isOccluded, facing);
    VisibilityTest test(scene, facing);
    if (scene.arena.failed()) return;
    const auto send = [&] {
      test.sendPastOthers(points.segments, hits_, [&](std::uint32_t p, std::span<const std::uint32_t> clear) {
        found[p] = records_.add(VisibilityTest::kEnough, clear, hits_);
      });
    };
    for (const std::uint32_t p : left) {
      if (!test.hasRoomForAll()) send();
      if (!facing.isTwoSided[p] && dot(facing.normals[p], facing.normals[p]) > 0)
        test.add(p, facing.isTurned[points.segments[p]], 0);
    }
    send();
  }

  const Posed& posed_;
  HiderRecords& records_;
  SegmentHits hits_;
};

/// Finds the points that are seen in one pose.
void findInPose(const Scene& scene, const Known& known, std::span<const float> pose) {
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  const auto& [data, stats, records] = known;
  const MovedBox moved(scene, pose);
  if (moved.empty()) return;
  auto* reasons = arena.allocate<std::uint8_t>(data.points.count);
  if (arena.failed() || !findReasons(scene, known, moved, reasons)) return;

  const Posed posed(scene, data, pose);
  if (posed.failed()) return;
  const std::uint32_t count = posed.scene.points.count;
  auto* isChosen = arena.allocate<bool>(count);
  auto* chosen = arena.allocate<std::uint32_t>(count);
  auto* found = arena.allocate<std::uint32_t>(count);
  PoseTest test(posed, records);
  if (arena.failed()) return;
  const std::size_t vertexCount = pose.size() / 3;
  std::fill(isChosen, isChosen + count, false);
  std::fill(found, found + count, 0u);
  for (std::size_t v = 0; v < vertexCount; ++v) {
    if (reasons[data.points.ofVertex[v]] != kNoReason) isChosen[posed.scene.points.ofVertex[v]] = true;
  }
  std::uint32_t chosenCount = 0;
  for (std::uint32_t p = 0; p < count; ++p) {
    chosen[chosenCount] = p;
    chosenCount += isChosen[p];
  }
  test.run({chosen, chosenCount}, stats.size(), found);
  if (arena.failed()) return;
  for (std::size_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t p = data.points.ofVertex[v];
    const std::uint32_t record = found[posed.scene.points.ofVertex[v]];
    if (record == 0) continue;
    const bool isFree = records.isFree(record);
    data.isBareInPose[p] = data.isBareInPose[p] || (isFree && (reasons[p] & kAtLoop) != 0);
    if ((reasons[p] & kHidden) == 0) continue;
    data.hiddenBy[p] = records.either(data.hiddenBy[p], record);
    if (data.cageDistances[p] < std::numeric_limits<double>::infinity()) data.recovery[p] = Recovery::always;
  }
}

}  // namespace

void findMotion(const Scene& scene, PointData& data, const Array<SegmentStats>& stats, HiderRecords& records) noexcept {
  if (scene.targetMesh.poses.empty()) return;
  data.isBareInPose = scene.arena.allocate<bool>(data.points.count);
  if (scene.arena.failed()) return;
  std::fill(data.isBareInPose, data.isBareInPose + data.points.count, false);
  const std::size_t size = scene.targetMesh.positions.size();
  for (std::span<const float> poses = scene.targetMesh.poses; !poses.empty() && !scene.arena.failed();
       poses = poses.subspan(size))
    findInPose(scene, {data, stats, records}, poses.first(size));
}

}  // namespace cagecast
