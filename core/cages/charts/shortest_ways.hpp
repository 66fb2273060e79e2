#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace cagecast::cages {

inline constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Finds the shortest ways from some nodes to all others (Dijkstra 1959).
/// @param[in,out] distance  Of each node: 0 for the starts, `kUnreached` for others.
/// @param neighbours  Calls `offer(neighbour, length)` for each neighbour of a node; that returns whether this is the
///   shortest way to it so far.
template <typename Neighbours>
void findShortestWays(std::span<const std::uint32_t> starts, std::vector<double>& distance,
                      const Neighbours& neighbours) {
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t start : starts) queue.emplace(0.0, start);
  while (!queue.empty()) {
    const auto [soFar, node] = queue.top();
    queue.pop();
    if (soFar > distance[node]) continue;
    neighbours(node, [&, from = soFar](std::uint32_t to, double length) {
      if (from + length >= distance[to]) return false;
      queue.emplace(distance[to] = from + length, to);
      return true;
    });
  }
}

}  // namespace cagecast::cages
