#pragma once

#include <cstdint>
#include <span>

namespace cagecast {

/// A non-owning view of a triangle mesh. The arrays belong to the caller and are only read.
struct MeshView {
  /// 3 per vertex (x, y, z), within ±4.2e37 and ±5e7 diagonals of the target; one space for cage and target.
  std::span<const float> positions;
  std::span<const std::uint32_t> indices;      ///< 3 per triangle, counter-clockwise seen from outside.
  std::span<const float> uvs = {};             ///< 2 per vertex, finite. A target may have none.
  std::span<const std::uint32_t> groups = {};  ///< 1 per vertex or none; vertices of different groups are never welded.
  /// Of a target: other positions of its vertices, as `positions` has them, one pose after the other; or none. What is
  /// hidden at rest and seen in one of them is painted as well, with `motion`.
  std::span<const float> poses = {};
};

inline constexpr std::uint32_t kMaxVertices = 1u << 28;   ///< Limit per mesh: array sizes stay within 32 bits.
inline constexpr std::uint32_t kMaxTriangles = 1u << 28;  ///< Limit per mesh.

}  // namespace cagecast
