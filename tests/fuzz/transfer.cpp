// Transfers any scene: the status is ok or names the input, and an answer is consistent and the same every time.

#include <cmath>

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

namespace {

void check(const fuzz::Scene& scene, const TransferResult& result) {
  const Projection& projection = result.projection;
  const std::size_t vertices = scene.target.positions.size() / 3;
  require(projection.zones.size() == vertices && result.zones.zones.size() == vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    require(std::isfinite(projection.distances[v]) && projection.distances[v] >= 0);
    require(std::isfinite(projection.uvs[2 * v]) && std::isfinite(projection.uvs[2 * v + 1]));
    require(3 * std::size_t{projection.triangles[v]} < scene.cage.indices.size());
    require(projection.segments[v] < projection.segmentStats.size());
  }
  for (const SegmentStats& segment : projection.segmentStats) {
    require(segment.area >= 0 && segment.exposedArea >= 0 && segment.coveredArea >= 0);
    require(segment.coveredArea <= segment.exposedArea);
    require(segment.twinOf < projection.segmentStats.size());
    require(!std::isnan(segment.score));
  }
}

bool areEqual(const TransferResult& a, const TransferResult& b) {
  const auto same = [](const auto& x, const auto& y) { return std::equal(x.begin(), x.end(), y.begin(), y.end()); };
  return same(a.projection.uvs, b.projection.uvs) && same(a.zones.zones, b.zones.zones) &&
         same(a.projection.triangles, b.projection.triangles) && same(a.projection.cornerUvs, b.projection.cornerUvs);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Scene scene(input);
  Workspace workspace;
  TransferResult result, again;
  const Status status = transfer(scene.cage.view(), scene.target.view(), scene.options, workspace, result);
  if (!status.ok()) {
    require(!describe(status, scene.cage.view(), scene.target.view()).empty());
    return 0;
  }
  check(scene, result);
  require(transfer(scene.cage.view(), scene.target.view(), scene.options, workspace, again).ok());
  require(areEqual(result, again));
  return 0;
}
