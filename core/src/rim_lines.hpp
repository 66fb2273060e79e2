#pragma once

#include <cstddef>

#include "atlas.hpp"
#include "rims.hpp"

namespace cagecast {

/// The edges of the cage's triangles along which rims run, or seams.
class RimLines {
 public:
  /// Takes what it needs from `scratch`; `scratch.failed()` tells if that was there.
  /// @param atlas  For seams, rims among them; null for rims alone.
  RimLines(const Cage& cage, const CageTree& tree, const Rims& rims, const Atlas* atlas, Scratch& scratch) noexcept;

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
