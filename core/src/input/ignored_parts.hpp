#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/status.hpp"

namespace cagecast {

/// Replaces a target by one of the same sizes in which some groups are not there: their vertices lie on a vertex that
/// is left, and their triangles have no area.
/// @param groups  Numbers of groups. Empty: the target stays as it is.
/// @param[in,out] target  Checked. What is replaced is in the arena.
/// @return badOption for a group without vertices, or if none is left; outOfMemory.
Status ignoreParts(std::span<const std::uint32_t> groups, Arena& arena, MeshView& target) noexcept;

}  // namespace cagecast
