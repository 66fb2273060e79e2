#include <tiny_gltf.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include "gltf.hpp"
#include "problem.hpp"

namespace cagecast::gltf {
namespace {

/// Elements laid out one after the other.
struct Values {
  std::span<const std::uint8_t> bytes;
  std::size_t count;
  int type, componentType, target;
};

/// Appends an accessor.
/// @return Its index.
int addAccessor(tinygltf::Model& model, const Values& values) {
  const auto [bytes, count, type, componentType, target] = values;
  std::vector<unsigned char>& data = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = bytes.size();
  view.byteStride = target == TINYGLTF_TARGET_ARRAY_BUFFER ? bytes.size() / count : 0;
  view.target = target;
  data.insert(data.end(), bytes.begin(), bytes.end());
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.count = count;
  accessor.type = type;
  accessor.componentType = componentType;
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size() - 1);
}

template <typename T>
std::span<const std::uint8_t> asBytes(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

void check(const Content& content) {
  const MeshView& mesh = content.mesh;
  if (mesh.positions.empty() || mesh.positions.size() % 3 != 0)
    fail("cannot be written: positions has ", mesh.positions.size(), " floats, not three per vertex");
  if (mesh.indices.empty() || mesh.indices.size() % 3 != 0)
    fail("cannot be written: indices has ", mesh.indices.size(), " entries, not three per triangle");
  const std::size_t count = mesh.positions.size() / 3;
  const auto perVertex = [&](const char* name, std::size_t size, std::size_t each) {
    if (size != 0 && size != count * each)
      fail("cannot be written: ", name, " has ", size, " values for ", count, " vertices");
  };
  const auto finite = [&](const char* name, std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i])) fail("cannot be written: ", name, "[", i, "] = ", values[i], " is not finite");
  };
  perVertex("uvs", mesh.uvs.size(), 2);
  perVertex("uvs1", content.uvs1.size(), 2);
  perVertex("zones", content.zones.size(), 1);
  finite("positions", mesh.positions);
  finite("uvs", mesh.uvs);
  finite("uvs1", content.uvs1);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.indices[i] >= count)
      fail("cannot be written: indices[", i, "] = ", mesh.indices[i], " is out of range (", count, " vertices)");
  const std::size_t bytes = mesh.positions.size_bytes() + mesh.indices.size_bytes() + mesh.uvs.size_bytes() +
                            content.uvs1.size_bytes() + 4 * content.zones.size();
  if (bytes > std::numeric_limits<std::uint32_t>::max() - (1u << 20)) fail("would be larger than 4 GiB");
}

std::string serialise(const Content& content) {
  check(content);
  const MeshView& mesh = content.mesh;
  const std::size_t count = mesh.positions.size() / 3;
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "cagecast";
  model.buffers.emplace_back();
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  const auto attribute = [&](const char* name, std::span<const std::uint8_t> bytes, int type, int componentType) {
    const int accessor = addAccessor(model, {bytes, count, type, componentType, TINYGLTF_TARGET_ARRAY_BUFFER});
    primitive.attributes[name] = accessor;
    return accessor;
  };
  const int position =
      attribute("POSITION", asBytes(mesh.positions), TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = mesh.positions[axis], high = low;
    for (std::size_t i = axis; i < mesh.positions.size(); i += 3) {
      low = std::min(low, static_cast<double>(mesh.positions[i]));
      high = std::max(high, static_cast<double>(mesh.positions[i]));
    }
    model.accessors[static_cast<std::size_t>(position)].minValues.push_back(low);
    model.accessors[static_cast<std::size_t>(position)].maxValues.push_back(high);
  }
  if (!mesh.uvs.empty()) attribute("TEXCOORD_0", asBytes(mesh.uvs), TINYGLTF_TYPE_VEC2, TINYGLTF_COMPONENT_TYPE_FLOAT);
  if (!content.uvs1.empty())
    attribute("TEXCOORD_1", asBytes(content.uvs1), TINYGLTF_TYPE_VEC2, TINYGLTF_COMPONENT_TYPE_FLOAT);
  if (!content.zones.empty()) {
    std::vector<std::uint8_t> padded(count * 4, 0);  // Each vertex's attributes begin at a multiple of four.
    for (std::size_t v = 0; v < count; ++v) padded[v * 4] = static_cast<std::uint8_t>(content.zones[v]);
    attribute("_NCZ", padded, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE);
  }
  primitive.indices = addAccessor(model, {asBytes(mesh.indices), mesh.indices.size(), TINYGLTF_TYPE_SCALAR,
                                          TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER});
  model.meshes.emplace_back().name = content.name;
  model.meshes[0].primitives.push_back(std::move(primitive));
  tinygltf::Node& node = model.nodes.emplace_back();
  node.name = content.name;
  node.mesh = 0;
  model.scenes.emplace_back().nodes.push_back(0);
  model.defaultScene = 0;
  std::ostringstream stream;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, stream, false, true)) fail("cannot be written");
  return std::move(stream).str();
}

}  // namespace

Result writeMemory(const Content& content, std::vector<std::uint8_t>& out) {
  return guarded(content.name, "cannot be written", [&] {
    const std::string bytes = serialise(content);
    out.assign(bytes.begin(), bytes.end());
  });
}

Result write(const std::string& path, const Content& content) {
  return guarded(path, "cannot be written", [&] {
    const std::string bytes = serialise(content);
    const std::string unfinished = path + ".part";
    errno = 0;
    std::ofstream file(unfinished, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code error(errno, std::generic_category());
    if (file.good()) {
      std::filesystem::rename(unfinished, path, error);
      if (!error) return;
    }
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    fail("cannot be written (", error.message(), ")");
  });
}

}  // namespace cagecast::gltf
