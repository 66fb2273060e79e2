#pragma once

#include <string>
#include <vector>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// A skeleton, as far as its names are understood.
struct Rig {
  std::string name = {};              ///< As in `FoundLandmarks::rig`; empty without joints.
  std::vector<Landmark> joints = {};  ///< `joint_hips` and so on: those that it has.
  std::vector<bool> isHead = {};      ///< Per joint of the model: whether it is the head's, or below it.
  std::vector<bool> isNeck = {};      ///< The same of the neck, with the head.

  [[nodiscard]] bool known() const noexcept { return !joints.empty(); }
};

/// Recognises a rig by the names of its joints: by the naming that names most of the joints in `bones.def`.
Rig recogniseRig(const std::vector<Joint>& joints);

/// All landmarks that `bones.def` knows, `joint_` before each.
std::vector<std::string> jointLandmarks();

}  // namespace cagecast::cages
