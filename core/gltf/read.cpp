#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "gltf.hpp"
#include "parse.hpp"

namespace cagecast::gltf {
namespace {

constexpr const char* kNotValid = "is not valid glTF";

/// A 3×4 affine transform, row by row.
struct Transform {
  std::array<double, 12> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  Transform operator*(const Transform& other) const {
    Transform product;
    for (std::size_t row = 0; row < 12; row += 4)
      for (std::size_t column = 0; column < 4; ++column)
        product.m[row + column] = m[row] * other.m[column] + m[row + 1] * other.m[4 + column] +
                                  m[row + 2] * other.m[8 + column] + (column == 3 ? m[row + 3] : 0);
    return product;
  }
  bool operator==(const Transform&) const = default;
  bool mirrors() const {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
               m[2] * (m[4] * m[9] - m[5] * m[8]) <
           0;
  }
};

Transform transformOf(const tinygltf::Node& node, const std::string& where) {
  const auto numbers = [&](const std::vector<double>& given, std::size_t count, const char* name) {
    if (!given.empty() && given.size() != count) fail(where, ".", name, " has ", given.size(), " numbers, not ", count);
    return !given.empty();
  };
  Transform local;
  if (numbers(node.matrix, 16, "matrix")) {
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column) local.m[row * 4 + column] = node.matrix[column * 4 + row];
    return local;
  }
  if (numbers(node.rotation, 4, "rotation")) {
    const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
    local.m = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),     0,
               2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),     0,
               2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y), 0};
  }
  if (numbers(node.scale, 3, "scale"))
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column) local.m[row * 4 + column] *= node.scale[column];
  if (numbers(node.translation, 3, "translation"))
    for (std::size_t row = 0; row < 3; ++row) local.m[row * 4 + 3] = node.translation[row];
  return local;
}

/// The corners of a primitive's triangles, as places in its vertices. Incomplete triangles at the end are left out.
std::vector<std::uint32_t> trianglesOf(const std::vector<std::uint32_t>& corners, int mode) {
  if (mode < 0 || mode == TINYGLTF_MODE_TRIANGLES) {  // The default.
    std::vector<std::uint32_t> triangles = corners;
    triangles.resize(corners.size() / 3 * 3);
    return triangles;
  }
  std::vector<std::uint32_t> triangles;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    // Every other triangle of a strip is wound the other way.
    const std::size_t odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP ? i % 2 : 0;
    const std::size_t first = mode == TINYGLTF_MODE_TRIANGLE_STRIP ? i - 2 : 0;
    triangles.insert(triangles.end(), {corners[first], corners[i - 1 + odd], corners[i - odd]});
  }
  return triangles;
}

float toFloat(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  if (value > kMax) return std::numeric_limits<float>::infinity();
  if (value < -kMax) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value);
}

int attributeOf(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// The UV set by which the base colour texture of a primitive lies on it; the first if it has none.
std::string uvSetOf(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  if (primitive.material < 0) return "TEXCOORD_0";
  const tinygltf::TextureInfo& texture =
      model.materials[static_cast<std::size_t>(primitive.material)].pbrMetallicRoughness.baseColorTexture;
  return "TEXCOORD_" + std::to_string(texture.index < 0 ? 0 : texture.texCoord);
}

/// A primitive in its place in the scene.
struct Instance {
  const tinygltf::Primitive& primitive;
  std::string where, name;  // In the file, and for people.
  Transform world;
};

void append(const tinygltf::Model& model, const Instance& instance, Model& out, bool& haveUvs) {
  const auto& [primitive, where, name, world] = instance;
  const std::string uvSet = uvSetOf(model, primitive);
  const int position = attributeOf(primitive, "POSITION"), texcoord = attributeOf(primitive, uvSet);
  if (primitive.extensions.count(kCompressions[0].first) != 0 &&
      element(model.accessors, position, "accessors", where).bufferView < 0)
    failCompressed(kCompressions[0].first, kCompressions[0].second);
  const std::vector<double> local = decode(model, position, TINYGLTF_TYPE_VEC3, 3, where + ".POSITION");
  const std::size_t vertexCount = local.size() / 3;
  std::vector<std::uint32_t> corners;
  if (primitive.indices >= 0) {
    checkIndexType(element(model.accessors, primitive.indices, "accessors", where).componentType, where + ".indices");
    const std::vector<double> indices = decode(model, primitive.indices, TINYGLTF_TYPE_SCALAR, 1, where + ".indices");
    corners.reserve(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (!(indices[i] >= 0 && indices[i] < static_cast<double>(vertexCount)))
        fail(where, ".indices[", i, "] = ", indices[i], " is out of range (", vertexCount, " vertices)");
      corners.push_back(static_cast<std::uint32_t>(indices[i]));
    }
  } else {
    for (std::uint32_t i = 0; i < vertexCount; ++i) corners.push_back(i);
  }
  std::vector<std::uint32_t> triangles = trianglesOf(corners, primitive.mode);
  if (world.mirrors())
    for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) std::swap(triangles[i + 1], triangles[i + 2]);

  const std::size_t firstVertex = out.positions.size() / 3, firstTriangle = out.indices.size() / 3;
  const std::uint32_t part = static_cast<std::uint32_t>(out.parts.size());
  out.parts.push_back({name, static_cast<std::uint32_t>(firstVertex), static_cast<std::uint32_t>(vertexCount),
                       static_cast<std::uint32_t>(firstTriangle), static_cast<std::uint32_t>(triangles.size() / 3)});
  const bool moves = world != Transform{};
  for (std::size_t i = 0; i < local.size(); i += 3)
    for (std::size_t row = 0; row < 3; ++row) {
      const double* m = &world.m[row * 4];
      out.positions.push_back(
          toFloat(moves ? m[0] * local[i] + m[1] * local[i + 1] + m[2] * local[i + 2] + m[3] : local[i + row]));
    }
  for (const std::uint32_t corner : triangles) out.indices.push_back(static_cast<std::uint32_t>(firstVertex) + corner);
  out.groups.resize(firstVertex + vertexCount, part);
  haveUvs = haveUvs && texcoord >= 0;
  if (!haveUvs) return;
  const std::vector<double> uvs = decode(model, texcoord, TINYGLTF_TYPE_VEC2, 2, where + "." + uvSet);
  if (uvs.size() != vertexCount * 2)
    fail(where, ".", uvSet, " has ", uvs.size() / 2, " elements for ", vertexCount, " vertices");
  for (const double uv : uvs) out.uvs.push_back(toFloat(uv));
}

/// The nodes that a scene begins with.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  if (!model.scenes.empty()) return element(model.scenes, std::max(model.defaultScene, 0), "scenes", "the file").nodes;
  // Without scenes, every node that is no one's child is a root.
  std::vector<bool> isChild(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children)
      if (child >= 0 && static_cast<std::size_t>(child) < isChild.size())
        isChild[static_cast<std::size_t>(child)] = true;
  std::vector<int> roots;
  for (std::size_t i = 0; i < isChild.size(); ++i)
    if (!isChild[i]) roots.push_back(static_cast<int>(i));
  return roots;
}

/// All primitives made of triangles, depth first.
std::vector<Instance> instancesIn(const tinygltf::Model& model) {
  struct Visit {
    int node;
    Transform parent;
  };
  std::vector<Visit> pending;  // The next one last.
  const auto push = [&](const std::vector<int>& nodes, const Transform& parent) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) pending.push_back({*node, parent});
  };
  push(rootsOf(model), {});
  std::vector<Instance> instances;
  std::vector<bool> seen(model.nodes.size(), false);
  while (!pending.empty()) {
    const Visit visit = pending.back();
    pending.pop_back();
    const tinygltf::Node& node = element(model.nodes, visit.node, "nodes", "the scene");
    const std::string nodeName = "nodes[" + std::to_string(visit.node) + "]";
    if (seen[static_cast<std::size_t>(visit.node)]) fail(nodeName, " is in the scene twice, or its own ancestor");
    seen[static_cast<std::size_t>(visit.node)] = true;
    const Transform world = visit.parent * transformOf(node, nodeName);
    push(node.children, world);
    if (node.mesh < 0) continue;
    const tinygltf::Mesh& mesh = element(model.meshes, node.mesh, "meshes", nodeName);
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      if (primitive.mode < -1 || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        fail("meshes[", node.mesh, "].primitives[", p, "].mode = ", primitive.mode, " is not within 0..6");
      if (primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES) continue;  // Points and lines.
      if (attributeOf(primitive, "POSITION") < 0) continue;  // glTF allows it, and asks to draw nothing.
      std::string name = !node.name.empty() ? node.name : !mesh.name.empty() ? mesh.name : nodeName;
      if (primitive.material >= 0) {
        const std::string& material = element(model.materials, primitive.material, "materials", nodeName).name;
        if (!material.empty()) name += "/" + material;
      }
      instances.push_back(
          {primitive, "meshes[" + std::to_string(node.mesh) + "].primitives[" + std::to_string(p) + "]", name, world});
    }
  }
  return instances;
}

Model flatten(const tinygltf::Model& model) {
  const std::vector<Instance> instances = instancesIn(model);
  std::size_t elements = 0;
  for (const Instance& instance : instances) {
    for (const int index : {attributeOf(instance.primitive, "POSITION"), instance.primitive.indices}) {
      if (index < 0) continue;
      elements += std::min(element(model.accessors, index, "accessors", instance.where).count, kMaxSceneElements);
      if (elements > kMaxSceneElements) fail("has more than ", kMaxSceneElements, " elements in its scene");
    }
  }
  Model out;
  bool haveUvs = true;
  for (const Instance& instance : instances) append(model, instance, out, haveUvs);
  if (!haveUvs) out.uvs.clear();
  if (out.indices.empty()) fail("has no triangles in its scene");
  return out;
}

}  // namespace

Result readMemory(std::span<const std::uint8_t> bytes, const std::string& name, const std::string& folder, Model& out) {
  return guarded(name, kNotValid, [&] { out = flatten(parse(bytes, folder)); });
}

Result read(const std::string& path, Model& out) {
  std::vector<std::uint8_t> bytes;
  Result result = guarded(path, kNotValid, [&] {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) fail("cannot be read (", error.message(), ")");
    bytes.resize(size);
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
      fail("cannot be read (", std::strerror(errno), ")");
  });
  if (!result.ok()) return result;
  return readMemory(bytes, path, std::filesystem::path(path).parent_path().string(), out);
}

}  // namespace cagecast::gltf
