#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"

namespace cagecast::cages {

/// A skeleton whose naming is known.
struct Rig {
  std::string name;                   ///< As in `FoundLandmarks::rig`; empty without joints.
  std::vector<Landmark> joints = {};  ///< `joint_hips` and so on: those that it has.

  [[nodiscard]] bool known() const noexcept { return !joints.empty(); }
  /// @param landmark  Such as `joint_head`; null if the rig has no such joint.
  [[nodiscard]] const Landmark* find(std::string_view landmark) const;
};

/// Recognises a rig by the names of its joints: by the naming that names most of the joints in `bones.def`.
Rig recogniseRig(const std::vector<Joint>& joints);

/// All landmarks that `bones.def` knows, `joint_` before each.
std::vector<std::string> jointLandmarks();

inline Vec3 toVec3(const Position& p) { return Vec3::from(p.data()); }
inline Position toPosition(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

}  // namespace cagecast::cages
