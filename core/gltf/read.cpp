#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "gltf.hpp"
#include "parse.hpp"
#include "skin.hpp"

namespace cagecast::gltf {
namespace {

constexpr const char* kNotValid = "is not valid glTF";
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr const char* kTextureTransform = "KHR_texture_transform";

/// What a node is called in errors.
std::string nodeAt(int node) { return "nodes[" + std::to_string(node) + "]"; }

Transform localTransform(const tinygltf::Node& node, const std::string& where) {
  const auto numbers = [&](const std::vector<double>& given, std::size_t count, const char* name) {
    if (!given.empty() && given.size() != count) fail(where, ".", name, " has ", given.size(), " numbers, not ", count);
    return !given.empty();
  };
  if (numbers(node.matrix, 16, "matrix")) return transformOf(node.matrix.data());
  Transform local;
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

/// How a texture lies on a primitive; by default by the first UVs, as they are.
struct UvLayout {
  std::string set = "TEXCOORD_0";
  bool isTransformed = false;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;
};

/// Reads the members of a KHR_texture_transform that are there.
/// @param where  The material, for errors.
void readTransform(const tinygltf::Value& transform, const std::string& where, UvLayout& out) {
  const auto number = [&](const tinygltf::Value& value, const char* member) {
    if (!value.IsNumber()) fail(where, ": ", member, " of ", kTextureTransform, " is not of numbers");
    return value.GetNumberAsDouble();
  };
  const auto readPair = [&](const char* member, std::array<double, 2>& pair) {
    if (!transform.Has(member)) return;
    const tinygltf::Value& given = transform.Get(member);
    if (given.ArrayLen() != 2) fail(where, ": ", member, " of ", kTextureTransform, " is not of two numbers");
    pair = {number(given.Get(0), member), number(given.Get(1), member)};
  };
  readPair("offset", out.offset);
  readPair("scale", out.scale);
  if (transform.Has("rotation")) out.rotation = number(transform.Get("rotation"), "rotation");
  out.isTransformed = true;
}

/// How the base colour texture of a primitive lies on it.
UvLayout uvLayoutOf(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  UvLayout layout;
  if (primitive.material < 0) return layout;
  const tinygltf::TextureInfo& texture =
      model.materials[static_cast<std::size_t>(primitive.material)].pbrMetallicRoughness.baseColorTexture;
  if (texture.index < 0) return layout;
  int set = texture.texCoord;
  if (const auto found = texture.extensions.find(kTextureTransform); found != texture.extensions.end()) {
    const tinygltf::Value& transform = found->second;
    readTransform(transform, "materials[" + std::to_string(primitive.material) + "]", layout);
    if (transform.Has("texCoord") && transform.Get("texCoord").IsInt()) set = transform.Get("texCoord").Get<int>();
  }
  layout.set = "TEXCOORD_" + std::to_string(set);
  return layout;
}

/// Appends UVs as they are in the texture: scaled, rotated, then moved.
void appendUvs(const std::vector<double>& uvs, const UvLayout& layout, std::vector<float>& out) {
  const double cosine = std::cos(layout.rotation), sine = std::sin(layout.rotation);
  for (std::size_t i = 0; i < uvs.size(); i += 2) {
    double u = uvs[i], v = uvs[i + 1];
    if (layout.isTransformed) {
      const double across = layout.scale[0] * u, down = layout.scale[1] * v;
      u = layout.offset[0] + cosine * across + sine * down;
      v = layout.offset[1] - sine * across + cosine * down;
    }
    out.push_back(toFloat(u));
    out.push_back(toFloat(v));
  }
}

/// The accessor of a morph target's positions, if it is applied; else −1.
int shownTarget(const Instance& instance, std::size_t target) {
  const auto& targets = instance.primitive.targets;
  if (target >= std::min(targets.size(), instance.weights.size()) || instance.weights[target] == 0) return -1;
  const auto found = targets[target].find("POSITION");
  return found == targets[target].end() ? -1 : found->second;
}

/// The positions of an instance in its own space, in the shape that its morph targets give it.
std::vector<double> shownPositions(const tinygltf::Model& model, const Instance& instance) {
  const std::string where = instance.where + ".POSITION";
  std::vector<double> positions =
      decode(model, attributeOf(instance.primitive, "POSITION"), TINYGLTF_TYPE_VEC3, 3, where);
  for (std::size_t target = 0; target < instance.weights.size(); ++target) {
    const int accessor = shownTarget(instance, target);
    if (accessor < 0) continue;
    const std::string place = instance.where + ".targets[" + std::to_string(target) + "]";
    const std::vector<double> deltas = decode(model, accessor, TINYGLTF_TYPE_VEC3, 3, place);
    if (deltas.size() < positions.size())
      fail(place, " has ", deltas.size() / 3, " elements for ", positions.size() / 3, " vertices");
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += instance.weights[target] * deltas[i];
  }
  return positions;
}

/// The triangles of a primitive.
std::vector<std::uint32_t> trianglesIn(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                       const std::string& where, std::size_t vertexCount) {
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
  return trianglesOf(corners, primitive.mode);
}

/// Whether `extras` have a mark.
bool isMarked(const tinygltf::Value& extras, const char* name) {
  if (!extras.IsObject() || !extras.Has(name)) return false;
  const tinygltf::Value& mark = extras.Get(name);
  return mark.IsBool() && mark.Get<bool>();
}

/// Whether the `extras` of a primitive or its material say that a transfer added it, to show its paint.
bool isOverlay(const tinygltf::Value& extras) { return isMarked(extras, "cagecastOverlay"); }

/// The primitive that an overlay is drawn in place of triangles of, which lacks these; null if there is none, or tools
/// have changed the mesh.
const tinygltf::Primitive* baseOf(const tinygltf::Primitive& overlay, const tinygltf::Mesh& mesh) {
  if (!isOverlay(overlay.extras) || !overlay.extras.Has("cagecastInPlaceOf")) return nullptr;
  const tinygltf::Value& number = overlay.extras.Get("cagecastInPlaceOf");
  if (!number.IsInt() || number.Get<int>() < 0) return nullptr;
  const auto at = static_cast<std::size_t>(number.Get<int>());
  if (at >= mesh.primitives.size()) return nullptr;
  const tinygltf::Primitive& base = mesh.primitives[at];
  const bool isShared = attributeOf(base, "POSITION") == attributeOf(overlay, "POSITION");
  return isShared && !isOverlay(base.extras) ? &base : nullptr;
}

void append(const tinygltf::Model& model, const Instance& instance, Model& out, bool& haveUvs) {
  const auto& [mesh, primitive, where, name, world, node, skin, weights] = instance;
  const UvLayout layout = uvLayoutOf(model, primitive);
  const int texcoord = attributeOf(primitive, layout.set);
  const std::vector<double> local = shownPositions(model, instance);
  const std::size_t vertexCount = local.size() / 3;
  std::vector<std::uint32_t> triangles = trianglesIn(model, primitive, where, vertexCount);
  for (const tinygltf::Primitive& other : mesh.primitives) {
    if (baseOf(other, mesh) != &primitive) continue;
    const std::vector<std::uint32_t> more = trianglesIn(model, other, where, vertexCount);
    triangles.insert(triangles.end(), more.begin(), more.end());
  }
  if (world.determinant() < 0)
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
  const std::vector<double> uvs = decode(model, texcoord, TINYGLTF_TYPE_VEC2, 2, where + "." + layout.set);
  if (uvs.size() != vertexCount * 2)
    fail(where, ".", layout.set, " has ", uvs.size() / 2, " elements for ", vertexCount, " vertices");
  appendUvs(uvs, layout, out.uvs);
}

/// The nodes that are no one's child.
std::vector<int> parentless(const tinygltf::Model& model) {
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

/// The nodes that the scene begins with; without scenes, all roots.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  if (model.scenes.empty()) return parentless(model);
  return element(model.scenes, std::max(model.defaultScene, 0), "scenes", "the file").nodes;
}

/// Visits nodes and all below them, depth first.
/// @param where  What has these roots, for errors.
/// @param visit  Takes the number of a node and its transform to the scene.
template <typename Visit>
void eachNode(const tinygltf::Model& model, const std::vector<int>& roots, const char* where, Visit visit) {
  struct Step {
    int node;
    Transform parent;
  };
  std::vector<Step> pending;  // The next one last.
  const auto push = [&](const std::vector<int>& nodes, const Transform& parent) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) pending.push_back({*node, parent});
  };
  push(roots, {});
  std::vector<bool> seen(model.nodes.size(), false);
  while (!pending.empty()) {
    const Step step = pending.back();
    pending.pop_back();
    const tinygltf::Node& node = element(model.nodes, step.node, "nodes", where);
    const std::string nodeName = nodeAt(step.node);
    if (seen[static_cast<std::size_t>(step.node)]) fail(nodeName, " is in ", where, " twice, or its own ancestor");
    seen[static_cast<std::size_t>(step.node)] = true;
    const Transform world = step.parent * localTransform(node, nodeName);
    push(node.children, world);
    visit(step.node, world);
  }
}

/// The accessor of an attribute of a node's instances; −1 if it does not have it.
int instanceAttribute(const tinygltf::Node& node, const char* name) {
  const auto extension = node.extensions.find(kInstancing);
  if (extension == node.extensions.end() || !extension->second.IsObject()) return -1;
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  if (!attributes.IsObject() || !attributes.Has(name)) return -1;
  const tinygltf::Value& accessor = attributes.Get(name);
  return accessor.IsInt() ? accessor.Get<int>() : -1;
}

/// The place of a node's first instance in the space of the node. All instances share the paint that is made for it.
Transform firstInstance(const tinygltf::Model& model, const tinygltf::Node& node, const std::string& where) {
  const auto read = [&](const char* name, int type, std::size_t size) {
    const int accessor = instanceAttribute(node, name);
    if (accessor < 0) return std::vector<double>{};
    std::vector<double> values = decode(model, accessor, type, size, where + "." + name);
    if (values.empty()) fail(where, " has no instance");
    values.resize(size);
    return values;
  };
  tinygltf::Node first;
  first.translation = read("TRANSLATION", TINYGLTF_TYPE_VEC3, 3);
  first.rotation = read("ROTATION", TINYGLTF_TYPE_VEC4, 4);
  first.scale = read("SCALE", TINYGLTF_TYPE_VEC3, 3);
  return localTransform(first, where);
}

/// All primitives made of triangles, depth first.
std::vector<Instance> instancesIn(const tinygltf::Model& model) {
  std::vector<Instance> instances;
  eachNode(model, rootsOf(model), "the scene", [&](int number, const Transform& world) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(number)];
    if (node.mesh < 0) return;
    const std::string nodeName = nodeAt(number);
    const tinygltf::Mesh& mesh = element(model.meshes, node.mesh, "meshes", nodeName);
    if (node.skin >= 0) (void)element(model.skins, node.skin, "skins", nodeName);
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      if (primitive.mode < -1 || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        fail("meshes[", node.mesh, "].primitives[", p, "].mode = ", primitive.mode, " is not within 0..6");
      if (primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES) continue;  // Points and lines.
      if (attributeOf(primitive, "POSITION") < 0) continue;  // glTF allows it, and asks to draw nothing.
      std::string name = !node.name.empty() ? node.name : !mesh.name.empty() ? mesh.name : nodeName;
      tinygltf::Value marks;
      if (primitive.material >= 0) {
        const tinygltf::Material& material = element(model.materials, primitive.material, "materials", nodeName);
        marks = material.extras;
        if (!material.name.empty()) name += "/" + material.name;
      }
      // One in place of triangles that cannot be given back is a part of the model.
      const bool isPart = isMarked(marks, "cagecastInPlace") && baseOf(primitive, mesh) == nullptr;
      if ((isOverlay(primitive.extras) || isOverlay(marks)) && !isPart) continue;
      const std::string where = "meshes[" + std::to_string(node.mesh) + "].primitives[" + std::to_string(p) + "]";
      instances.push_back(
          {mesh, primitive, where, name, world, number, node.skin, node.weights.empty() ? mesh.weights : node.weights});
    }
  });
  return instances;
}

/// The transform of each node to the scene, including nodes that are in no scene. Those in a cycle have the identity.
std::vector<Transform> worldsOf(const tinygltf::Model& model) {
  std::vector<Transform> worlds(model.nodes.size());
  eachNode(model, parentless(model), "the file",
           [&](int node, const Transform& world) { worlds[static_cast<std::size_t>(node)] = world; });
  return worlds;
}

/// Fails if reading the instances costs too much, or if Draco compresses one.
void checkElements(const tinygltf::Model& model, const std::vector<Instance>& instances) {
  std::size_t elements = 0;
  const auto add = [&](std::size_t count) {
    elements += std::min(count, kMaxSceneElements);
    if (elements > kMaxSceneElements) fail("has more than ", kMaxSceneElements, " elements in its scene");
  };
  const auto addAccessor = [&](int index, const std::string& where) {
    if (index >= 0) add(element(model.accessors, index, "accessors", where).count);
  };
  for (const Instance& instance : instances) {
    const tinygltf::Primitive& primitive = instance.primitive;
    const int position = attributeOf(primitive, "POSITION");
    for (const int index : {position, primitive.indices}) addAccessor(index, instance.where);
    add(instance.weights.size());
    for (std::size_t target = 0; target < instance.weights.size(); ++target)
      addAccessor(shownTarget(instance, target), instance.where);
    if (primitive.extensions.count(kCompressions[0].first) != 0 &&
        model.accessors[static_cast<std::size_t>(position)].bufferView < 0)
      failCompressed(kCompressions[0].first, kCompressions[0].second);
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"})
      addAccessor(instanceAttribute(model.nodes[static_cast<std::size_t>(instance.node)], name), nodeAt(instance.node));
    if (instance.skin < 0) continue;
    for (const char* name : {"JOINTS_0", "WEIGHTS_0"}) addAccessor(attributeOf(primitive, name), instance.where);
    const tinygltf::Skin& skin = model.skins[static_cast<std::size_t>(instance.skin)];
    add(skin.joints.size());
    addAccessor(skin.inverseBindMatrices, "skins[" + std::to_string(instance.skin) + "].inverseBindMatrices");
  }
}

Model flatten(const tinygltf::Model& model, const Place& origin) {
  std::vector<Instance> instances = instancesIn(model);
  checkElements(model, instances);
  for (Instance& instance : instances) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(instance.node)];
    if (node.extensions.count(kInstancing) != 0)
      instance.world = instance.world * firstInstance(model, node, nodeAt(instance.node));
  }
  if (std::any_of(instances.begin(), instances.end(), [](const Instance& instance) { return instance.skin >= 0; }))
    placeMeshes(model, worldsOf(model), instances);
  for (Instance& instance : instances)
    for (std::size_t row = 0; row < 3; ++row) instance.world.m[row * 4 + 3] -= origin[row];
  Model out;
  bool haveUvs = true;
  for (const Instance& instance : instances) append(model, instance, out, haveUvs);
  if (!haveUvs) out.uvs.clear();
  if (out.indices.empty()) fail("has no triangles in its scene");
  return out;
}

}  // namespace

Result readMemory(std::span<const std::uint8_t> bytes, const std::string& name, const std::string& folder, Model& out,
                  const Place& origin) {
  return guarded(name, kNotValid, [&] { out = flatten(parse(bytes, folder), origin); });
}

Result read(const std::string& path, Model& out, const Place& origin) {
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
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return readMemory(bytes, path, folder.empty() ? "." : folder, out, origin);
}

}  // namespace cagecast::gltf
