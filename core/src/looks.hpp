#pragma once

#include <cstdint>

#include "atlas.hpp"
#include "rims.hpp"
#include "steps.hpp"

/// docs/method.md, step 10: what borders run between.
namespace cagecast {

/// What is known of a place of the target.
struct Look {
  std::uint32_t side;   ///< Between places on two sides runs a border. Of rims: 1 beyond one, else 0. Of seams: the island.
  std::uint32_t cell;   ///< What of the cage it is nearest to: a triangle, an open edge, an end of open edges.
  Landing landing;
};

/// Looks at single places of the target, in double.
class Looker {
 public:
  /// Takes what it needs from `scratch`; `scratch.failed()` tells if that was there.
  /// @param atlas  To look for seams of the texture; null to look for rims.
  Looker(const MeshView& mesh, const Cage& cage, const CageTree& tree, const Rims& rims, const Atlas* atlas, const Units& units,
         Scratch& scratch) noexcept;

  /// @param p  Scaled.
  Look at(Vec3 p) noexcept {
    Look look;
    at(&p, 1, &look);
    return look;
  }

  /// The most places that can be looked at at once: quicker, if they are neighbours.
  static constexpr std::uint32_t kMost = NearestSearch::kGroup;
  /// @param places  `count` of them, scaled.
  void at(const Vec3* places, std::uint32_t count, Look* looks) noexcept;

  /// So far around a place that was looked at no other is nearest to one of the cage's rims, or seams.
  [[nodiscard]] double clearance(const Look& look, Vec3 p) const noexcept;

  /// Whether a border runs between two places, so far apart.
  [[nodiscard]] bool isBetween(const Look& a, const Look& b, double apart) const noexcept {
    return atlas_ == nullptr ? a.side != b.side : atlas_->tears(a.landing, b.landing, apart);
  }

 private:
  [[nodiscard]] const std::uint32_t* cornersOf(std::uint32_t slot) const noexcept {
    return mesh_.indices.data() + std::size_t{3} * cage_.triangles[slot].index;
  }

  [[nodiscard]] Look judge(const Candidate& nearest) const noexcept;

  /// A rim or a seam between two corners of the cage.
  struct Line {
    Vec3 from, along;
    double inverseSquare;
    [[nodiscard]] double squaredDistance(Vec3 p) const noexcept;
  };

  const MeshView& mesh_;
  const Cage& cage_;
  const Rims& rims_;
  const Atlas* atlas_;
  double diagonal_;
  NearestSearch search_;
  std::uint32_t* found_;
  Candidate* candidates_;
  const Line* lines_;
  std::size_t lineCount_ = 0;
  double* clearances_;  ///< Of seams, 1 per vertex of the cage: its distance to the nearest.
};

}  // namespace cagecast
