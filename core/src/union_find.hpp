#pragma once

#include <cstdint>

namespace cagecast {

/// Disjoint sets over an array of parents; the root of a set is its lowest member.
class UnionFind {
 public:
  /// @param parents  `count` entries, owned by the caller.
  UnionFind(std::uint32_t* parents, std::uint32_t count) noexcept : parents_(parents) {
    for (std::uint32_t i = 0; i < count; ++i) parents_[i] = i;
  }
  std::uint32_t find(std::uint32_t i) noexcept {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) noexcept {
    if (parents_[a] == parents_[b]) return;
    a = find(a);
    b = find(b);
    if (a < b) parents_[b] = a;
    if (b < a) parents_[a] = b;
  }
  /// Makes every parent a root, once all is joined.
  void flatten(std::uint32_t count) noexcept {
    // A parent comes before its children, so it points to a root already.
    for (std::uint32_t i = 0; i < count; ++i) parents_[i] = parents_[parents_[i]];
  }

 private:
  std::uint32_t* parents_;
};

}  // namespace cagecast
