#pragma once

#include <tiny_gltf.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "problem.hpp"

namespace cagecast::gltf {

/// Most elements of the whole scene, instances and all: any number of nodes can refer to one mesh of a few bytes.
inline constexpr std::size_t kMaxSceneElements = 1u << 26;

/// Extensions that compress meshes, which are not supported, and their names.
inline constexpr std::array kCompressions{std::pair{"KHR_draco_mesh_compression", "Draco"},
                                          std::pair{"EXT_meshopt_compression", "meshopt"}};

[[noreturn]] void failCompressed(const char* extension, const char* name);

/// Parses a file.
/// @param folder  Where other files that it refers to must be; empty if it may refer to none.
tinygltf::Model parse(std::span<const std::uint8_t> bytes, const std::string& folder);

/// An element of one of the file's arrays; the place that refers to it is named if there is no such element.
template <typename T>
const T& element(const std::vector<T>& items, int index, const char* kind, const std::string& referrer) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size())
    fail(referrer, " refers to ", kind, "[", index, "], which does not exist (there are ", items.size(), ")");
  return items[static_cast<std::size_t>(index)];
}

/// The accessor of an attribute; −1 if the primitive does not have it.
int attributeOf(const tinygltf::Primitive& primitive, const std::string& name);

/// Fails unless indices are unsigned integers.
/// @param where  The indices.
void checkIndexType(int componentType, const std::string& where);

/// Decodes an accessor into `components` numbers per element.
/// @param type  What it must be: TINYGLTF_TYPE_VEC3 and the like.
std::vector<double> decode(const tinygltf::Model& model, int index, int type, std::size_t components,
                           const std::string& referrer);

}  // namespace cagecast::gltf
