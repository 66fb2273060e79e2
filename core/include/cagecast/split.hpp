#pragma once

#include <cstdint>
#include <span>

#include "cagecast/array.hpp"
#include "cagecast/status.hpp"

namespace cagecast {

/// A mesh whose vertices are split wherever the UVs of their corners differ, so that UVs per corner become UVs per
/// vertex.
struct SplitVertices {
  /// 1 per new vertex: the vertex that it copies. New vertices are in the order in which `indices` first uses them.
  Array<std::uint32_t> sources;
  Array<std::uint32_t> indices;  ///< The same triangles, as indices of new vertices.
  Array<float> uvs;              ///< 2 per new vertex.
};

/// Splits the vertices of a mesh so that every corner of a triangle has the UV that is given for it. Corners at
/// the same vertex with the same UV share one new vertex; vertices that no triangle uses are left out. A new vertex has
/// the position, normal, skin weights, morph deltas and zone of its source.
/// @param indices      3 per triangle.
/// @param cornerUvs    2 per index, as in `Projection::cornerUvs`.
/// @param vertexCount  Number of vertices of the mesh.
/// @return indicesNotTriples, tooLarge or indexOutOfRange, for the target; cornerUvCountMismatch if there are not 2 UV
/// floats per index; outOfMemory. `describe` takes a target with these indices and the mesh's positions.
/// Cost: linear.
Status splitVertices(std::span<const std::uint32_t> indices, std::span<const float> cornerUvs,
                     std::uint32_t vertexCount, SplitVertices& out) noexcept;

}  // namespace cagecast
