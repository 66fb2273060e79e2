#include <iostream>

#include "assets.hpp"

using namespace cagecast;

TEST_CASE("the answer is the reference's on real models", "[assets]") {
  for (const std::filesystem::path& folder : assetFolders()) {
    const gltf::Model target = readAsset(folder / "target.glb");
    for (const std::filesystem::path& file : std::filesystem::directory_iterator(folder)) {
      if (file.filename().string().rfind("cage", 0) != 0) continue;
      const gltf::Model cage = readAsset(file);
      for (const bool grouped : {false, true}) {
        MeshView view = target.view();
        if (!grouped) view.groups = {};
        const std::string name = folder.filename().string() + "/" + file.filename().string() +
                                 (grouped ? ", parts apart" : ", welded across parts");
        for (const bool isPreset : {false, true}) {
          TransferOptions options = isPreset ? TransferOptions{} : TransferOptions::paper();
          options.seams = Seams::vertex;  // They have tests of their own.
          const reference::Differences found = requireSameAsReference(name, cage.view(), view, options);
          std::cout << name << (isPreset ? ", default" : ", paper") << ": " << found.total() << " differences at "
                    << found.vertices << " vertices, " << found.unstable << " unstable\n";
          CHECK(found.unstable * 100 <= found.vertices);
        }
      }
    }
  }
}
