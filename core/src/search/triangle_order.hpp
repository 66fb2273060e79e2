#pragma once

#include <cstdint>

namespace cagecast {

/// A triangle to be ordered.
struct alignas(16) OrderedTriangle {
  float centre[3];  ///< Twice the centre of its box.
  std::uint32_t cageTriangle;
};

/// Orders triangles so that each run of 4, 16, 64 … of them, which becomes a leaf or a node, is compact: a k-d tree
/// whose splits are all at ends of such runs.
void orderTriangles(OrderedTriangle* triangles, std::uint32_t count) noexcept;

}  // namespace cagecast
