// Reads any bytes as a file: a model that is consistent, or one sentence.

#include "gltf/gltf.hpp"

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gltf::Model model;
  const gltf::Result result = gltf::readMemory({data, size}, "fuzz.glb", "", model);
  if (!result.ok()) {
    require(result.error.starts_with("fuzz.glb: "));
    return 0;
  }
  const std::size_t vertices = model.positions.size() / 3;
  require(model.groups.size() == vertices && (model.uvs.empty() || model.uvs.size() == 2 * vertices));
  for (const std::uint32_t index : model.indices) require(index < vertices);
  for (const std::uint32_t group : model.groups) require(group < model.parts.size());
  return 0;
}
