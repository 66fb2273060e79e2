#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"
#include "cagecast/status.hpp"

namespace cagecast {

/// Checks that masks belong to a target.
/// @return badOption for a wrong number of entries (`at`; `value` is 0), or for an entry (`at`) that is no mask
/// (`value`).
Status checkMasks(const Masks& masks, std::size_t vertexCount, std::size_t triangleCount) noexcept;

/// Whether a triangle may be painted by the masks of it and its corners; nothing if they leave it to the method.
/// @param zones  1 per vertex, as masks have left them.
std::optional<bool> maskedVerdict(const TransferOptions& options, std::span<const std::uint32_t> indices,
                                  std::span<const Zone> zones, std::size_t triangle) noexcept;

/// Applies the masks of `options` to zones and triangles, after step 11.
/// @return false if memory ran out.
bool applyMasks(const TransferOptions& options, std::span<const std::uint32_t> indices, Zones& out) noexcept;

}  // namespace cagecast
