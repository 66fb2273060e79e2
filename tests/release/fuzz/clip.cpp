// Cuts the borders of any scene, unless they are too complex: new vertices are blends of corners of their triangle, and
// triangles keep their place.

#include "cagecast/clip.hpp"

#include <cmath>

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

namespace {

/// A vertex's weights of the second and the third corner of a target triangle.
struct Weights {
  double v = 0, w = 0;
};

/// The area of the pieces of each target triangle, as a share of its own.
std::vector<double> areasOfPieces(const MeshView& target, const CutTarget& cut) {
  std::vector<double> areas(target.indices.size() / 3);
  const std::size_t vertices = target.positions.size() / 3;
  for (std::size_t t = 0; t < cut.origins.size(); ++t) {
    const std::uint32_t* corners = target.indices.data() + std::size_t{3} * cut.origins[t];
    Weights at[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto add = [&, &weights = at[k]](std::uint32_t source, double weight) {
        if (source == corners[1]) weights.v += weight;
        if (source == corners[2]) weights.w += weight;
      };
      const std::uint32_t vertex = cut.indices[3 * t + k];
      if (vertex < vertices) add(vertex, 1);
      for (std::size_t i = 0; i < 3 && vertex >= vertices; ++i) {
        const std::size_t n = 3 * (vertex - vertices) + i;
        add(cut.sources[n], static_cast<double>(cut.weights[n]));
      }
    }
    areas[cut.origins[t]] += (at[1].v - at[0].v) * (at[2].w - at[0].w) - (at[1].w - at[0].w) * (at[2].v - at[0].v);
  }
  return areas;
}

}  // namespace

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
  const std::span<const Mask> masks = scene.options.masks.triangles;
  for (std::size_t t = 0; t < cut.origins.size() && !masks.empty(); ++t) {
    const std::uint32_t origin = cut.origins[t];
    if (masks[origin] == Mask::automatic) continue;
    require(cut.cosmeticTriangles[t] == result.zones.cosmeticTriangles[origin]);
  }
  const std::vector<double> areas = areasOfPieces(target.mesh, cut);
  for (std::size_t t = 0; t < areas.size(); ++t) {
    const std::uint32_t* corners = target.mesh.indices.data() + 3 * t;
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    require(std::abs(areas[t] - 1) < 1e-5);
  }
  return 0;
}
