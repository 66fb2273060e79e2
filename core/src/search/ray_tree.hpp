#pragma once

#include <cstdint>

#include "search/node.hpp"

namespace cagecast {

/// A tree for rays. Its leaves refer to triangles by the indices of their corners.
struct RayTree {
  const Node* nodes = nullptr;       ///< The root is node 0.
  const float* positions = nullptr;  ///< x, y, z and a fourth float each, scaled.
  /// 3 positions per triangle, in the order of the leaves. A leaf is always tested with the four triangles from its
  /// first one on, even if it has fewer; after the last triangle there are enough entries to read for that.
  const std::uint32_t* corners = nullptr;
  float sceneSize = 0;  ///< The longest side of the box around all rays and triangles, scaled.
};

}  // namespace cagecast
