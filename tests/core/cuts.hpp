#pragma once

#include "cagecast/clip.hpp"
#include "checks.hpp"
#include "reference/scene.hpp"

/// What several tests ask of a target whose borders are cut.
namespace cagecast {

/// The preset `default`.
inline TransferOptions cutting(Seams seams = Seams::corner) {
  TransferOptions options = TransferOptions{};
  options.seams = seams;
  return options;
}

/// Cuts the target of a transfer.
inline CutTarget cutOf(const MeshView& cage, const MeshView& target, const TransferOptions& options,
                       const TransferResult& result) {
  CutTarget cut;
  const DecidedTarget decided{target, result.zones.zones, result.projection.segments, result.zones.culledBy};
  const Status status = cutBorders(cage, decided, options, testWorkspace(), cut);
  INFO(describe(status, cage, target));
  REQUIRE(status.ok());
  return cut;
}

inline CutTarget cutOf(const MeshView& cage, const MeshView& target, const TransferOptions& options) {
  return cutOf(cage, target, options, transferred(cage, target, options));
}

/// The target as it was cut.
inline scenes::Mesh meshOf(const MeshView& target, const CutTarget& cut) {
  scenes::Mesh mesh;
  mesh.positions.assign(target.positions.begin(), target.positions.end());
  mesh.groups.assign(target.groups.begin(), target.groups.end());
  mesh.groups.resize(mesh.vertexCount());
  for (std::size_t i = 0; i < cut.sources.size(); i += 3) {
    scenes::Point p{};
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < 3; ++j)
        sum += static_cast<double>(cut.weights[i + j]) *
               static_cast<double>(target.positions[cut.sources[i + j] * std::size_t{3} + k]);
      p[k] = static_cast<float>(sum);
    }
    mesh.addVertex(p, 0, 0, mesh.groups[cut.sources[i]]);
  }
  mesh.indices.assign(cut.indices.begin(), cut.indices.end());
  return mesh;
}

inline reference::Vec areaOf(const MeshView& mesh, std::size_t t) {
  const reference::Vec a = reference::vertex(mesh, mesh.indices[3 * t]);
  return cross(reference::vertex(mesh, mesh.indices[3 * t + 1]) - a,
               reference::vertex(mesh, mesh.indices[3 * t + 2]) - a) *
         0.5;
}

}  // namespace cagecast
