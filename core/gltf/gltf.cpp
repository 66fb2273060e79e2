#include "gltf.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace cagecast::gltf {
namespace {

static_assert(std::endian::native == std::endian::little, "buffers are read as they lie in the file");

// tinygltf descends into `extras` by recursion: a limit on nesting keeps a hostile file from exhausting the stack.
constexpr int kMaxJsonDepth = 200;
// Elements that nothing in the file stands for (an accessor without a buffer view) cost an attacker no bytes.
constexpr std::size_t kMaxImpliedElements = 1u << 22;
// The whole scene, instances and all: one mesh of a few bytes can be referred to by any number of nodes.
constexpr std::size_t kMaxSceneElements = 1u << 26;

/// The way out of a broken file, within this file only.
struct Problem {
  std::string text;
};

template <typename... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw Problem{text.str()};
}

/// Runs work that may fail, and turns whatever it throws into an error about a file.
template <typename Work>
Result guarded(const std::string& name, Work work) {
  try {
    work();
    return {};
  } catch (const Problem& problem) {
    return {name + ": " + problem.text};
  } catch (const std::bad_alloc&) {
    return {name + ": not enough memory"};
  } catch (const std::exception& error) {
    return {name + ": is not valid glTF (" + error.what() + ")"};
  }
}

// --------------------------------------------------------------------------------------------------------------
// Reading

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, &bytes[at], sizeof value);
  return value;
}

bool isBinary(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

/// Checks the container and finds the JSON in it. tinygltf 2.7 checks less: it reads past the end of a file whose last
/// chunk is cut short by up to 8 bytes.
std::string_view findJson(std::span<const std::uint8_t> bytes) {
  const char* text = reinterpret_cast<const char*>(bytes.data());
  if (!isBinary(bytes)) {
    const auto first =
        std::find_if_not(bytes.begin(), bytes.end(), [](std::uint8_t c) { return std::isspace(c) != 0; });
    if (first == bytes.end()) fail("is empty");
    if (*first != '{') fail("is not a glTF file (it begins with neither \"glTF\" nor \"{\")");
    return {text, bytes.size()};
  }
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) fail("is truncated (", bytes.size(), " bytes)");
  if (const std::uint32_t version = word(bytes, 4); version != 2) fail("is glTF version ", version, ", not 2");
  const std::size_t length = word(bytes, 8);
  if (length > bytes.size()) fail("is truncated (its header says ", length, " bytes, there are ", bytes.size(), ")");
  std::string_view json;
  for (std::size_t at = kHeader, chunk = 0; at < length; ++chunk) {
    if (length - at < kChunkHeader || word(bytes, at) > length - at - kChunkHeader)
      fail("is broken (chunk ", chunk, " reaches past the end)");
    if (chunk == 0) json = {text + at + kChunkHeader, word(bytes, at)};
    at += kChunkHeader + word(bytes, at);
  }
  if (word(bytes, 16) != 0x4E4F534A) fail("is broken (its first chunk is not JSON)");
  return json;
}

void checkDepth(std::string_view json) {
  int depth = 0;
  bool inString = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (inString) {
      if (c == '\\') ++i;
      inString = c != '"';
    } else if (c == '"') {
      inString = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxJsonDepth) fail("is not valid glTF (nested more than ", kMaxJsonDepth, " deep)");
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

constexpr std::array kCompressions{std::pair{"KHR_draco_mesh_compression", "Draco"},
                                   std::pair{"EXT_meshopt_compression", "meshopt"}};

[[noreturn]] void failCompressed(const char* extension, const char* name) {
  fail("is compressed with ", name, " (", extension, "), which is not supported here; decompress it first");
}

tinygltf::Model parse(std::span<const std::uint8_t> bytes, const std::string& folder) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) fail("is larger than 4 GiB");
  const std::string_view json = findJson(bytes);
  checkDepth(json);
  tinygltf::TinyGLTF loader;
  // Pictures are not looked at.
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const unsigned size = static_cast<unsigned>(bytes.size());
  const bool good = isBinary(bytes)
                        ? loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), size, folder)
                        : loader.LoadASCIIFromString(&model, &error, &warning,
                                                     reinterpret_cast<const char*>(bytes.data()), size, folder);
  for (const auto& [extension, name] : kCompressions) {
    // A file that cannot do without an extension often has no buffers to fall back to, and does not get through.
    const auto& required = model.extensionsRequired;
    if (good ? std::find(required.begin(), required.end(), extension) != required.end()
             : json.find('"' + std::string(extension) + '"') != std::string_view::npos)
      failCompressed(extension, name);
  }
  if (!good) {
    error = error.substr(0, error.find('\n'));
    if (error.rfind("File not found : ", 0) == 0) fail("refers to a file that is missing: ", error.substr(17));
    fail("is not valid glTF (", error.empty() ? "cannot be parsed" : error, ")");
  }
  if (model.asset.version.rfind("2.", 0) != 0) fail("is glTF version ", model.asset.version, ", not 2");
  return model;
}

/// An element of one of the file's arrays; the place that refers to it is named if there is no such element.
template <typename T>
const T& element(const std::vector<T>& items, int index, const char* kind, const std::string& referrer) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size())
    fail(referrer, " refers to ", kind, "[", index, "], which does not exist (there are ", items.size(), ")");
  return items[static_cast<std::size_t>(index)];
}

std::size_t componentSize(int type, const std::string& where) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: fail(where, " has component type ", type, ", which glTF does not know");
  }
}

/// The bytes of `count` elements in a buffer view, all of them known to exist.
struct Elements {
  const std::uint8_t* first;
  std::size_t stride;
};

Elements elementsIn(const tinygltf::Model& model, int viewIndex, std::size_t offset, std::size_t count,
                    std::size_t size, const std::string& where) {
  const tinygltf::BufferView& view = element(model.bufferViews, viewIndex, "bufferViews", where);
  const std::string viewName = "bufferViews[" + std::to_string(viewIndex) + "]";
  const tinygltf::Buffer& buffer = element(model.buffers, view.buffer, "buffers", viewName);
  if (view.byteOffset > buffer.data.size() || view.byteLength > buffer.data.size() - view.byteOffset)
    fail(viewName, " reaches past the end of buffers[", view.buffer, "] (", buffer.data.size(), " bytes)");
  const std::size_t stride = view.byteStride == 0 ? size : view.byteStride;
  const bool fits = offset <= view.byteLength && size <= view.byteLength - offset &&
                    count - 1 <= (view.byteLength - offset - size) / stride;
  if (count > 0 && !fits)
    fail(where, " has ", count, " elements and reaches past the end of ", viewName, " (", view.byteLength, " bytes)");
  return {buffer.data.data() + view.byteOffset + (count == 0 ? 0 : offset), stride};
}

template <typename T>
T load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// One component as a number, quantised ones scaled as glTF says: to 0..1, or to −1..1 with the lowest value clamped.
double component(const std::uint8_t* at, int type, bool normalized) {
  const auto scaled = [&](auto value) {
    const double number = static_cast<double>(value);
    return normalized ? std::max(number / static_cast<double>(std::numeric_limits<decltype(value)>::max()), -1.0)
                      : number;
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return scaled(load<std::int8_t>(at));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return scaled(load<std::uint8_t>(at));
    case TINYGLTF_COMPONENT_TYPE_SHORT: return scaled(load<std::int16_t>(at));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return scaled(load<std::uint16_t>(at));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return scaled(load<std::uint32_t>(at));
    default: return static_cast<double>(load<float>(at));
  }
}

/// Decodes an accessor into `components` numbers per element.
std::vector<double> decode(const tinygltf::Model& model, int index, int type, std::size_t components,
                           const std::string& referrer) {
  const tinygltf::Accessor& accessor = element(model.accessors, index, "accessors", referrer);
  const std::string where = "accessors[" + std::to_string(index) + "]";
  if (accessor.type != type) fail(where, ", used by ", referrer, ", does not have ", components, " components");
  const std::size_t bytes = componentSize(accessor.componentType, where);
  const auto copy = [&](double* to, const std::uint8_t* from) {
    for (std::size_t c = 0; c < components; ++c)
      to[c] = component(from + c * bytes, accessor.componentType, accessor.normalized);
  };

  const std::size_t count = accessor.count;
  if (count > kMaxSceneElements || (accessor.bufferView < 0 && count > kMaxImpliedElements))
    fail(where, " has ", count, " elements, more than can be read");
  std::vector<double> values;
  if (accessor.bufferView >= 0) {
    const Elements elements =
        elementsIn(model, accessor.bufferView, accessor.byteOffset, count, bytes * components, where);
    values.resize(count * components);
    for (std::size_t i = 0; i < count; ++i) copy(&values[i * components], elements.first + i * elements.stride);
  } else {
    values.resize(count * components);
  }
  if (!accessor.sparse.isSparse) return values;

  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > count || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0)
    fail(where, " has a sparse part that does not fit it");
  const std::size_t replaced = static_cast<std::size_t>(sparse.count);
  const int indexType = sparse.indices.componentType;
  const Elements places =
      elementsIn(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), replaced,
                 componentSize(indexType, where), where);
  const Elements fresh = elementsIn(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                                    replaced, bytes * components, where);
  for (std::size_t i = 0; i < replaced; ++i) {
    const double place = component(places.first + i * places.stride, indexType, false);
    if (!(place >= 0 && place < static_cast<double>(count)))
      fail(where, " replaces element ", place, ", which it does not have (", count, " elements)");
    copy(&values[static_cast<std::size_t>(place) * components], fresh.first + i * fresh.stride);
  }
  return values;
}

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

int attributeOf(const tinygltf::Primitive& primitive, const char* name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// A primitive in its place in the scene.
struct Instance {
  const tinygltf::Primitive& primitive;
  std::string where, name;  // In the file, and for people.
  Transform world;
};

void append(const tinygltf::Model& model, const Instance& instance, Model& out, bool& haveUvs) {
  const auto& [primitive, where, name, world] = instance;
  const int position = attributeOf(primitive, "POSITION"), texcoord = attributeOf(primitive, "TEXCOORD_0");
  if (primitive.extensions.count(kCompressions[0].first) != 0 &&
      element(model.accessors, position, "accessors", where).bufferView < 0)
    failCompressed(kCompressions[0].first, kCompressions[0].second);
  const std::vector<double> local = decode(model, position, TINYGLTF_TYPE_VEC3, 3, where + ".POSITION");
  const std::size_t vertexCount = local.size() / 3;
  std::vector<std::uint32_t> corners;
  if (primitive.indices >= 0) {
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
  const std::vector<double> uvs = decode(model, texcoord, TINYGLTF_TYPE_VEC2, 2, where + ".TEXCOORD_0");
  if (uvs.size() != vertexCount * 2)
    fail(where, ".TEXCOORD_0 has ", uvs.size() / 2, " elements for ", vertexCount, " vertices");
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

// --------------------------------------------------------------------------------------------------------------
// Writing

/// Appends an accessor over values laid out one after the other, `stride` bytes for each element.
int addAccessor(tinygltf::Model& model, std::span<const std::uint8_t> bytes, std::size_t count, std::size_t stride,
                int type, int componentType, int target) {
  std::vector<unsigned char>& data = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = bytes.size();
  view.byteStride = target == TINYGLTF_TARGET_ARRAY_BUFFER ? stride : 0;
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
    const int accessor =
        addAccessor(model, bytes, count, bytes.size() / count, type, componentType, TINYGLTF_TARGET_ARRAY_BUFFER);
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
  primitive.indices =
      addAccessor(model, asBytes(mesh.indices), mesh.indices.size(), sizeof(std::uint32_t), TINYGLTF_TYPE_SCALAR,
                  TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
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

Result readMemory(std::span<const std::uint8_t> bytes, const std::string& name, const std::string& folder, Model& out) {
  return guarded(name, [&] { out = flatten(parse(bytes, folder)); });
}

Result read(const std::string& path, Model& out) {
  std::vector<std::uint8_t> bytes;
  Result result = guarded(path, [&] {
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

Result writeMemory(const Content& content, std::vector<std::uint8_t>& out) {
  return guarded(content.name, [&] {
    const std::string bytes = serialise(content);
    out.assign(bytes.begin(), bytes.end());
  });
}

Result write(const std::string& path, const Content& content) {
  return guarded(path, [&] {
    const std::string bytes = serialise(content);
    const std::string unfinished = path + ".part";
    std::ofstream file(unfinished, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code error;
    if (file.good()) {
      std::filesystem::rename(unfinished, path, error);
      if (!error) return;
    }
    std::filesystem::remove(unfinished, error);
    fail("cannot be written (", std::strerror(errno), ")");
  });
}

}  // namespace cagecast::gltf
