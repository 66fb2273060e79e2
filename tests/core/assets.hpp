#pragma once

#include <algorithm>
#include <filesystem>

#include "checks.hpp"
#include "gltf/gltf.hpp"

/// Real models, where there are any.
namespace cagecast {

/// The folders in the one that CAGECAST_ASSETS names, by name: each has a target.glb and a cage.glb. If it is not set
/// there are none, and a line says so; if there is no model in it the test fails.
inline std::vector<std::filesystem::path> assetFolders() {
  const char* all = std::getenv("CAGECAST_ASSETS");
  std::vector<std::filesystem::path> folders;
  if (all == nullptr) {
    WARN("CAGECAST_ASSETS is not set: no real models were looked at");
    return folders;
  }
  for (const std::filesystem::path& folder : std::filesystem::directory_iterator(all)) {
    if (std::filesystem::exists(folder / "target.glb") && std::filesystem::exists(folder / "cage.glb"))
      folders.push_back(folder);
  }
  INFO("CAGECAST_ASSETS=" << all);
  REQUIRE_FALSE(folders.empty());
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// Reads a model that can be read.
inline gltf::Model readAsset(const std::filesystem::path& file) {
  gltf::Model model;
  const gltf::Result result = gltf::read(file.string(), model);
  INFO(result.error);
  REQUIRE(result.ok());
  return model;
}

}  // namespace cagecast
