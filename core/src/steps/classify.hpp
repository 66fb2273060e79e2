#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"

namespace cagecast {

/// Step 11: whether a triangle may be painted.
/// @param zones    1 per vertex.
/// @param corners  3 vertices.
bool isCosmetic(std::span<const Zone> zones, const std::uint32_t* corners, const TransferOptions& options) noexcept;

/// Step 11: marks the triangles that may be painted.
/// @param[out] cosmetic  1 per triangle.
void markCosmetic(std::span<const Zone> zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept;

}  // namespace cagecast
