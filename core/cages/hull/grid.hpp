#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/vec3.hpp"

namespace cagecast::cages {

/// A regular grid of nodes, x running fastest.
struct VoxelGrid {
  Vec3 origin{};       ///< Position of the first node.
  double spacing = 0;  ///< Between nodes, in the space of the model.
  std::uint32_t nx = 0, ny = 0, nz = 0;

  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{nx} * ny * nz; }
  [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
    return (std::size_t{z} * ny + y) * nx + x;
  }
  [[nodiscard]] Vec3 position(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
    return origin + spacing * Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
};

}  // namespace cagecast::cages
