#pragma once

#include <cstddef>

#include "cage/boundary_loops.hpp"
#include "search/kd_tree.hpp"

namespace cagecast {

/// The open edges of the cage.
class BoundaryLines {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  BoundaryLines(const Cage& cage, const CageTree& tree, const BoundaryLoops& loops, Arena& arena) noexcept;

  /// How far a place is from the nearest; infinity if there is none.
  /// Cost: a look at a box for every `kRun` lines, and at some lines.
  [[nodiscard]] double distance(Vec3 p) const noexcept;

 private:
  /// So many lines that are neighbours have a box around them.
  static constexpr std::size_t kRun = 64;
  struct Line {
    Vec3 from, along;
  };

  Line* lines_;
  BoundaryLoops::Box* boxes_;
  std::size_t count_ = 0;
};

}  // namespace cagecast
