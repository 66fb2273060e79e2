#include <filesystem>
#include <iostream>

#include "checks.hpp"
#include "gltf/gltf.hpp"

using namespace cagecast;

// Real models, where there are any: CAGECAST_ASSETS names a folder of folders with a target.glb and a cage.glb.
TEST_CASE("the answer is the reference's on real models", "[assets]") {
  const char* folder = std::getenv("CAGECAST_ASSETS");
  if (folder == nullptr) {
    WARN("CAGECAST_ASSETS is not set: no real models were compared");
    return;
  }
  std::size_t models = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string path = entry.path().string();
    if (!std::filesystem::exists(path + "/target.glb") || !std::filesystem::exists(path + "/cage.glb")) continue;
    gltf::Model target;
    const gltf::Result readTarget = gltf::read(path + "/target.glb", target);
    INFO(readTarget.error);
    REQUIRE(readTarget.ok());
    for (const auto& file : std::filesystem::directory_iterator(path)) {
      if (file.path().filename().string().rfind("cage", 0) != 0) continue;
      gltf::Model cage;
      const gltf::Result readCage = gltf::read(file.path().string(), cage);
      INFO(readCage.error);
      REQUIRE(readCage.ok());
      ++models;
      for (const bool grouped : {false, true}) {
        MeshView view = target.view();
        if (!grouped) view.groups = {};
        const std::string name = entry.path().filename().string() + "/" + file.path().filename().string() +
                                 (grouped ? ", parts apart" : ", welded across parts");
        for (const bool isPreset : {false, true}) {
          TransferOptions options = isPreset ? TransferOptions::standard() : TransferOptions::paper();
          options.seams = Seams::vertex;  // They have tests of their own.
          const reference::Differences found = requireSameAsReference(name, cage.view(), view, options);
          std::cout << name << (isPreset ? ", default" : ", paper") << ": " << found.total() << " differences at "
                    << found.vertices << " vertices, " << found.unstable << " unstable\n";
          CHECK(found.unstable * 100 <= found.vertices);
        }
      }
    }
  }
  CHECK(models > 0);
}
