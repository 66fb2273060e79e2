#pragma once

#include <cstdint>

#include "cagecast/mesh.hpp"

namespace cagecast {

/// A node of a search tree: the boxes of its four children side by side, so that one SIMD instruction tests all of
/// them. Each box is larger than its contents by more than the rounding of the tests against it.
struct alignas(16) Node {
  float low[3][4];         ///< low[axis][child]
  float high[3][4];        ///< high[axis][child]
  std::uint32_t child[4];  ///< A node's index, or `leafOf`. An unused child is some leaf, in a box that is far away.
};

inline constexpr std::uint32_t kLeafBit = 0x8000'0000u;
/// A leaf as a node's child.
/// @param first  Its first triangle.
inline constexpr std::uint32_t leafOf(std::uint32_t first) { return kLeafBit | first; }
inline constexpr bool isLeaf(std::uint32_t child) { return (child & kLeafBit) != 0; }
inline constexpr std::uint32_t firstOf(std::uint32_t leaf) { return leaf & ~kLeafBit; }
static_assert(kMaxTriangles < kLeafBit);

}  // namespace cagecast
