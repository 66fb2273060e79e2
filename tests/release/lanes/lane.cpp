/// Prints the hashes of the answers on fixed scenes: of the preset `paper`, of `default`, and of cut borders. Every
/// build prints the same. With a folder it also writes the scenes there, for builds in other languages.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "cagecast/clip.hpp"
#include "hash.hpp"
#include "scenes/scenes.hpp"

using namespace cagecast;

namespace {

/// A mesh's numbers as tests/release/lanes/hashes.ts reads them.
void write(std::ofstream& file, const scenes::Mesh& mesh) {
  const auto put = [&](const auto& values) {
    const auto count = static_cast<std::uint32_t>(values.size());
    file.write(reinterpret_cast<const char*>(&count), sizeof count);
    file.write(reinterpret_cast<const char*>(values.data()), std::streamsize{4} * count);
  };
  put(mesh.positions);
  put(mesh.indices);
  put(mesh.uvs);
  put(mesh.groups);
}

void writeScenes(const std::string& path, const std::vector<scenes::Scene>& all) {
  std::ofstream file(path, std::ios::binary);
  for (const scenes::Scene& scene : all) {
    write(file, scene.cage);
    write(file, scene.target);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const std::string folder = argv[1];
    writeScenes(folder + "/paper.bin", scenes::golden());
    writeScenes(folder + "/default.bin", scenes::goldenDefault());
    writeScenes(folder + "/borders.bin", scenes::goldenBorders());
  }
  const GoldenHashes hashes = GoldenHashes::compute();
  std::printf("%s %s %s\n", hashes.paper.c_str(), hashes.standard.c_str(), hashes.borders.c_str());
}
