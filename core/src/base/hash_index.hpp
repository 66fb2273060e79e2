#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/arena.hpp"

namespace cagecast {

/// Finds which of many items are equal, in one pass: an open-addressed hash table of their indices.
class HashIndex {
 public:
  /// Allocates from `arena`; check `arena.failed()` afterwards.
  /// @param count  Most items that will be added.
  HashIndex(std::size_t count, Arena& arena) noexcept {
    const auto bits = static_cast<int>(std::bit_width(2 * count + 1));
    shift_ = 64 - bits;
    mask_ = (std::size_t{1} << bits) - 1;
    slots_ = arena.allocate<std::uint32_t>(mask_ + 1);
    if (slots_ == nullptr) return;
    for (std::size_t i = 0; i <= mask_; ++i) slots_[i] = kFree;
  }

  /// Finds the item that was added and is equal to this one; adds this one if there is none.
  /// @param index  Of this item.
  /// @param hash   Of this item.
  /// @param equal  Takes the index of another item, and tells whether it equals this one.
  /// @return The index of the first equal item, or its own.
  template <typename Equal>
  std::uint32_t firstEqual(std::uint32_t index, std::uint64_t hash, Equal equal) noexcept {
    auto slot = static_cast<std::size_t>(hash >> shift_);
    while (slots_[slot] != kFree && !equal(slots_[slot])) slot = (slot + 1) & mask_;
    if (slots_[slot] == kFree) slots_[slot] = index;
    return slots_[slot];
  }

  /// Hashes the bytes of a value without padding. The high bits depend on all of them.
  template <typename Thing>
  static std::uint64_t hash(const Thing& thing) noexcept {
    static_assert(std::is_trivially_copyable_v<Thing> && sizeof(Thing) % 4 == 0);
    std::uint32_t words[sizeof(Thing) / 4];
    std::memcpy(words, &thing, sizeof words);
    std::uint64_t all = 0;
    for (const std::uint32_t word : words) all = mix(all, word);
    return all;
  }
  /// Mixes another word into a hash.
  static std::uint64_t mix(std::uint64_t hash, std::uint64_t word) noexcept {
    hash ^= word;
    return (hash ^ hash >> 32) * 0x9E3779B97F4A7C15u;  // 2^64 / the golden ratio.
  }

 private:
  static constexpr std::uint32_t kFree = UINT32_MAX;
  int shift_;
  std::size_t mask_;
  std::uint32_t* slots_;
};

}  // namespace cagecast
