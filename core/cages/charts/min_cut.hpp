#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace cagecast::cages {

/// Splits nodes in two at the least cost (maximum flow by Dinic's algorithm, on whole numbers).
class MinCut {
 public:
  /// @param unit  Costs are rounded to multiples of this.
  MinCut(std::size_t nodes, double unit);

  /// What it costs if a node is on the first, or on the second side; `kForbidden` fixes it to the other.
  void addNode(std::uint32_t node, double first, double second);
  /// What it costs if the first node is on the first and the second on the second side, and the other way round.
  void addEdge(std::uint32_t a, std::uint32_t b, double cost, double costBack);
  void addEdge(std::uint32_t a, std::uint32_t b, double cost) { addEdge(a, b, cost, cost); }
  /// Whether each node is on the second side.
  [[nodiscard]] std::vector<bool> solve();

  /// More than all other costs together, however large the model is.
  static constexpr double kForbidden = std::numeric_limits<double>::infinity();

 private:
  struct Arc {
    std::uint32_t to;
    std::int64_t free;
  };
  double unit_;
  std::uint32_t source_, sink_;
  std::vector<Arc> arcs_;  ///< In pairs that are each other's opposites.
  std::vector<std::vector<std::uint32_t>> leaving_;
  std::vector<std::int32_t> level_;
  std::vector<std::size_t> next_;

  void addArc(std::uint32_t from, std::uint32_t to, double there, double back);
  bool findLevels();
  /// The next arc of a node that leads on to a higher level and is not full; `kNone` if there is none.
  std::uint32_t nextArc(std::uint32_t node);
  /// Sends as much as gets through along the levels.
  void push();
};

}  // namespace cagecast::cages
