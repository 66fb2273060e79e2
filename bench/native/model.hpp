#pragma once

#include <string>
#include <vector>

#include "cagecast/mesh.hpp"

namespace cagecast::bench {

/// A mesh that owns its arrays. A float's worth of memory follows the positions: peers read them 16 bytes at a time.
struct Mesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;

  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups}; }
};

/// What is measured: a target and its cage.
struct Model {
  Mesh cage, target;
};

/// Reads a target and a cage from two glTF files, or both from one scene file (one path). A scene file is
/// little-endian: "CAGESCN1", then the cage, then the target, each as u32 vertexCount, u32 indexCount, u8 hasUvs, u8
/// hasGroups, two bytes 0, f32 positions, u32 indices, f32 uvs (if any), u32 groups (if any).
/// @return What is wrong, as one sentence; empty if nothing is.
std::string readModel(const std::vector<std::string>& paths, Model& out);

/// Writes a scene file.
/// @return What is wrong; empty if nothing is.
std::string writeScene(const std::string& path, const Model& model);

}  // namespace cagecast::bench
