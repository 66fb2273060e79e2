#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// A piece of the body that moves as one: where it is in the template, and an affine map to the target.
struct Bone {
  Vec3 from, to;                            ///< Its ends in the template.
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< Images of the axes.
  Vec3 translation{0, 0, 0};

  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return p.x * x + p.y * y + p.z * z + translation; }
};

/// The bones between joints that both have: each turned by the smallest angle and stretched along its length; the head
/// by a similarity of its landmarks. Empty if fewer than `kMinBones` are known.
/// @param from,to  Landmarks with joints ("joint_knee_left"), both in the template's space.
std::vector<Bone> bonesOf(const std::vector<Landmark>& from, const std::vector<Landmark>& to);

/// Bends a cage by bones (linear blend skinning): weights 1 / distance^6, smoothed over neighbours.
std::vector<Vec3> bend(const TemplateCage& cage, const std::vector<Bone>& bones);

/// The same for any points, without smoothing.
Vec3 bend(const Vec3& point, const std::vector<Bone>& bones);

}  // namespace cagecast::cages
