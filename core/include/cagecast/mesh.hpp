#pragma once

#include <cstdint>
#include <span>

namespace cagecast {

/// A triangle mesh, seen but not owned. The arrays stay the caller's and are only read.
struct MeshView {
  std::span<const float> positions;        ///< 3 per vertex (x, y, z), finite; cage and target share space and unit.
  std::span<const std::uint32_t> indices;  ///< 3 per triangle, counter-clockwise seen from outside.
  std::span<const float> uvs = {};         ///< 2 per vertex, finite. A cage must have them, a target need not.
  std::span<const std::uint32_t> groups = {};  ///< 1 per vertex or none: vertices of different groups are never welded.
};

inline constexpr std::uint32_t kMaxVertices = 1u << 28;   ///< Most vertices of a mesh: array sizes stay within 32 bits.
inline constexpr std::uint32_t kMaxTriangles = 1u << 28;  ///< Most triangles of a mesh.

}  // namespace cagecast
