#include "charts/min_cut.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast::cages {

namespace {

/// More than the sum of all costs can be.
constexpr std::int64_t kMost = std::int64_t{1} << 50;

}  // namespace

MinCut::MinCut(std::size_t nodes, double unit)
    : unit_(unit),
      source_(static_cast<std::uint32_t>(nodes)),
      sink_(static_cast<std::uint32_t>(nodes) + 1),
      leaving_(nodes + 2) {}

void MinCut::addArc(std::uint32_t from, std::uint32_t to, double there, double back) {
  const auto whole = [&](double cost) {
    return cost / unit_ < static_cast<double>(kMost) ? static_cast<std::int64_t>(std::llround(cost / unit_)) : kMost;
  };
  leaving_[from].push_back(static_cast<std::uint32_t>(arcs_.size()));
  arcs_.push_back({to, whole(there)});
  leaving_[to].push_back(static_cast<std::uint32_t>(arcs_.size()));
  arcs_.push_back({from, whole(back)});
}

void MinCut::addNode(std::uint32_t node, double first, double second) {
  // What is reached from the source is on the first side, so that the arc to the sink is cut then.
  if (second > 0) addArc(source_, node, second, 0);
  if (first > 0) addArc(node, sink_, first, 0);
}

void MinCut::addEdge(std::uint32_t a, std::uint32_t b, double cost, double costBack) { addArc(a, b, cost, costBack); }

bool MinCut::findLevels() {
  level_.assign(leaving_.size(), -1);
  std::vector<std::uint32_t> queue{source_};
  level_[source_] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i)
    for (const std::uint32_t arc : leaving_[queue[i]]) {
      const std::uint32_t to = arcs_[arc].to;
      if (arcs_[arc].free <= 0 || level_[to] >= 0) continue;
      level_[to] = level_[queue[i]] + 1;
      queue.push_back(to);
    }
  return level_[sink_] >= 0;
}

std::int64_t MinCut::push(std::uint32_t node, std::int64_t most) {
  if (node == sink_) return most;
  std::int64_t pushed = 0;
  for (std::size_t& i = next_[node]; i < leaving_[node].size(); ++i) {
    const std::uint32_t arc = leaving_[node][i];
    const std::uint32_t to = arcs_[arc].to;
    if (arcs_[arc].free <= 0 || level_[to] != level_[node] + 1) continue;
    const std::int64_t flow = push(to, std::min(most - pushed, arcs_[arc].free));
    arcs_[arc].free -= flow;
    arcs_[arc ^ 1].free += flow;
    pushed += flow;
    if (pushed == most) break;
  }
  return pushed;
}

std::vector<bool> MinCut::solve() {
  while (findLevels()) {
    next_.assign(leaving_.size(), 0);
    push(source_, kMost);
  }
  std::vector<bool> second(source_);
  for (std::size_t node = 0; node < second.size(); ++node) second[node] = level_[node] < 0;
  return second;
}

}  // namespace cagecast::cages
