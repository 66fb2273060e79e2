#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/union_find.hpp"

namespace cagecast::cages {

/// Disjoint sets of the numbers below a count, each alone at first; the root of a set is its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count)
      : parents_(count), sets_(parents_.data(), static_cast<std::uint32_t>(count)) {}
  DisjointSets(const DisjointSets&) = delete;
  DisjointSets& operator=(const DisjointSets&) = delete;

  [[nodiscard]] std::uint32_t find(std::uint32_t i) { return sets_.find(i); }
  void join(std::uint32_t a, std::uint32_t b) { sets_.join(a, b); }

  /// The number of each member's set; sets are numbered in the order of their first members.
  std::vector<std::uint32_t> numbers(std::uint32_t& count) {
    std::vector<std::uint32_t> out(parents_.size());
    count = 0;
    for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = find(i) == i ? count++ : out[find(i)];
    return out;
  }

 private:
  std::vector<std::uint32_t> parents_;
  UnionFind sets_;
};

}  // namespace cagecast::cages
