#pragma once

#include <cstdint>

#include "search/ray_search.hpp"
#include "steps/recheck/facing.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Tests many points at once for whether they can be seen from the cage: by rays over the hemisphere on the side that a
/// point faces to. A ray is clear if it passes the target and meets the cage; a point with two clear rays is seen.
class VisibilityTest {
 public:
  /// Allocates from the scene's arena.
  VisibilityTest(const Scene& scene, const Facing& facing) noexcept;

  [[nodiscard]] bool isIdle() const noexcept { return count_ == 0; }
  /// Whether another point can be added, even a two-sided one.
  [[nodiscard]] bool hasRoom() const noexcept { return count_ + 2 <= kMaxTests; }

  /// Adds a point. It must have a normal, and there must be room.
  /// @param isTurned  Whether it faces against its normal.
  void add(std::uint32_t point, bool isTurned) noexcept;

  /// Sends some more rays from the points added, and drops those that this decides.
  /// @param onSeen  Takes a point that is seen.
  template <typename OnSeen>
  void advance(OnSeen onSeen) noexcept {
    sendRays();
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const Test& test = tests_[i];
      const bool isSeen = test.clear >= kEnough;
      if (isSeen) onSeen(test.point);
      const bool isDecided = isSeen || test.clear + kDirectionCount - test.sent < kEnough;
      tests_[left] = test;
      left += !isDecided;
    }
    count_ = left;
  }

 private:
  static constexpr unsigned kDirectionCount = 12;
  /// docs/method.md, step 9: so many clear rays are enough.
  static constexpr unsigned kEnough = 2;
  /// A point sends this many rays first, then, while it is undecided, up to the next of these. Fewer at a time would
  /// need fewer rays, but many rays that begin close together are faster than few.
  static constexpr unsigned kStages[] = {5, kDirectionCount - 1, kDirectionCount};
  static constexpr std::uint32_t kMaxTests = RaySearch::kMaxRays / kStages[0];

  /// A point on one of its sides.
  struct Test {
    std::uint32_t point;
    bool isTurned;
    std::uint8_t sent;   ///< Rays sent so far.
    std::uint8_t clear;  ///< Those that are clear.
  };

  void sendRays() noexcept;
  /// Makes the next rays of a test.
  void setRays(Test& test, unsigned more, std::uint32_t firstRay) noexcept;

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
};

}  // namespace cagecast
