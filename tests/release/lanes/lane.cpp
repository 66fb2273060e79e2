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

void fail(const Status& status) {
  std::fprintf(stderr, "%s\n", describe(status, {}, {}).c_str());
  std::exit(1);
}

Hash hashOf(const TransferOptions& options, bool isPaper) {
  Hash hash;
  Workspace workspace;
  for (const scenes::Scene& scene : scenes::golden()) {
    TransferResult result;
    const Status status = transfer(scene.cage.view(), scene.target.view(), options, workspace, result);
    if (!status.ok()) fail(status);
    hash.add(result);
    if (!isPaper) hash.add(result.zones.cosmeticTriangles);
  }
  return hash;
}

Hash hashOfCuts() {
  Hash hash;
  Workspace workspace;
  for (const Seams seams : {Seams::vertex, Seams::corner}) {
    TransferOptions options;
    options.seams = seams;
    for (const scenes::Scene& scene : scenes::goldenBorders()) {
      TransferResult result;
      const MeshView target = scene.target.view();
      if (const Status status = transfer(scene.cage.view(), target, options, workspace, result); !status.ok())
        fail(status);
      CutTarget cut;
      const DecidedTarget decided{target, result.zones.zones, result.projection.segments, result.zones.culledBy};
      if (const Status status = cutBorders(scene.cage.view(), decided, options, workspace, cut); !status.ok())
        fail(status);
      hash.add(cut);
    }
  }
  return hash;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    writeScenes(argv[1] + std::string("/golden.bin"), scenes::golden());
    writeScenes(argv[1] + std::string("/borders.bin"), scenes::goldenBorders());
  }
  std::printf("%s %s %s\n", hashOf(TransferOptions::paper(), true).text().c_str(),
              hashOf(TransferOptions{}, false).text().c_str(), hashOfCuts().text().c_str());
}
