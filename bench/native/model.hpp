#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/mesh.hpp"

namespace cagecast::bench {

/// A mesh that owns its arrays.
struct Mesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;

  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups}; }
};

/// Vertices of equal position and group are one point.
struct Points {
  std::vector<float> positions;         ///< 3 per point, in the order of a Morton curve.
  std::vector<std::uint32_t> ofVertex;  ///< The point of each vertex.
  float diagonal = 0;                   ///< Of the box around them.
};

/// A target and its cage.
struct Model {
  Mesh cage, target;
  Points points;  ///< Of the target.
};

/// Reads a scene file, as bench/scene-file.ts writes it.
/// @return Why that is not possible; empty if it is.
std::string readModel(const std::string& path, Model& out);

}  // namespace cagecast::bench
