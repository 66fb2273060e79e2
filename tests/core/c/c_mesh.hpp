#pragma once

#include "cagecast/cagecast_c.h"
#include "scenes/scenes.hpp"

namespace cagecast {

/// A mesh of a test as C sees it.
inline CagecastMesh cMesh(const scenes::Mesh& mesh) {
  return {mesh.positions.data(),
          mesh.indices.data(),
          mesh.uvs.data(),
          mesh.groups.data(),
          nullptr,
          static_cast<std::uint32_t>(mesh.vertexCount()),
          static_cast<std::uint32_t>(mesh.triangleCount()),
          0};
}

}  // namespace cagecast
