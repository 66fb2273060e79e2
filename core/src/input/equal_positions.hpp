#pragma once

#include <cstdint>
#include <span>

#include "base/hash_index.hpp"

namespace cagecast {

/// Finds, for each vertex, the first one at an equal position (−0 is 0).
/// @param index  Empty, with room for all vertices.
/// @param[out] first  1 per vertex.
void findFirstAtPosition(std::span<const float> positions, HashIndex& index, std::uint32_t* first) noexcept;

}  // namespace cagecast
