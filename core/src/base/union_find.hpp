#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cagecast {

/// Disjoint sets over an array of parents; the root of a set is its lowest member.
class UnionFind {
 public:
  /// @param parents  `count` entries, owned by the caller.
  UnionFind(std::uint32_t* parents, std::uint32_t count) noexcept : parents_(parents) {
    for (std::uint32_t i = 0; i < count; ++i) parents_[i] = i;
  }
  /// Not inlined: most calls of `join` return before they need it.
  [[gnu::noinline]] std::uint32_t find(std::uint32_t i) noexcept {
    std::uint32_t parent = parents_[i];
    for (;;) {
      const std::uint32_t next = parents_[parent];
      if (next == parent) return parent;
      parents_[i] = next;
      i = parent;
      parent = next;
    }
  }
  void join(std::uint32_t a, std::uint32_t b) noexcept {
    if (parents_[a] == parents_[b]) return;
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }
  /// Joins several at once, without a branch on whether they are joined already, which is unpredictable.
  template <std::size_t n>
  void join(const std::uint32_t (&members)[n]) noexcept {
    std::uint32_t roots[n];
    for (std::size_t i = 0; i < n; ++i) {
      roots[i] = parents_[members[i]];
      if (parents_[roots[i]] != roots[i]) [[unlikely]]
        roots[i] = find(roots[i]);
    }
    const std::uint32_t root = *std::min_element(roots, roots + n);
    for (std::size_t i = 0; i < n; ++i) parents_[roots[i]] = parents_[members[i]] = root;
  }
  /// Makes every parent a root, after the last join.
  void flatten(std::uint32_t count) noexcept {
    // A parent comes before its children, so it points to a root already.
    for (std::uint32_t i = 0; i < count; ++i) parents_[i] = parents_[parents_[i]];
  }

 private:
  std::uint32_t* parents_;
};

}  // namespace cagecast
