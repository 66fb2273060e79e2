/// Runs the brute-force reference, or the library itself, over one scene file, so that hosts in other languages can
/// compare their answer with it on exactly the same arrays.
///
///     cagecast_reference SCENE RESULT [--threshold T] [--product]
///     cagecast_reference --golden FOLDER
///
/// The second form writes the scenes of the golden hash as FOLDER/0.scene, FOLDER/1.scene and so on, in their order.
///
/// SCENE, little-endian: "CAGESCN1", then the cage, then the target, each as u32 vertexCount, u32 indexCount,
/// u8 hasUvs, u8 hasGroups, two bytes 0, f32 positions, u32 indices, f32 uvs (if any), u32 groups (if any).
/// RESULT: "CAGEREF1", u32 vertexCount, u32 segmentCount, f32 uvs (2 per vertex), u8 zones (then to a multiple of 4),
/// u32 triangles, f32 distances, u32 segments, u8 stable (then to a multiple of 4), and per segment u32 points,
/// u32 culled, f64 exposed area, f64 covered area. Exit code 1, and a line on stderr, if it cannot be done.

#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "reference.hpp"
#include "scenes.hpp"

namespace {

using namespace cagecast;

static_assert(std::endian::native == std::endian::little, "the files are written as they lie in memory");

struct Mesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;
  MeshView view() const { return {positions, indices, uvs, groups}; }
};

/// Takes values off the front of a file's bytes.
struct Reader {
  std::vector<char> bytes;
  std::size_t at = 0;
  bool good = true;

  template <typename T>
  void take(std::vector<T>& values, std::size_t count) {
    good = good && count <= (bytes.size() - at) / sizeof(T);
    if (!good) return;
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), bytes.data() + at, count * sizeof(T));
    at += count * sizeof(T);
  }
};

bool takeMesh(Reader& in, Mesh& mesh) {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint8_t> flags;
  in.take(counts, 2);
  in.take(flags, 4);
  if (!in.good) return false;
  in.take(mesh.positions, std::size_t{counts[0]} * 3);
  in.take(mesh.indices, counts[1]);
  if (flags[0] != 0) in.take(mesh.uvs, std::size_t{counts[0]} * 2);
  if (flags[1] != 0) in.take(mesh.groups, counts[0]);
  return in.good;
}

template <typename T>
void put(std::vector<char>& out, const T* values, std::size_t count) {
  if (count == 0) return;
  const std::size_t start = out.size();
  out.resize(start + count * sizeof(T));
  std::memcpy(out.data() + start, values, count * sizeof(T));
  out.resize((out.size() + 3) / 4 * 4);
}

void putMesh(std::vector<char>& out, const MeshView& mesh) {
  const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh.positions.size() / 3),
                                  static_cast<std::uint32_t>(mesh.indices.size())};
  const std::uint8_t flags[] = {!mesh.uvs.empty(), !mesh.groups.empty(), 0, 0};
  put(out, counts, 2);
  put(out, flags, 4);
  put(out, mesh.positions.data(), mesh.positions.size());
  put(out, mesh.indices.data(), mesh.indices.size());
  put(out, mesh.uvs.data(), mesh.uvs.size());
  put(out, mesh.groups.data(), mesh.groups.size());
}

bool save(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(file.flush());
}

int fail(const std::string& message) {
  std::fprintf(stderr, "cagecast_reference: %s\n", message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--golden") {
    int number = 0;
    for (const scenes::Scene& scene : scenes::golden()) {
      std::vector<char> out;
      put(out, "CAGESCN1", 8);
      putMesh(out, scene.cage.view());
      putMesh(out, scene.target.view());
      const std::string path = std::string(argv[2]) + "/" + std::to_string(number++) + ".scene";
      if (!save(path, out)) return fail(path + " cannot be written");
    }
    return 0;
  }
  TransferOptions options;
  bool useProduct = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--product") {
      useProduct = true;
    } else if (argument == "--threshold" && i + 1 < argc) {
      char* end = nullptr;
      options.threshold = static_cast<float>(std::strtod(argv[++i], &end));
      if (*end != '\0') return fail("--threshold " + std::string(argv[i]) + " is not a number");
    } else {
      files.emplace_back(argument);
    }
  }
  if (files.size() != 2) return fail("usage: cagecast_reference SCENE RESULT [--threshold T] [--product]");

  std::ifstream file(files[0], std::ios::binary);
  if (!file) return fail(files[0] + " cannot be read");
  Reader in{{std::istreambuf_iterator<char>(file), {}}};
  std::vector<char> magic;
  in.take(magic, 8);
  if (!in.good || std::memcmp(magic.data(), "CAGESCN1", 8) != 0) return fail(files[0] + " is not a scene file");
  Mesh cage, target;
  if (!takeMesh(in, cage) || !takeMesh(in, target)) return fail(files[0] + " is truncated");

  // The reference takes valid meshes only, so the library is asked first either way.
  TransferResult product;
  const Status status = transfer(cage.view(), target.view(), options, product);
  if (!status.ok()) return fail(describe(status, cage.view(), target.view()));

  std::vector<char> out;
  const auto write = [&](const auto& answer, const auto& zones, const auto& stable) {
    const std::uint32_t vertexCount = static_cast<std::uint32_t>(zones.size());
    const std::uint32_t segmentCount = static_cast<std::uint32_t>(answer.segmentStats.size());
    put(out, "CAGEREF1", 8);
    put(out, &vertexCount, 1);
    put(out, &segmentCount, 1);
    put(out, answer.uvs.data(), answer.uvs.size());
    put(out, zones.data(), zones.size());
    put(out, answer.triangles.data(), answer.triangles.size());
    put(out, answer.distances.data(), answer.distances.size());
    put(out, answer.segments.data(), answer.segments.size());
    put(out, stable.data(), stable.size());
    for (const SegmentStats& stats : answer.segmentStats) {
      const std::uint32_t counts[] = {stats.points, stats.culled ? 1u : 0u};
      const double areas[] = {stats.exposedArea, stats.coveredArea};
      put(out, counts, 2);
      put(out, areas, 2);
    }
  };
  if (useProduct) {
    write(product.projection, product.zones.zones, std::vector<std::uint8_t>(product.zones.zones.size(), 1));
  } else {
    const reference::Result result = reference::transfer(cage.view(), target.view(), options);
    write(result, result.zones, result.stable);
  }
  if (!save(files[1], out)) return fail(files[1] + " cannot be written");
}
