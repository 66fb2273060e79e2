#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "checks.hpp"
#include "gltf/gltf.hpp"

using namespace cagecast;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using Bytes = std::vector<std::uint8_t>;

namespace {

/// A place for a file that no other run of these tests uses.
std::filesystem::path ownPath(const std::string& name) {
  return std::filesystem::temp_directory_path() / (std::to_string(std::random_device{}()) + "-" + name);
}

template <typename T>
void put(Bytes& bytes, std::initializer_list<T> values) {
  for (const T value : values) {
    bytes.resize(bytes.size() + sizeof(T));
    std::memcpy(&bytes[bytes.size() - sizeof(T)], &value, sizeof(T));
  }
}

Bytes glb(std::string json, Bytes bin = {}) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4, 0);
  Bytes out;
  const auto jsonSize = static_cast<std::uint32_t>(json.size()), binSize = static_cast<std::uint32_t>(bin.size());
  put<std::uint32_t>(out, {0x46546C67, 2, 20 + jsonSize + (bin.empty() ? 0 : 8 + binSize), jsonSize, 0x4E4F534A});
  out.insert(out.end(), json.begin(), json.end());
  if (!bin.empty()) put<std::uint32_t>(out, {binSize, 0x004E4942});
  out.insert(out.end(), bin.begin(), bin.end());
  return out;
}

/// A glTF file put together piece by piece: accessors over one buffer, one mesh of one primitive, nodes.
struct File {
  Bytes bin;
  std::string views, accessors, primitive = R"("attributes":{"POSITION":0})", nodes = R"({"mesh":0,"name":"thing"})";
  std::string sceneNodes = "0", moreMeshes, extra, buffer;  // extra: further members of the root.
  int viewCount = 0;

  /// Adds values as a buffer view; returns its number.
  template <typename T>
  int view(std::initializer_list<T> values, int stride = 0) {
    const std::size_t offset = (bin.size() + 3) / 4 * 4;
    bin.resize(offset, 0);
    put<T>(bin, values);
    views += (views.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") + std::to_string(offset) +
             R"(,"byteLength":)" + std::to_string(bin.size() - offset) +
             (stride > 0 ? R"(,"byteStride":)" + std::to_string(stride) : "") + "}";
    return viewCount++;
  }
  void accessor(int viewIndex, int componentType, const char* type, std::size_t count, const std::string& more = "") {
    accessors += (accessors.empty() ? "" : ",") + std::string("{") +
                 (viewIndex >= 0 ? R"("bufferView":)" + std::to_string(viewIndex) + "," : "") + R"("componentType":)" +
                 std::to_string(componentType) + R"(,"type":")" + type + R"(","count":)" + std::to_string(count) +
                 more + "}";
  }
  /// Adds a node to the scene again and again. @param first  The number of the first.
  void addNodes(const std::string& node, int count, int first) {
    for (int i = first; i < first + count; ++i) {
      nodes += "," + node;
      sceneNodes += "," + std::to_string(i);
    }
  }
  std::string json() const {
    const std::string held = buffer.empty() ? R"({"byteLength":)" + std::to_string(bin.size()) + "}" : buffer;
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + sceneNodes + R"(]}],"nodes":[)" + nodes +
           R"(],"meshes":[{"primitives":[{)" + primitive + R"(}]})" + moreMeshes + R"(],"accessors":[)" + accessors +
           R"(],"bufferViews":[)" + views + R"(],"buffers":[)" + held + "]" + extra + "}";
  }
  Bytes bytes() const { return glb(json(), bin); }
};

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

/// The members of a file that requires an extension.
std::string requiring(const std::string& extension) {
  return R"(,"extensionsUsed":[")" + extension + R"("],"extensionsRequired":[")" + extension + R"("])";
}

/// Five points, as floats.
File points() {
  File file;
  file.accessor(file.view<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1}), kFloat, "VEC3", 5);
  return file;
}

/// The same with the triangle 0 1 2.
File triangle() {
  File file = points();
  file.accessor(file.view<std::uint16_t>({0, 1, 2}), kUnsignedShort, "SCALAR", 3);
  file.primitive = R"("attributes":{"POSITION":0},"indices":1)";
  return file;
}

gltf::Model readable(const Bytes& bytes) {
  gltf::Model model;
  const gltf::Result result = gltf::readMemory(bytes, "file", "", model);
  INFO(result.error);
  REQUIRE(result.ok());
  return model;
}

std::string errorOf(const Bytes& bytes) {
  gltf::Model model;
  const gltf::Result result = gltf::readMemory(bytes, "thing.glb", "", model);
  CHECK_FALSE(result.ok());
  CHECK_THAT(result.error, StartsWith("thing.glb: "));
  CHECK(std::count(result.error.begin(), result.error.end(), '\n') == 0);
  return result.error;
}

/// A change of a file's JSON, and what its error says then.
struct Broken {
  const char *from, *to, *says;
};

void checkErrors(const File& file, const std::vector<Broken>& list) {
  for (const auto& [from, to, says] : list) {
    INFO(from << " becomes " << to);
    std::string json = file.json();
    REQUIRE(json.find(from) != std::string::npos);
    json.replace(json.find(from), std::strlen(from), to);
    CHECK_THAT(errorOf(glb(json, file.bin)), Contains(says));
  }
}

using Indices = std::vector<std::uint32_t>;
using Floats = std::vector<float>;

}  // namespace

// What every reader makes of a file is in tests/support/gltf-files.ts; here is what this one does besides.

TEST_CASE("a triangle is read with its name and its extent", "[gltf]") {
  File file = triangle();
  file.primitive += R"(,"material":0)";
  file.extra = R"(,"materials":[{"name":"skin"}])";
  const gltf::Model model = readable(file.bytes());
  CHECK(model.positions.size() == 15);
  CHECK(model.indices == Indices{0, 1, 2});
  CHECK(model.uvs.empty());
  CHECK(model.groups == Indices(5, 0));
  REQUIRE(model.parts.size() == 1);
  CHECK(model.parts[0].name == "thing/skin");
  CHECK(model.parts[0].vertexCount == 5);
  CHECK(model.parts[0].triangleCount == 1);
}

TEST_CASE("corners that are left over at the end are no triangle", "[gltf]") {
  CHECK(readable(points().bytes()).indices == Indices{0, 1, 2});
}

TEST_CASE("the triangles of a fan begin at its middle", "[gltf]") {
  File file = points();
  file.primitive += R"(,"mode":6)";
  CHECK(readable(file.bytes()).indices == Indices{0, 1, 2, 0, 2, 3, 0, 3, 4});
}

TEST_CASE("a scene of nothing but points and lines is an error", "[gltf]") {
  for (const char* mode : {"0", "1", "2", "3"}) {
    File file = points();
    file.primitive += std::string(R"(,"mode":)") + mode;
    CHECK_THAT(errorOf(file.bytes()), Contains("no triangles"));
  }
}

TEST_CASE("quantised numbers are decoded", "[gltf]") {
  File file;
  SECTION("integers that are not normalised keep their value") {
    file.accessor(file.view<std::int16_t>({-5, 0, 7, 0, 300, 0, 0, 0, 1, 0, -32768, 0}, 8), kShort, "VEC3", 3);
    CHECK(readable(file.bytes()).positions == Floats{-5, 0, 7, 300, 0, 0, 1, 0, -32768});
  }
  SECTION("normalised bytes") {
    file.accessor(file.view<std::int8_t>({127, -127, -128, 0, 0, 64, -64, 0, 1, 2, 3, 0}, 4), kByte, "VEC3", 3,
                  R"(,"normalized":true)");
    const Floats expected{1, -1, -1, 0, 64 / 127.0f, -64 / 127.0f, 1 / 127.0f, 2 / 127.0f, 3 / 127.0f};
    CHECK(readable(file.bytes()).positions == expected);
  }
  SECTION("normalised shorts") {
    file.accessor(file.view<std::int16_t>({32767, -32767, -32768, 0, 0, 1, 2, 0, 3, 4, 5, 0}, 8), kShort, "VEC3", 3,
                  R"(,"normalized":true)");
    const Floats positions = readable(file.bytes()).positions;
    CHECK(Floats(positions.begin(), positions.begin() + 5) == Floats{1, -1, -1, 0, 1 / 32767.0f});
  }
  SECTION("normalised UVs of bytes") {
    file = points();
    const int view = file.view<std::uint8_t>({0, 255, 0, 0, 51, 102, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0}, 4);
    file.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":1})";
    file.accessor(view, kUnsignedByte, "VEC2", 5, R"(,"normalized":true)");
    CHECK(readable(file.bytes()).uvs == Floats{0, 1, 0.2f, 0.4f, 0, 0, 0, 0, 0, 1});
  }
}

TEST_CASE("UVs are the first ones without a base colour texture, none if it names others", "[gltf]") {
  File file = triangle();
  file.accessor(file.view<float>({1, 1, 1, 1, 1, 1, 1, 1, 1, 1}), kFloat, "VEC2", 5);
  const auto withMaterial = [&](const std::string& members) {
    file.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2,"TEXCOORD_1":0},"indices":1,"material":0)";
    file.extra = R"(,"textures":[{}],"materials":[{)" + members + "}]";
    return file.bytes();
  };
  const auto transformed = [&](const std::string& members) {
    return withMaterial(
        R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{)" + members +
        "}}}}");
  };
  CHECK(readable(withMaterial(R"("emissiveTexture":{"index":0,"texCoord":1})")).uvs == Floats(10, 1));
  CHECK(readable(withMaterial(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":2}})")).uvs.empty());
  CHECK(readable(transformed("")).uvs == Floats(10, 1));
  CHECK(readable(transformed(R"("offset":[1,0])")).uvs == Floats{2, 1, 2, 1, 2, 1, 2, 1, 2, 1});
  for (const char* members : {R"("offset":[1])", R"("scale":"x")", R"("rotation":[0])", R"("scale":[1,"y"])"})
    CHECK_THAT(errorOf(transformed(members)),
               Contains("materials[0]: ") && Contains("of KHR_texture_transform is not"));
}

TEST_CASE("parts are in scene order, by the names of their nodes", "[gltf]") {
  File file = triangle();
  file.nodes = R"({"name":"a","children":[2,1]},{"name":"b","mesh":0},{"name":"c","mesh":0,"children":[3]},
                  {"name":"d","mesh":0})";
  const gltf::Model model = readable(file.bytes());
  std::vector<std::string> names;
  for (const gltf::Part& part : model.parts) names.push_back(part.name);
  CHECK(names == std::vector<std::string>{"c", "d", "b"});
  CHECK(model.groups[5] == 1);
}

namespace {

using Matrix = std::array<float, 16>;  ///< Column by column.

/// Makes smaller by `times`, then moves.
Matrix smaller(float times, float x = 0, float y = 0, float z = 0) {
  return {1 / times, 0, 0, 0, 0, 1 / times, 0, 0, 0, 0, 1 / times, 0, x, y, z, 1};
}

/// A skin as JSON, with inverse bind matrices in a new accessor, whose number is given.
std::string skinOf(File& file, const std::string& joints, std::initializer_list<Matrix> inverses, int accessor) {
  const int view = file.view<Matrix>(inverses);
  file.accessor(view, kFloat, "MAT4", inverses.size());
  return R"({"joints":)" + joints + R"(,"inverseBindMatrices":)" + std::to_string(accessor) + "}";
}

const Floats kPoints{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1};

Floats movedPoints(float x, float y, float z) {
  Floats moved = kPoints;
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    moved[i] += x;
    moved[i + 1] += y;
    moved[i + 2] += z;
  }
  return moved;
}

/// The five points, stored `times` as large, as accessor 0. The first joint holds three of them, the second two; the
/// third would hold all, with weight 0.
File heldPoints(float times = 1) {
  File file;
  file.accessor(file.view<float>({0, 0, 0, times, 0, 0, times, times, 0, 0, times, 0, 0, 0, times}), kFloat, "VEC3", 5);
  file.accessor(file.view<std::uint8_t>({0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 1, 0, 0, 2, 1, 0, 0, 2}), kUnsignedByte,
                "VEC4", 5);
  file.accessor(file.view<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), kFloat, "VEC4", 5);
  file.primitive = R"("attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2})";
  return file;
}

/// A rig of hips and a neck, 2 above, with a joint that is nowhere; and the five points, held by them.
/// @param rig, neck  Further members of these nodes.
File figure(float times, const std::string& rig = "", const std::string& neck = "") {
  File file = heldPoints(times);
  file.nodes = R"({"mesh":0,"skin":0,"translation":[9,9,9]},
                  {"name":"rig","children":[2])" +
               rig + R"(},
                  {"name":"hips","children":[3]},
                  {"name":"neck","translation":[0,2,0])" +
               neck + R"(},
                  {"name":"unused","scale":[0,0,0]})";
  file.sceneNodes = "0,1,4";
  file.extra =
      R"(,"skins":[)" + skinOf(file, "[2,3,4]", {smaller(times), smaller(times, 0, -2, 0), smaller(1)}, 3) + "]";
  return file;
}

const std::string kBent = R"(,"rotation":[0.6,0,0,0.8])";

/// Adds eyes to a figure, as a mesh of its own, of the same points.
/// @param joints  Children of the neck, the first of which holds three points, the second two.
void addEyes(File& file, const std::string& joints, const std::string& nodes, std::initializer_list<Matrix> inverses) {
  file.nodes += R"(,{"mesh":0,"skin":1})" + nodes;
  file.sceneNodes += ",5";
  file.extra.insert(file.extra.size() - 1, "," + skinOf(file, joints, inverses, 4));
}

void checkNear(const Floats& positions, const Floats& expected) {
  REQUIRE(positions.size() == expected.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    INFO("positions[" << i << "]");
    CHECK(positions[i] == Approx(expected[i]).margin(1e-6));
  }
}

Floats doubled(Floats positions) {
  const Floats again = positions;
  positions.insert(positions.end(), again.begin(), again.end());
  return positions;
}

}  // namespace

TEST_CASE("a skinned mesh at rest is where its skeleton holds it, not where its node is", "[gltf]") {
  CHECK(readable(figure(1).bytes()).positions == kPoints);
  SECTION("joints in no scene hold it as well") {
    File file = figure(1, R"(,"translation":[0,0,4])");
    file.sceneNodes = "0";
    CHECK(readable(file.bytes()).positions == movedPoints(0, 0, 4));
  }
  SECTION("joints that differ by less than a thousandth keep every bit of it") {
    CHECK(readable(figure(1, R"(,"translation":[0,1e-4,0])").bytes()).positions == kPoints);
    CHECK(readable(figure(1, "", R"(,"scale":[1.0001,1,1])").bytes()).positions == kPoints);
  }
  SECTION("of its size, that is") {
    const auto hundredfold = [](const std::string& neck) {
      File file = heldPoints(100);
      const File one = figure(1, R"(,"translation":[5,0,0])", neck);
      file.nodes = one.nodes;
      file.sceneNodes = one.sceneNodes;
      file.extra = R"(,"skins":[)" + skinOf(file, "[2,3]", {smaller(1), smaller(1, 0, -2, 0)}, 3) + "]";
      return readable(file.bytes()).positions[0];
    };
    CHECK(hundredfold(R"(,"scale":[1.0005,1,1])") == 5);
    CHECK(hundredfold(R"(,"scale":[1.002,1,1])") == 5);  // It has moved, and stands where its rig does.
  }
  SECTION("those that differ by more move it") {
    CHECK(readable(figure(1, R"(,"translation":[0,0.0078125,0])").bytes()).positions == movedPoints(0, 0.0078125f, 0));
  }
}

TEST_CASE("a rig of another unit or axis than the scene places its mesh", "[gltf]") {
  SECTION("an armature in centimetres") {
    File file = heldPoints(100);
    file.nodes = R"({"mesh":0,"skin":0},
                    {"name":"Armature","scale":[0.01,0.01,0.01],"children":[2,3]},
                    {"translation":[0,50,0]},{"translation":[0,200,0]})";
    file.sceneNodes = "1,0";
    file.extra = R"(,"skins":[)" + skinOf(file, "[2,3]", {smaller(1, 0, -50, 0), smaller(1, 0, -200, 0)}, 3) + "]";
    checkNear(readable(file.bytes()).positions, kPoints);
  }
  SECTION("mirrored: triangles are turned round") {
    const gltf::Model model = readable(figure(1, R"(,"scale":[-1,1,1])").bytes());
    CHECK(model.positions == Floats{0, 0, 0, -1, 0, 0, -1, 1, 0, 0, 1, 0, 0, 0, 1});
    CHECK(model.indices == Indices{0, 2, 1});
  }
}

TEST_CASE("a quantised skinned mesh is decoded by its inverse bind matrices", "[gltf]") {
  for (const std::string neck : {"", kBent.c_str()}) {
    File file = figure(1, R"(,"translation":[5,0,0])", neck);
    // As the tools do: numbers of -1 to 1, and matrices that make them twice as large and move them.
    file.accessors.clear();
    file.accessor(
        file.view<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0}, 8),
        kShort, "VEC3", 5, R"(,"normalized":true)");
    file.accessor(1, kUnsignedByte, "VEC4", 5);
    file.accessor(2, kFloat, "VEC4", 5);
    file.extra = R"(,"skins":[)" + skinOf(file, "[2,3]", {smaller(0.5f, -1, 0, 0), smaller(0.5f, -1, -2, 0)}, 3) + "]";
    checkNear(readable(file.bytes()).positions, {4, 0, 0, 6, 0, 0, 6, 2, 0, 4, 2, 0, 4, 0, 2});
    // Numbers that are not normalised, and matrices that only move them.
    file.accessors.clear();
    file.accessor(file.view<std::int8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 4), kByte,
                  "VEC3", 5);
    file.accessor(1, kUnsignedByte, "VEC4", 5);
    file.accessor(2, kFloat, "VEC4", 5);
    file.extra = R"(,"skins":[)" + skinOf(file, "[2,3]", {smaller(1, -1, 0, 0), smaller(1, -1, -2, 0)}, 3) + "]";
    CHECK(readable(file.bytes()).positions == movedPoints(4, 0, 0));
  }
}

TEST_CASE("a posed figure is placed by the first joint that holds it if the first of all has another size", "[gltf]") {
  File file = heldPoints(64);
  file.nodes = R"({"mesh":0,"skin":0},{"scale":[1.05,1.05,1.05]},{"translation":[0,1,0]},{"translation":[0,2,0]})";
  file.sceneNodes = "0,1,2,3";
  file.accessors.clear();
  file.accessor(0, kFloat, "VEC3", 5);
  file.accessor(file.view<std::uint8_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0}), kUnsignedByte,
                "VEC4", 5);
  file.accessor(2, kFloat, "VEC4", 5);
  file.extra = R"(,"skins":[)" + skinOf(file, "[1,2,3]", {smaller(64), smaller(64), smaller(64)}, 3) + "]";
  checkNear(readable(file.bytes()).positions, movedPoints(0, 1, 0));
}

TEST_CASE("all meshes of a figure are at rest, or none is", "[gltf]") {
  SECTION("eyes that turn with the head") {
    const auto withEyes = [](float times, const std::string& neck) {
      File file = figure(times, "", neck + R"(,"children":[6])");
      addEyes(file, "[2,6]", R"(,{"name":"eyes","translation":[0,1,0]})", {smaller(times), smaller(times, 0, -3, 0)});
      // Of the eyes' skin, the second joint alone holds them.
      file.accessor(file.view<std::uint8_t>({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}),
                    kUnsignedByte, "VEC4", 5);
      file.moreMeshes = R"(,{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":5,"WEIGHTS_0":2}}]})";
      file.nodes.replace(file.nodes.find(R"({"mesh":0,"skin":1})"), 9, R"({"mesh":1)");
      return readable(file.bytes()).positions;
    };
    CHECK(withEyes(1, "") == doubled(kPoints));
    CHECK(withEyes(1, kBent) == doubled(kPoints));
    checkNear(withEyes(32, kBent), doubled(kPoints));
  }
  SECTION("one eye has turned") {
    const auto withEyes = [](const std::string& turned) {
      File file = figure(1, R"(,"translation":[5,0,0])", R"(,"children":[6,7])");
      addEyes(file, "[6,7]", R"(,{"translation":[1,1,0])" + turned + R"(},{"translation":[-1,1,0]})",
              {smaller(1, -1, -3, 0), smaller(1, 1, -3, 0)});
      return readable(file.bytes()).positions;
    };
    CHECK(withEyes("") == doubled(movedPoints(5, 0, 0)));
    CHECK(withEyes(kBent) == doubled(movedPoints(5, 0, 0)));
  }
  SECTION("nodes that share a mesh are placed by the skin of each") {
    File file = heldPoints();
    file.nodes = R"({"mesh":0,"skin":0},{"mesh":0,"skin":1},{"mesh":0,"translation":[0,1,0]},
                    {"translation":[1,0,0]},{"translation":[2,0,0]})";
    file.sceneNodes = "0,1,2,3,4";
    file.extra = R"(,"skins":[{"joints":[3,3]},{"joints":[4,4]}])";
    Floats expected = movedPoints(1, 0, 0);
    for (const Floats& more : {movedPoints(2, 0, 0), movedPoints(0, 1, 0)})
      expected.insert(expected.end(), more.begin(), more.end());
    CHECK(readable(file.bytes()).positions == expected);
  }
}

TEST_CASE("joints that hold nothing do not place a mesh", "[gltf]") {
  File file = figure(1, R"(,"translation":[5,0,0])");
  const auto with = [&](const std::string& attributes) {
    file.primitive = R"("attributes":{"POSITION":0)" + attributes + "}";
    return readable(file.bytes()).positions;
  };
  CHECK(with("") == kPoints);
  CHECK(with(R"(,"JOINTS_0":1)") == kPoints);
  CHECK(with(R"(,"WEIGHTS_0":2)") == kPoints);
  SECTION("those that a skin does not have") {
    file.accessor(file.view<std::uint8_t>({0, 3, 0, 0, 0, 255, 0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3, 0, 0}),
                  kUnsignedByte, "VEC4", 5);
    file.accessor(file.view<std::uint8_t>({9, 9, 0, 0, 9, 9, 0, 0, 9, 9, 0, 0, 9, 9, 0, 0, 9, 9, 0, 0}), kUnsignedByte,
                  "VEC4", 5, R"(,"normalized":true)");
    CHECK(with(R"(,"JOINTS_0":4,"WEIGHTS_0":5)") == movedPoints(5, 0, 0));
  }
  SECTION("those of the second set, as it adds little") {
    file.accessor(file.view<std::uint16_t>({2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2}),
                  kUnsignedShort, "VEC4", 5);
    CHECK(with(R"(,"JOINTS_0":1,"WEIGHTS_0":2,"JOINTS_1":4,"WEIGHTS_1":2)") == movedPoints(5, 0, 0));
  }
  SECTION("those whose inverse bind matrices are missing") {
    file.extra = R"(,"skins":[)" + skinOf(file, "[2,3,4]", {smaller(1)}, 4) + "]";
    CHECK(with(R"(,"JOINTS_0":1,"WEIGHTS_0":2)") == movedPoints(5, 0, 0));
  }
  SECTION("a skin without joints") {
    file.extra = R"(,"skins":[{"joints":[]}])";
    CHECK(with(R"(,"JOINTS_0":1,"WEIGHTS_0":2)") == kPoints);
  }
}

TEST_CASE("broken skins are errors that name the element", "[gltf]") {
  File file = figure(1);
  file.accessor(1, kUnsignedByte, "VEC4", 4);
  const char *joints = R"("joints":[2,3,4],"inverseBindMatrices":3)", *nodes = R"(],"meshes")";
  checkErrors(
      file,
      {{R"("skin":0)", R"("skin":3)", "nodes[0] refers to skins[3], which does not exist (there are 1)"},
       {joints, R"("joints":[2,99])", "skins[0].joints refers to nodes[99], which does not exist (there are 5"},
       {joints, R"("joints":[2],"inverseBindMatrices":99)", "skins[0].inverseBindMatrices refers to accessors[99]"},
       {joints, R"("joints":[2],"inverseBindMatrices":0)",
        "accessors[0], used by skins[0].inverseBindMatrices, does not have 16 components"},
       {R"("JOINTS_0":1)", R"("JOINTS_0":4)", "primitives[0].JOINTS_0 has 4 elements for 5 vertices"},
       {R"("WEIGHTS_0":2)", R"("WEIGHTS_0":4)", "primitives[0].WEIGHTS_0 has 4 elements for 5 vertices"},
       {R"("JOINTS_0":1)", R"("JOINTS_0":9)", "primitives[0] refers to accessors[9]"},
       // Outside of the scene, too.
       {nodes, R"(,{"children":[6]},{},{"children":[6]}],"meshes")",
        "nodes[6] is in the file twice, or its own ancest"},
       {nodes, R"(,{"children":[9]}],"meshes")", "the file refers to nodes[9]"}});
}

TEST_CASE("skins that would take too much are refused", "[gltf]") {
  File file = figure(1);
  SECTION("many nodes with a skin of many joints") {
    std::string joints = "2";
    for (int i = 1; i < 100'000; ++i) joints += ",2";
    file.extra = R"(,"skins":[{"joints":[)" + joints + "]}]";
    file.addNodes(R"({"mesh":0,"skin":0})", 700, 5);
  }
  SECTION("many skins of one large accessor") {
    file.accessor(-1, kFloat, "MAT4", 1u << 22);
    std::string skins;
    for (int i = 0; i < 40; ++i) {
      file.addNodes(R"({"mesh":0,"skin":)" + std::to_string(i) + "}", 1, i + 5);
      skins += std::string(i > 0 ? "," : "") + R"({"joints":[2],"inverseBindMatrices":4})";
    }
    file.extra = R"(,"skins":[)" + skins + "]";
  }
  CHECK_THAT(errorOf(file.bytes()), Contains("more than"));
}

TEST_CASE("without transforms every bit of a position is kept", "[gltf]") {
  File file;
  file.accessor(file.view<float>({-0.0f, 1e-42f, 3.4e38f, 0.1f, 0.2f, 0.3f, 1, 2, 3}), kFloat, "VEC3", 3);
  const Floats positions = readable(file.bytes()).positions;
  CHECK(std::signbit(positions[0]));
  CHECK(positions[1] == 1e-42f);
  CHECK(positions[2] == 3.4e38f);
}

TEST_CASE("an origin is subtracted before positions are rounded", "[gltf]") {
  File file = triangle();
  const Floats near = readable(file.bytes()).positions;
  file.nodes = R"({"mesh":0,"translation":[1e7,-1e7,1e5]})";
  gltf::Model model;
  REQUIRE(gltf::readMemory(file.bytes(), "file", "", model, {1e7, -1e7, 1e5}).ok());
  CHECK(model.positions == near);
}

TEST_CASE("numbers that are not finite reach the library, which names them", "[gltf]") {
  File file;
  file.accessor(file.view<float>({0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 1, 1, 0}), kFloat, "VEC3", 3);
  CHECK(std::isnan(readable(file.bytes()).positions[4]));
}

namespace {

/// A folder of its own, for as long as a test runs.
struct Folder {
  std::filesystem::path path = ownPath("cagecast-gltf");
  Folder() { std::filesystem::create_directories(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
};

void save(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// The triangle as text, whose buffer is elsewhere.
std::string triangleOf(const std::string& uri) {
  File file = triangle();
  file.buffer = R"({"byteLength":)" + std::to_string(file.bin.size()) + R"(,"uri":")" + uri + R"("})";
  return file.json();
}

}  // namespace

TEST_CASE("a .gltf file refers to regular files in its folder alone", "[gltf]") {
  const Folder outside;
  const std::filesystem::path folder = outside.path / "model";
  std::filesystem::create_directories(folder / "below");
  gltf::Model model;
  const auto errorFor = [&](const std::string& uri) {
    std::ofstream(folder / "thing.gltf") << triangleOf(uri);
    return gltf::read((folder / "thing.gltf").string(), model).error;
  };
  CHECK_THAT(errorFor("beside%20it.bin"), Contains("thing.gltf: ") && Contains("missing: beside it.bin"));
  for (const std::filesystem::path& path :
       {outside.path / "out.bin", folder / "below" / "in.bin", folder / "beside it.bin"})
    save(path, triangle().bin);
  std::filesystem::create_symlink(outside.path / "out.bin", folder / "link.bin");
  REQUIRE(mkfifo((folder / "pipe.bin").c_str(), 0600) == 0);

  for (const char* uri : {"beside%20it.bin", "below/in.bin"}) {
    CHECK(errorFor(uri).empty());
    CHECK(model.indices == Indices{0, 1, 2});
  }
  for (const char* uri : {"../out.bin", "link.bin", "pipe.bin", "below"})
    CHECK_THAT(errorFor(uri), Contains("thing.gltf: refers to ") && Contains(uri) &&
                                  Contains("not a regular file in the folder of the model"));
}

TEST_CASE("a .gltf file in memory without a folder refers to no files", "[gltf]") {
  const std::string name = ownPath("here.bin").filename().string();
  save(name, triangle().bin);
  const std::string json = triangleOf(name);
  CHECK_THAT(errorOf({json.begin(), json.end()}), Contains("not a regular file in the folder of the model"));
  std::filesystem::remove(name);
}

TEST_CASE("images are not read", "[gltf]") {
  File file = triangle();
  file.extra =
      R"(,"images":[{"uri":"nowhere.png"},{"bufferView":0,"mimeType":"image/png"},{"uri":"data:image/png;base64,AAAA"}])";
  CHECK(readable(file.bytes()).indices.size() == 3);
}

TEST_CASE("an error names a file that is missing, empty, a folder or not glTF", "[gltf]") {
  gltf::Model model;
  CHECK_THAT(gltf::read("/nowhere/at-all.glb", model).error, StartsWith("/nowhere/at-all.glb: cannot be read"));
  CHECK_THAT(gltf::read(std::filesystem::temp_directory_path().string(), model).error, Contains("cannot be read"));
  CHECK_THAT(errorOf({}), Contains("empty"));
  CHECK_THAT(errorOf({'\n', ' '}), Contains("empty"));
  CHECK_THAT(errorOf({'P', 'K', 3, 4, 0, 0}), Contains("not a glTF file"));
  CHECK_THAT(errorOf({'{', '}'}), Contains("not valid glTF"));
  CHECK_THAT(errorOf({'{', '"', 'a', '"', ':'}), Contains("not valid glTF"));
  const std::string old = R"({"asset":{"version":"1.0"}})";
  CHECK_THAT(errorOf({old.begin(), old.end()}), Contains("version 1.0, not 2"));
}

TEST_CASE("a GLB cut short anywhere is an error", "[gltf]") {
  const Bytes whole = triangle().bytes();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    INFO("cut to " << size << " of " << whole.size());
    const std::string error = errorOf({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    if (size >= 20) CHECK_THAT(error, Contains("truncated"));
  }
}

TEST_CASE("a GLB cut short with its header mended is an error", "[gltf]") {
  const Bytes whole = triangle().bytes();
  for (std::size_t size = 12; size < whole.size(); ++size) {
    Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto length = static_cast<std::uint32_t>(size);
    std::memcpy(&cut[8], &length, 4);
    INFO("cut to " << size << " of " << whole.size());
    (void)errorOf(cut);
  }
}

TEST_CASE("a GLB with any byte changed is read or refused, never worse", "[gltf]") {
  scenes::Random random(firstSeed());
  for (const Bytes& whole : {triangle().bytes(), figure(1).bytes()})
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const auto value :
           {std::uint8_t{0}, std::uint8_t{255}, std::uint8_t{'9'}, static_cast<std::uint8_t>(random.below(256))}) {
        Bytes changed = whole;
        changed[i] = value;
        gltf::Model model;
        const gltf::Result result = gltf::readMemory(changed, "file", "", model);
        if (!result.ok()) continue;
        for (const std::uint32_t index : model.indices) REQUIRE(index < model.positions.size() / 3);
      }
    }
}

TEST_CASE("Draco as it is in the wild, accessors without data, is an error that names it", "[gltf]") {
  for (const std::string& extra : {std::string(), requiring("KHR_draco_mesh_compression")}) {
    File file;
    file.accessor(-1, kFloat, "VEC3", 3);
    file.accessor(-1, kUnsignedShort, "SCALAR", 3);
    file.view<std::uint32_t>({0});
    file.primitive =
        R"("attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}})";
    file.extra = extra;
    CHECK_THAT(errorOf(file.bytes()), Contains("Draco"));
  }
}

TEST_CASE("broken references are errors that name them", "[gltf]") {
  File file = triangle();
  file.accessor(-1, kFloat, "VEC3", 0);
  const char *indices = R"("indices":1)", *count = R"("VEC3","count":5)", *node = R"({"mesh":0,"name":"thing"})";
  const char *view = R"("byteOffset":0,"byteLength":60)", *type = R"(5126,"type":"VEC3","count":5)";
  checkErrors(
      file,
      {{indices, R"("indices":0)", "primitives[0].indices has component type 5126"},
       {indices, R"("mode":7)", "meshes[0].primitives[0].mode = 7"},
       {indices, R"("mode":-2)", "meshes[0].primitives[0].mode = -2"},
       {count, R"("VEC3","count":6)", "bufferViews[0] (60 bytes)"},
       {count, R"("VEC3","count":6)", "accessors[0]"},
       {count, R"("VEC3","count":3,"byteOffset":4000000000)", "accessors[0]"},
       {view, R"("byteOffset":60,"byteLength":60)", "bufferViews[0] reaches past the end of buffers[0]"},
       {view, R"("byteOffset":18446744073709551600,"byteLength":60)", ""},
       {R"({"buffer":0)", R"({"buffer":7)", "buffers[7]"},
       {R"("POSITION":0)", R"("POSITION":9)", "accessors[9]"},
       {node, R"({"mesh":3})", "meshes[3]"},
       {indices, R"("indices":1,"material":3)", "materials[3]"},
       {R"("scenes":[{"nodes":[0)", R"("scenes":[{"nodes":[5)", "nodes[5]"},
       {type, R"(5127,"type":"VEC3","count":5)", ""},
       {node, R"({"mesh":0,"matrix":[1,2,3,4,5]})", "nodes[0].matrix has 5 numbers, not 16"},
       {node, R"({"mesh":0,"children":[1]},{"children":[0]})", "its own ancestor"},
       {node, R"({"children":[1,1]},{"mesh":0})", "twice"},
       {count,
        R"("VEC3","count":2,"sparse":{"count":2,"indices":{"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":0}})",
        "replaces element 2"}});
  for (const auto& [attributes, says] : {std::pair{R"("TRANSLATION":99)", "nodes[0] refers to accessors[99]"},
                                         {R"("ROTATION":0)", "used by nodes[0].ROTATION, does not have 4 components"},
                                         {R"("TRANSLATION":2)", "nodes[0] has no instance"}}) {
    file.nodes =
        std::string(R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)") + attributes + "}}}}";
    CHECK_THAT(errorOf(file.bytes()), Contains(says));
  }
}

TEST_CASE("compression that is required is an error that names it", "[gltf]") {
  for (const auto& [extension, says] :
       {std::pair{"KHR_draco_mesh_compression", "Draco"}, {"EXT_meshopt_compression", "meshopt"}}) {
    File file = triangle();
    file.extra = requiring(extension);
    CHECK_THAT(errorOf(file.bytes()), Contains(says));
    // With a buffer that is not there.
    file.buffer = R"({"byteLength":)" + std::to_string(file.bin.size()) +
                  R"(},{"byteLength":100,"extensions":{"EXT_meshopt_compression":{"fallback":true}}})";
    CHECK_THAT(errorOf(file.bytes()), Contains(says));
  }
}

TEST_CASE("hostile files are refused", "[gltf]") {
  File file = triangle();
  file.extra = R"(,"extras":)" + std::string(200'000, '[') + std::string(200'000, ']');
  CHECK_THAT(errorOf(file.bytes()), Contains("nested"));
  file = triangle();
  file.accessor(-1, kFloat, "VEC3", 1u << 22);
  file.primitive = R"("attributes":{"POSITION":2})";
  file.addNodes(R"({"mesh":0})", 40, 1);
  CHECK_THAT(errorOf(file.bytes()), Contains("more than"));
}

TEST_CASE("counts larger than the data in the file are refused", "[gltf]") {
  for (const std::size_t count : {std::size_t{100'000'000}, std::size_t{4'294'967'295}, std::size_t{1} << 62})
    for (const int view : {-1, 0}) {
      File file;
      file.view<float>({0, 0, 0});
      file.accessor(view, kFloat, "VEC3", count);
      CHECK_THAT(errorOf(file.bytes()), Contains("elements"));
    }
}

TEST_CASE("brackets in a string are not nesting", "[gltf]") {
  File file = triangle();
  file.extra = R"(,"extras":{"a":"\")" + std::string(1000, '[') + "\"}";
  CHECK(readable(file.bytes()).indices.size() == 3);
}

TEST_CASE("what is written is read back", "[gltf]") {
  const scenes::Scene scene = scenes::head(8);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view());
  gltf::Content content;
  content.mesh = scene.target.view();
  content.uvs1 = result.projection.uvs;
  content.zones = {result.zones.zones.data(), result.zones.zones.size()};
  content.name = "head";
  Bytes bytes;
  REQUIRE(gltf::writeMemory(content, bytes).ok());
  const gltf::Model model = readable(bytes);
  CHECK(model.positions == scene.target.positions);
  CHECK(model.indices == scene.target.indices);
  CHECK(model.uvs == scene.target.uvs);
  CHECK(model.parts[0].name == "head");
  const std::string text(bytes.begin(), bytes.end());
  CHECK_THAT(text, Contains("TEXCOORD_1") && Contains("_NCZ"));

  const std::string path = ownPath("cagecast-write-test.glb").string();
  REQUIRE(gltf::write(path, content).ok());
  gltf::Model again;
  REQUIRE(gltf::read(path, again).ok());
  CHECK(again.positions == model.positions);
  CHECK_FALSE(std::filesystem::exists(path + ".part"));
  std::filesystem::remove(path);
}

TEST_CASE("what cannot be written is an error, and leaves no file", "[gltf]") {
  const scenes::Mesh mesh = scenes::box({}, {1, 1, 1}, 1);
  gltf::Content content;
  content.mesh = mesh.view();
  CHECK_THAT(gltf::write("/nowhere/at-all/out.glb", content).error,
             StartsWith("/nowhere/at-all/out.glb: cannot be written"));
  const std::string path = ownPath("cagecast-not-written.glb").string();
  scenes::Mesh bad = mesh;
  bad.positions[4] = std::numeric_limits<float>::infinity();
  content.mesh = bad.view();
  CHECK_THAT(gltf::write(path, content).error, Contains("positions[4] = inf"));
  bad = mesh;
  bad.indices[3] = 24;
  content.mesh = bad.view();
  CHECK_THAT(gltf::write(path, content).error, Contains("indices[3] = 24 is out of range (24 vertices)"));
  content.mesh = mesh.view();
  const Floats few(5);
  content.uvs1 = few;
  CHECK_THAT(gltf::write(path, content).error, Contains("uvs1 has 5 values for 24 vertices"));
  content.uvs1 = {};
  content.name = "not UTF-8: \xff";
  CHECK_THAT(gltf::write(path, content).error, Contains("cannot be written"));
  CHECK_FALSE(std::filesystem::exists(path));
}
