#include "clip/boundary_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cagecast {

BoundaryLines::BoundaryLines(const Cage& cage, const CageTree& tree, const BoundaryLoops& loops, Arena& arena) noexcept
    : lines_(arena.allocate<Line>(std::size_t{3} * cage.count)),
      boxes_(arena.allocate<BoundaryLoops::Box>(std::size_t{3} * cage.count / kRun + 1)) {
  if (arena.failed()) return;
  for (std::uint32_t i = 0; i < 3 * cage.count; ++i) {
    // Successive leaves of the tree are close to each other in space.
    const std::uint32_t cageTriangle = tree.leaves[i / 12].cageTriangles[i / 3 % 4], k = i % 3;
    if (loops.loopOf[std::size_t{6} * cageTriangle + k] == BoundaryLoops::kNone) continue;
    const CageTriangle& t = cage.triangles[cageTriangle];
    const float* corners[3] = {t.a, t.b, t.c};
    const Vec3 from = Vec3::from(corners[k]), to = Vec3::from(corners[(k + 1) % 3]);
    BoundaryLoops::Box& box = boxes_[count_ / kRun];
    if (count_ % kRun == 0) box = {};
    box.grow(from);
    box.grow(to);
    lines_[count_++] = {from, to - from};
  }
}

double BoundaryLines::distance(Vec3 p) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  const double at[3] = {p.x, p.y, p.z};
  for (std::size_t i = 0; i < count_; ++i) {
    if (i % kRun == 0) {
      const BoundaryLoops::Box& box = boxes_[i / kRun];
      double toBox = 0;
      for (int k = 0; k < 3; ++k) {
        const double outside = at[k] - std::clamp(at[k], box.low[k], box.high[k]);
        toBox += outside * outside;
      }
      if (toBox >= least) {
        i += kRun - 1;
        continue;
      }
    }
    const auto& [from, along] = lines_[i];
    const Vec3 offset = p - from;
    const double t = std::clamp(dot(offset, along) * (1 / dot(along, along)), 0.0, 1.0);
    const Vec3 away = offset - t * along;
    least = std::min(least, dot(away, away));
  }
  return std::sqrt(least);
}

}  // namespace cagecast
