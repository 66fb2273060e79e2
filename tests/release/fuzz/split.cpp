// Splits the vertices of any target by any UVs of its corners: each corner keeps its vertex and its UV.

#include "cagecast/split.hpp"

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t vertices = input.below(50);
  std::vector<std::uint32_t> indices(input.below(200));
  for (std::uint32_t& index : indices) index = input.below(vertices + 1);
  std::vector<float> uvs(2 * indices.size() + (input.byte() == 255 ? 1 : 0));
  for (float& uv : uvs) uv = static_cast<float>(input.below(4));
  SplitVertices split;
  if (!splitVertices(indices, uvs, vertices, split).ok()) return 0;
  require(split.indices.size() == indices.size() && split.uvs.size() == 2 * split.sources.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::size_t v = split.indices[i];
    require(v < split.sources.size() && split.sources[v] == indices[i]);
    require(split.uvs[2 * v] == uvs[2 * i] && split.uvs[2 * v + 1] == uvs[2 * i + 1]);
  }
  return 0;
}
