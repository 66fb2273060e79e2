// Cuts the borders of any scene, unless they are too complex: new vertices are blends of corners of their triangle, and
// triangles keep their place.

#include "cagecast/clip.hpp"

#include <cmath>

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Scene scene(input);
  Workspace workspace;
  TransferResult result;
  if (!transfer(scene.cage.view(), scene.target.view(), scene.options, workspace, result).ok()) return 0;
  const DecidedTarget target{scene.target.view(), result.zones.zones, result.projection.segments,
                             result.zones.culledBy};
  CutTarget cut;
  const Status status = cutBorders(scene.cage.view(), target, scene.options, workspace, cut);
  if (status.code == Code::bordersTooComplex) return 0;
  require(status.ok());
  const std::size_t vertices = scene.target.positions.size() / 3, added = cut.sources.size() / 3;
  require(cut.weights.size() == 3 * added && cut.zones.size() == vertices + added);
  for (std::size_t n = 0; n < added; ++n) {
    double sum = 0;
    for (std::size_t i = 3 * n; i < 3 * n + 3; ++i) {
      require(cut.sources[i] < vertices && cut.weights[i] >= 0 && cut.weights[i] <= 1);
      sum += static_cast<double>(cut.weights[i]);
    }
    require(sum == 1);
  }
  for (const std::uint32_t index : cut.indices) require(index < vertices + added);
  for (const float uv : cut.uvs) require(std::isfinite(uv));
  require(std::is_sorted(cut.origins.begin(), cut.origins.end()));
  for (const std::uint32_t triangle : cut.origins) require(3 * std::size_t{triangle} < scene.target.indices.size());
  return 0;
}
