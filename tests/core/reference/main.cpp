/// Writes the scenes of these tests as files, for hosts in other languages and for measurements.
///
///     cagecast_reference --golden FOLDER   the scenes of the golden hashes, in their order: paper-0.scene,
///                                          default-0.scene, borders-0.scene and so on
///     cagecast_reference --traps FOLDER    the models made to be difficult: NAME.scene, and NAME.truth, u8 per target
///                                          vertex: 0 to be painted, 1 not to be, 2 either; to a multiple of 4 bytes
///
/// A scene, little-endian: "CAGESCN1", then the cage, then the target, each as u32 vertexCount, u32 indexCount,
/// u8 hasUvs, u8 hasGroups, two bytes 0, f32 positions, u32 indices, f32 uvs (if any), u32 groups (if any).

#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scenes.hpp"
#include "scenes/traps.hpp"

namespace {

using namespace cagecast;

static_assert(std::endian::native == std::endian::little, "the files are written as they lie in memory");

template <typename T>
void put(std::vector<char>& out, const T* values, std::size_t count) {
  if (count == 0) return;
  const std::size_t start = out.size();
  out.resize(start + count * sizeof(T));
  std::memcpy(out.data() + start, values, count * sizeof(T));
  out.resize((out.size() + 3) / 4 * 4);
}

void putMesh(std::vector<char>& out, const scenes::Mesh& mesh) {
  const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh.vertexCount()),
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
  if (file.flush()) return true;
  std::fprintf(stderr, "cagecast_reference: %s cannot be written\n", path.c_str());
  return false;
}

bool saveScene(const std::string& path, const scenes::Scene& scene) {
  std::vector<char> out;
  put(out, "CAGESCN1", 8);
  putMesh(out, scene.cage);
  putMesh(out, scene.target);
  return save(path, out);
}

bool writeGolden(const std::string& folder) {
  const std::pair<const char*, std::vector<scenes::Scene>> kinds[] = {
      {"paper", scenes::golden()}, {"default", scenes::goldenDefault()}, {"borders", scenes::goldenBorders()}};
  for (const auto& [kind, all] : kinds) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!saveScene(folder + "/" + kind + "-" + std::to_string(i) + ".scene", all[i])) return false;
    }
  }
  return true;
}

bool writeTraps(const std::string& folder) {
  for (const scenes::Trap& trap : scenes::traps()) {
    const std::string path = folder + "/" + trap.scene.name;
    std::vector<char> truth;
    put(truth, trap.truth.data(), trap.truth.size());
    if (!saveScene(path + ".scene", trap.scene) || !save(path + ".truth", truth)) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc == 3 ? argv[1] : "";
  if (what == "--golden") return writeGolden(argv[2]) ? 0 : 1;
  if (what == "--traps") return writeTraps(argv[2]) ? 0 : 1;
  std::fputs("usage: cagecast_reference --golden|--traps FOLDER\n", stderr);
  return 1;
}
