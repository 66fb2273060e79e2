#pragma once

#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"
#include "input/weld.hpp"

namespace cagecast {

/// Points on the target, and what the steps find out about them. They are the welded vertices, or the interior samples
/// of step 7. Every array has one entry per point; lengths are scaled.
struct PointData {
  PointData() noexcept = default;
  /// Allocates what steps 1 to 4 write.
  PointData(const Points& at, const TransferOptions& options, Arena& arena) noexcept
      : points(at),
        uvs(arena.allocate<float>(std::size_t{2} * at.count)),
        distances(arena.allocate<float>(at.count)),
        cageTriangles(arena.allocate<std::uint32_t>(at.count)),
        visibility(arena.allocate<Visibility>(at.count)),
        meetsCage(arena.allocate<bool>(at.count)),
        segments(arena.allocate<std::uint32_t>(at.count)) {
    if (options.steps.recheck) occluders = arena.allocate<std::uint32_t>(at.count);
    if (std::isfinite(options.occlusionReach) || options.steps.recheck || options.steps.holes)
      cageDistances = arena.allocate<double>(at.count);
  }

  Points points;

  // Of steps 1 to 3:
  float* uvs = nullptr;                    ///< 2 per point.
  float* distances = nullptr;              ///< To the closest point of the cage.
  std::uint32_t* cageTriangles = nullptr;  ///< The triangle of that point, in `Cage::triangles`.
  Visibility* visibility = nullptr;
  bool* meetsCage = nullptr;  ///< Whether the ray of step 3 hits the cage; false if step 1 left that open.
  double* cageDistances =
      nullptr;  ///< How far along its ray the cage is; infinity: nowhere. With steps 6, 9 and 10, else null.
  std::uint32_t* occluders =
      nullptr;  ///< For occluded points: a corner of a triangle that hides it. With step 9, else null.

  // Of steps 4 and 7:
  std::uint32_t* segments = nullptr;
  std::int64_t* areas = nullptr;           ///< A third of each triangle at the point, in an `AreaUnit`.
  std::int64_t* unsampledAreas = nullptr;  ///< The same without the triangles that have interior samples.

  /// Of steps 9 and 10: values of `Recovery`. Null if there is neither.
  std::uint32_t* recovery = nullptr;
  /// Of step 9: values of `Hiders::ofVertex`. Null without it.
  std::uint32_t* hiddenBy = nullptr;
  /// Of step 13: whether an occluded point at a boundary loop is bare in a pose. Null without poses.
  bool* isBareInPose = nullptr;
};

}  // namespace cagecast
