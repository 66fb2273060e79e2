#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cagecast/transfer.hpp"

/// glTF 2.0 for native hosts: files to the plain arrays that the library takes, and back. Needs tinygltf.
///
/// Made for files of unknown origin: whatever is wrong with one comes back as a sentence, nothing is read out of
/// bounds.
namespace cagecast::gltf {

/// How a call ended: an error as one sentence that begins with the name of the file; nothing of the output is valid
/// then.
struct [[nodiscard]] Result {
  std::string error;  ///< Empty if nothing went wrong.
  [[nodiscard]] bool ok() const noexcept { return error.empty(); }
};

/// A place in a scene.
using Place = std::array<double, 3>;

/// One primitive of one node, as a range of the whole.
struct Part {
  std::string name;  ///< "node/material", or the node's name alone if the material has none.
  std::uint32_t firstVertex = 0, vertexCount = 0;
  std::uint32_t firstTriangle = 0, triangleCount = 0;
};

/// All triangles of a file's default scene, as one mesh in world space.
struct Model {
  std::vector<float> positions;        ///< 3 per vertex, world transforms applied; skinned meshes in the bind pose.
  std::vector<std::uint32_t> indices;  ///< 3 per triangle; strips and fans are expanded.
  std::vector<float> uvs;              ///< 2 per vertex; empty unless every part has them.
  std::vector<std::uint32_t> groups;   ///< 1 per vertex: the number of its part.
  std::vector<Part> parts;             ///< In scene order, depth first.

  /// The model as the library takes it; valid as long as the model is.
  [[nodiscard]] MeshView view() const noexcept { return {positions, indices, uvs, groups}; }
};

/// Reads a .glb or .gltf file: all primitives made of triangles, in scene order, one after the other.
///
/// Takes sparse and quantised accessors (KHR_mesh_quantization) and buffers that are embedded, data URIs or regular
/// files in its folder, links followed. A mirrored node has its triangles turned round, so that they still face
/// outward. Skinned meshes are placed by their skeleton, in the bind pose; as the format demands, the transform of
/// their node is ignored. Morph targets shape a mesh by the weights of its node, or else of itself. UVs are of the set
/// that the base colour texture names, moved by its KHR_texture_transform; of TEXCOORD_0 without a texture. A mesh with
/// instances (EXT_mesh_gpu_instancing) is taken once, where its first instance is; overlays of an earlier transfer are
/// left out. Not understood: Draco and meshopt compression.
/// @param origin  Subtracted from all positions before they are rounded to floats. For a scene far from its origin,
/// give target and cage the same one, such as a vertex of the target as it was first read.
Result read(const std::string& path, Model& out, const Place& origin = {});

/// Reads a .glb or .gltf file out of memory.
/// @param name    What to call the file in errors.
/// @param folder  Where the files that it refers to must be; empty if it may refer to none.
/// @param origin  As for `read`.
Result readMemory(std::span<const std::uint8_t> bytes, const std::string& name, const std::string& folder, Model& out,
                  const Place& origin = {});

/// What to write: one mesh.
struct Content {
  MeshView mesh;                     ///< Positions and indices; UVs, if any, become TEXCOORD_0.
  std::span<const float> uvs1 = {};  ///< 2 per vertex or none: TEXCOORD_1.
  std::span<const Zone> zones = {};  ///< 1 per vertex or none: the attribute _NCZ, an unsigned byte each.
  std::string name = "mesh";         ///< The node's and the mesh's.
};

/// Writes a mesh as a .glb file; an existing file is replaced once the new one is complete.
Result write(const std::string& path, const Content& content);

/// Writes a mesh as the bytes of a .glb file.
Result writeMemory(const Content& content, std::vector<std::uint8_t>& out);

}  // namespace cagecast::gltf
