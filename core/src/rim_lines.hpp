#pragma once

#include <cstddef>

#include "kd_tree.hpp"
#include "rims.hpp"

namespace cagecast {

/// The open edges of the cage.
class RimLines {
 public:
  /// Takes what it needs from `scratch`; `scratch.failed()` tells if that was there.
  RimLines(const Cage& cage, const CageTree& tree, const Rims& rims, Scratch& scratch) noexcept;

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
  Rims::Box* boxes_;
  std::size_t count_ = 0;
};

}  // namespace cagecast
