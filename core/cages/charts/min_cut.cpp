#include "charts/min_cut.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

namespace {

/// More than the sum of all costs can be.
constexpr std::int64_t kMax = std::int64_t{1} << 50;

}  // namespace

MinCut::MinCut(std::size_t nodes, double unit)
    : unit_(unit),
      source_(static_cast<std::uint32_t>(nodes)),
      sink_(static_cast<std::uint32_t>(nodes) + 1),
      leaving_(nodes + 2) {}

void MinCut::addArc(std::uint32_t from, std::uint32_t to, double there, double back) {
  const auto whole = [&](double cost) {
    return cost / unit_ < static_cast<double>(kMax) ? static_cast<std::int64_t>(std::llround(cost / unit_)) : kMax;
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

std::uint32_t MinCut::nextArc(std::uint32_t node) {
  for (std::size_t& i = next_[node]; i < leaving_[node].size(); ++i) {
    const Arc& arc = arcs_[leaving_[node][i]];
    if (arc.free > 0 && level_[arc.to] == level_[node] + 1) return leaving_[node][i];
  }
  return kNone;
}

void MinCut::push() {
  struct Step {
    std::uint32_t node, arc;    // And the arc to it.
    std::int64_t most, pushed;  // What may go through it, and what does.
  };
  // Not a recursion: a ribbon has as many levels as triangles, too many for the stack of a browser.
  std::vector<Step> way = {{source_, kNone, kMax, 0}};
  while (true) {
    const Step here = way.back();
    if (const std::uint32_t arc = here.pushed < here.most ? nextArc(here.node) : kNone; arc != kNone) {
      const std::int64_t most = std::min(here.most - here.pushed, arcs_[arc].free);
      way.push_back({arcs_[arc].to, arc, most, arcs_[arc].to == sink_ ? most : 0});
      continue;
    }
    way.pop_back();
    if (way.empty()) return;
    arcs_[here.arc].free -= here.pushed;
    arcs_[here.arc ^ 1].free += here.pushed;
    way.back().pushed += here.pushed;
    if (way.back().pushed < way.back().most) ++next_[way.back().node];
  }
}

std::vector<bool> MinCut::solve() {
  while (findLevels()) {
    next_.assign(leaving_.size(), 0);
    push();
  }
  std::vector<bool> second(source_);
  for (std::size_t node = 0; node < second.size(); ++node) second[node] = level_[node] < 0;
  return second;
}

}  // namespace cagecast::cages
