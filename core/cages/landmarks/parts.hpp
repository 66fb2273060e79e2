#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"
#include "landmarks/rig.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// What a part of a figure is, as far as landmarks are concerned.
enum class Role : std::uint8_t {
  surface,  ///< Skin, clothes, and whatever has no other role.
  eye,
  mouth,  ///< Teeth, tongue, gums.
  cover,  ///< Lies on or over the skin: lashes, brows, hair, glasses, hats.
};

/// The role of a part by its name, in which case does not matter.
Role roleOf(std::string_view partName);

/// A model whose equal positions are welded, with the role and the connected component of each triangle, and what its
/// skeleton tells.
struct Figure {
  TriangleMesh mesh;
  std::vector<Role> roles;                ///< Per triangle.
  std::vector<std::uint32_t> components;  ///< Per triangle.
  std::uint32_t componentCount = 0;
  std::vector<std::uint32_t> triangleOf = {};  ///< Of the model, per triangle.
  Rig rig = {};
  std::optional<Vec3> front = {};  ///< Horizontal; if bones tell left from right.

  [[nodiscard]] bool has(Role role) const;
  /// The triangles with one of some roles.
  [[nodiscard]] TriangleMesh only(Role first) const { return only(first, first); }
  [[nodiscard]] TriangleMesh only(Role first, Role second) const;
};

Figure readFigure(const Model& model);

/// The part of a figure that its head's joints hold, with eyes and mouth; the whole figure if no joint is a head's.
/// @param model  That the figure was read from.
Figure headOf(const Figure& figure, const Model& model);

}  // namespace cagecast::cages
