#include "parse.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>

namespace cagecast::gltf {
namespace {

static_assert(std::endian::native == std::endian::little, "buffers are read as they lie in the file");

// tinygltf descends into `extras` by recursion: a limit on nesting keeps a hostile file from exhausting the stack.
constexpr int kMaxJsonDepth = 200;
// Elements that nothing in the file stands for (an accessor without a buffer view) cost an attacker no bytes.
constexpr std::size_t kMaxImpliedElements = 1u << 22;

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

/// Reads a file for tinygltf, which by itself would read any file, and wait for a pipe for ever.
/// @param folder  The `std::string` that names the folder in which the file must be, links followed.
bool readBeside(std::vector<unsigned char>* bytes, std::string* error, const std::string& path, void* folder) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path real = fs::canonical(path, ignored), root = fs::canonical(*static_cast<std::string*>(folder), ignored);
  if (root.empty() || std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first != root.end() ||
      !fs::is_regular_file(real, ignored)) {
    *error = "not a regular file in the folder of the model";
    return false;
  }
  return tinygltf::ReadWholeFile(bytes, error, path, nullptr);
}

/// tinygltf's functions for files. Newer versions have one more, for a limit that is not used here, and demand all.
template <typename Callbacks>
Callbacks filesBeside(std::string& folder) {
  Callbacks callbacks{};
  callbacks.FileExists = [](const std::string& path, void*) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
  };
  callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
  callbacks.ReadWholeFile = readBeside;
  callbacks.WriteWholeFile = tinygltf::WriteWholeFile;
  if constexpr (requires { callbacks.GetFileSizeInBytes; })
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string&, void*) {
      *size = 0;
      return true;
    };
  callbacks.user_data = &folder;
  return callbacks;
}

}  // namespace

void failCompressed(const char* extension, const char* name) {
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
  std::string root = folder;  // The callbacks get it by a pointer that is not const.
  loader.SetFsCallbacks(filesBeside<tinygltf::FsCallbacks>(root));
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
    if (error.rfind("File read error : ", 0) == 0) fail("refers to a file that cannot be read: ", error.substr(18));
    fail("is not valid glTF (", error.empty() ? "cannot be parsed" : error, ")");
  }
  if (model.asset.version.rfind("2.", 0) != 0) fail("is glTF version ", model.asset.version, ", not 2");
  return model;
}

namespace {

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

/// Where an accessor says its elements are.
struct Range {
  int view;
  std::size_t offset, count;
  std::size_t size;  ///< Of an element, in bytes.
};

Elements elementsIn(const tinygltf::Model& model, const Range& range, const std::string& where) {
  const auto [viewIndex, offset, count, size] = range;
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

}  // namespace

int attributeOf(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

void checkIndexType(int componentType, const std::string& where) {
  if (componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT && componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    fail(where, " has component type ", componentType, ", not 5121, 5123 or 5125");
}

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
        elementsIn(model, {accessor.bufferView, accessor.byteOffset, count, bytes * components}, where);
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
  checkIndexType(indexType, where + ".sparse.indices");
  const Elements places = elementsIn(model,
                                     {sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                                      replaced, componentSize(indexType, where)},
                                     where);
  const Elements fresh = elementsIn(
      model,
      {sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), replaced, bytes * components},
      where);
  for (std::size_t i = 0; i < replaced; ++i) {
    const double place = component(places.first + i * places.stride, indexType, false);
    if (!(place >= 0 && place < static_cast<double>(count)))
      fail(where, " replaces element ", place, ", which it does not have (", count, " elements)");
    copy(&values[static_cast<std::size_t>(place) * components], fresh.first + i * fresh.stride);
  }
  return values;
}

}  // namespace cagecast::gltf
