#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "search/ray_search.hpp"
#include "steps/recheck/facing.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Tests many points at once for whether they can be seen from the cage: by rays over the hemisphere on the side that a
/// point faces to. A ray is clear if it passes the target and meets the cage; a point with two clear rays is seen.
class VisibilityTest {
 public:
  /// docs/method.md, step 9: so many clear rays are enough.
  static constexpr unsigned kEnough = 2;

  /// Allocates from the scene's arena.
  VisibilityTest(const Scene& scene, const Facing& facing) noexcept;

  [[nodiscard]] bool isIdle() const noexcept { return count_ == 0; }
  /// Whether another point can be added, even a two-sided one.
  [[nodiscard]] bool hasRoom() const noexcept { return count_ + 2 <= kMaxTests; }

  /// Adds a point. It must have a normal, and there must be room.
  /// @param isTurned  Whether it faces against its normal.
  void add(std::uint32_t point, bool isTurned) noexcept;

  /// Whether another point can be added for `sendPastOthers`.
  [[nodiscard]] bool hasRoomForAll() const noexcept { return (count_ + 1) * kDirectionCount <= RaySearch::kMaxRays; }
  /// Adds a point for `sendPastOthers`, which is not two-sided.
  /// @param blocked  As `advance` has it.
  void add(std::uint32_t point, bool isTurned, std::uint16_t blocked) noexcept {
    if (mightPass(blocked)) tests_[count_++] = {point, isTurned, 0, 0, blocked};
  }

  /// Sends the rays that might pass past all segments but their own, and drops all points.
  /// @param segments  1 per point.
  /// @param hits      What each ray hits.
  /// @param onSeen    Takes a point with enough rays that are clear but for other segments, and these rays.
  template <typename OnSeen>
  void sendPastOthers(const std::uint32_t* segments, SegmentHits& hits, OnSeen onSeen) noexcept {
    const std::uint32_t clearCount = listClear(segments, hits);
    for (std::uint32_t first = 0, next = 0; first < clearCount; first = next) {
      while (next < clearCount && testOfRay_[next] == testOfRay_[first]) ++next;
      if (next - first >= kEnough) onSeen(tests_[testOfRay_[first]].point, {clear_ + first, clear_ + next});
    }
    count_ = 0;
  }

  /// Sends some more rays from the points added, and drops those that this decides.
  /// @param segments   1 per point.
  /// @param onSeen     Takes a point that is seen.
  /// @param onUnseen   Takes a point that is not seen, and a bit for each of its rays that surely hits its own segment
  /// or
  ///                   misses the cage.
  template <typename OnSeen, typename OnUnseen>
  void advance(const std::uint32_t* segments, OnSeen onSeen, OnUnseen onUnseen) noexcept {
    sendRays(segments);
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const Test& test = tests_[i];
      const bool isSeen = test.clear >= kEnough;
      const bool isDecided = isSeen || test.clear + kDirectionCount - test.sent < kEnough;
      if (isSeen) onSeen(test.point);
      if (isDecided && !isSeen) onUnseen(test.point, test.blocked);
      tests_[left] = test;
      left += !isDecided;
    }
    count_ = left;
  }

 private:
  static constexpr unsigned kDirectionCount = 12;
  /// A point sends this many rays first, then, while it is undecided, up to the next of these. Fewer at a time would
  /// need fewer rays, but many rays that begin close together are faster than few.
  static constexpr unsigned kStages[] = {5, kDirectionCount - 1, kDirectionCount};
  static constexpr std::uint32_t kMaxTests = RaySearch::kMaxRays / kStages[0];

  /// A point on one of its sides.
  struct Test {
    std::uint32_t point;
    bool isTurned;
    std::uint8_t sent;      ///< Rays sent so far.
    std::uint8_t clear;     ///< Those that are clear.
    std::uint16_t blocked;  ///< A bit for each ray that surely hits its own segment, or misses the cage.
  };

  /// Whether enough rays of a point might pass, given those that do not.
  [[nodiscard]] static bool mightPass(unsigned blocked) noexcept {
    return kDirectionCount - static_cast<unsigned>(std::popcount(blocked)) >= kEnough;
  }
  /// Notes that a ray does not pass.
  void block(std::uint32_t ray) noexcept;
  void sendRays(const std::uint32_t* segments) noexcept;
  /// Lists in `clear_` the rays that pass their own segment and meet the cage, in order, and their tests in
  /// `testOfRay_`.
  /// @return How many there are.
  std::uint32_t listClear(const std::uint32_t* segments, SegmentHits& hits) noexcept;
  /// Makes the next rays of a test, but for those that are blocked.
  /// @return How many there are.
  std::uint32_t setRays(std::uint32_t test, unsigned more, std::uint32_t firstRay) noexcept;

  Points points_;
  const Facing& facing_;
  double lift_;
  RaySearch pastTarget_;
  RaySearch toCage_;
  Test* tests_;
  std::uint32_t count_ = 0;
  RayDirection* directions_;  ///< 1 per ray.
  Ray* rays_;
  std::uint16_t* testOfRay_;
  bool* hit_;
  std::uint8_t* numbers_;  ///< 1 per ray: its number among those of its point.
  std::uint32_t* hitsAt_;  ///< 1 per ray.
  std::uint32_t* clear_;
};

}  // namespace cagecast
