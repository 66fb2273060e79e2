#pragma once

#include <cstddef>

#include "cage/boundary_loops.hpp"
#include "search/cage_tree.hpp"

namespace cagecast {

/// The open edges of the cage, to find distances to them.
class BoundaryLines {
 public:
  /// Allocates its memory from `arena`; check `arena.failed()` afterwards.
  BoundaryLines(const Cage& cage, const CageTree& tree, const BoundaryLoops& loops, Arena& arena) noexcept;

  /// The distance from a point to the nearest open edge; infinity if there is none.
  /// Cost: one box test for every `kRun` edges, and one distance for some of the edges.
  [[nodiscard]] double distance(Vec3 p) const noexcept;

 private:
  /// So many successive edges, which are close to each other, share a bounding box.
  static constexpr std::size_t kRun = 64;
  struct Line {
    Vec3 from, along;
  };

  Line* lines_;
  BoundaryLoops::Box* boxes_;
  std::size_t count_ = 0;
};

}  // namespace cagecast
