#pragma once

#include <cstdint>
#include <span>

#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// The target in a pose, under the same cage. Its points are welded anew, as vertices that lie together at rest may
/// part.
struct Posed {
  /// Allocates from the arena of `rest`; check `failed()` afterwards.
  /// @param data       The points at rest, after step 4.
  /// @param positions  Of the pose, 3 per vertex.
  Posed(const Scene& rest, const PointData& data, std::span<const float> positions) noexcept;

  Posed(const Posed&) = delete;  // The scene refers to the mesh.
  Posed& operator=(const Posed&) = delete;

  [[nodiscard]] bool failed() const noexcept { return scene.arena.failed(); }

  /// The target's mesh. Its groups are the segments at rest: what is apart then is never welded.
  MeshView mesh;
  Scene scene;
  /// Of the welded points: the segments, visibility and nearest cage triangles that they have at rest, and their areas
  /// in the pose.
  PointData points;
};

}  // namespace cagecast
