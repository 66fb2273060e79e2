#pragma once

#include <algorithm>
#include <cstdint>

#include "base/arena.hpp"
#include "base/list.hpp"

namespace cagecast {

/// The segments of the target that rays hit, besides their own: a list for each ray.
class SegmentHits {
 public:
  /// Allocates from `arena`; check `arena.failed()` afterwards, and `failed()` after a search.
  /// @param segments  1 per point of the tree.
  /// @param maxRays   The most rays of a search.
  SegmentHits(const std::uint32_t* segments, std::uint32_t maxRays, Arena& arena) noexcept
      : own(arena.allocate<std::uint32_t>(maxRays)),
        segments_(segments),
        firsts_(arena.allocate<std::uint32_t>(maxRays)) {}

  std::uint32_t* own;  ///< 1 per ray: the segment that it starts from.

  [[nodiscard]] std::uint32_t segmentOf(std::uint32_t point) const noexcept { return segments_[point]; }
  [[nodiscard]] bool failed() const noexcept { return hits_.failed(); }

  /// Forgets everything.
  void restart(std::uint32_t rayCount) noexcept {
    std::fill(firsts_, firsts_ + rayCount, kNone);
    hits_.truncate(0);
  }
  void add(std::size_t ray, std::uint32_t segment) noexcept {
    const auto at = static_cast<std::uint32_t>(hits_.size());
    hits_.add({segment, firsts_[ray]});
    if (!hits_.failed()) firsts_[ray] = at;
  }
  [[nodiscard]] bool has(std::size_t ray, std::uint32_t segment) const noexcept {
    for (std::uint32_t i = firsts_[ray]; i != kNone; i = hits_[i].next) {
      if (hits_[i].segment == segment) return true;
    }
    return false;
  }
  /// @param call  Takes each segment that a ray hits.
  template <typename Call>
  void each(std::size_t ray, Call call) const noexcept {
    for (std::uint32_t i = firsts_[ray]; i != kNone; i = hits_[i].next) call(hits_[i].segment);
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Hit {
    std::uint32_t segment;
    std::uint32_t next;  ///< Of the same ray; `kNone`: it is the last one.
  };

  const std::uint32_t* segments_;
  std::uint32_t* firsts_;  ///< 1 per ray.
  List<Hit> hits_;
};

}  // namespace cagecast
