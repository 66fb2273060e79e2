#pragma once

#include <span>

#include "cagecast/result.hpp"

namespace cagecast {

/// How deep under the cage what is to be painted lies, in diagonals of the target (docs/method.md, steps 8 and 9).
struct TypicalDepth {
  double covered = 0;  ///< K: the covered area of all segments.
  double depth = 0;    ///< The sum of covered area times depth.

  explicit TypicalDepth(std::span<const SegmentStats> stats) noexcept {
    for (const SegmentStats& s : stats) {
      covered += s.coveredArea;
      depth += s.coveredArea * s.depth;
    }
  }
  /// What lies deeper is meant to lie inside: teeth, tongues and what surrounds them.
  [[nodiscard]] double most() const noexcept { return mean() + kMaxDeeper; }
  [[nodiscard]] double mean() const noexcept { return depth / covered; }

 private:
  static constexpr double kMaxDeeper = 0.015;
};

}  // namespace cagecast
