#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"

namespace cagecast {

/// Step 8: marks the triangles that may be painted.
/// @param[out] cosmetic  1 per triangle.
void markCosmetic(const Array<Zone>& zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept;

}  // namespace cagecast
