#pragma once

#include <cstdint>
#include <span>

#include "base/list.hpp"
#include "search/segment_hits.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// Writes the records of `Hiders`.
class HiderRecords {
 public:
  /// Allocates from `arena`; check `arena.failed()` afterwards.
  explicit HiderRecords(Arena& arena) noexcept;

  /// Adds a record, or finds an equal one among those of late: neighbours are mostly hidden by the same.
  /// @param enough  How many of the rays are enough.
  /// @param rays    Their numbers in `hits`; at most `kMaxRays`.
  /// @return Where it begins.
  std::uint32_t add(std::uint32_t enough, std::span<const std::uint32_t> rays, const SegmentHits& hits) noexcept;

  /// A record that is free if one of two is; one of them if that is enough.
  /// @param earlier  0: none.
  /// @param record   Of `add`.
  std::uint32_t either(std::uint32_t earlier, std::uint32_t record) noexcept;
  /// Whether a record needs no segment to be culled: nothing hides its point.
  [[nodiscard]] bool isFree(std::size_t record) const noexcept;

  /// As many as step 9 sends from a point.
  static constexpr std::size_t kMaxRays = 12;

  [[nodiscard]] bool failed() const noexcept { return words_.failed(); }
  /// Whether there is no record.
  [[nodiscard]] bool empty() const noexcept { return words_.size() <= 1; }
  /// @return false if memory ran out.
  [[nodiscard]] bool copyTo(Array<std::uint32_t>& out) const noexcept { return words_.copyTo(out); }

 private:
  static constexpr std::size_t kSlots = 1024;
  /// What comes before the rays of a record: another record, how many are enough, how many there are.
  static constexpr std::size_t kHead = 3;

  /// The record that was added last, or an equal one among those of late.
  std::uint32_t shared(std::size_t start) noexcept;
  [[nodiscard]] std::size_t endOf(std::size_t record) const noexcept;

  /// Whether what one ray hits is hit by another as well. Both are given by their places in `words_`.
  [[nodiscard]] bool isWithin(std::size_t one, std::size_t other) const noexcept;

  List<std::uint32_t> words_;
  std::uint32_t* recent_;  ///< `kSlots`: where records of late begin, by their hash.
};

/// Step 9: finds the occluded points that other segments alone hide, of segments with covered area: `data.hiddenBy`
/// gets their records, and `data.recovery` is `always` if their rays meet the cage.
void findHiders(const Scene& scene, PointData& data, const Array<SegmentStats>& stats, HiderRecords& records) noexcept;

}  // namespace cagecast
