#pragma once

#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>

#include "cagecast/clip.hpp"
#include "cagecast/transfer.hpp"
#include "scenes/scenes.hpp"

namespace cagecast {

/// FNV-1a, 64 bits, over the bytes of arrays: equal hashes mean the same answer, bit by bit.
class Hash {
 public:
  template <typename... T>
  void add(const Array<T>&... arrays) {
    (addOne(arrays), ...);
  }
  /// UVs, zones, triangles and segments: what has to be the same everywhere.
  void add(const TransferResult& result) {
    add(result.projection.uvs, result.zones.zones, result.projection.triangles, result.projection.segments);
  }
  void addBytes(const void* values, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
  }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << hash_;
    return out.str();
  }

 private:
  template <typename T>
  void addOne(const Array<T>& values) {
    addBytes(values.data(), values.size() * sizeof(T));
  }

  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

/// The golden hashes of this build, which the files in tests/core/golden have: of the preset `paper`, of the preset
/// `default`, and of cut borders. Instead of a hash, what went wrong.
struct GoldenHashes {
  std::string paper, standard, borders;

  static GoldenHashes compute() {
    return {ofTransfers(TransferOptions::paper(), scenes::golden()),
            ofTransfers(TransferOptions{}, scenes::goldenDefault()), ofCuts()};
  }

 private:
  static std::string ofTransfers(const TransferOptions& options, const std::vector<scenes::Scene>& all) {
    Hash hash;
    Workspace workspace;
    for (const scenes::Scene& scene : all) {
      TransferResult result;
      const Status status = transfer(scene.cage.view(), scene.target.view(), options, workspace, result);
      if (!status.ok()) return describe(status, {}, {});
      hash.add(result);
      if (options.seams == Seams::corner) hash.add(result.zones.cosmeticTriangles, result.projection.cornerUvs);
    }
    return hash.text();
  }
  static std::string ofCuts() {
    Hash hash;
    Workspace workspace;
    for (const Seams seams : {Seams::vertex, Seams::corner}) {
      TransferOptions options;
      options.seams = seams;
      for (const scenes::Scene& scene : scenes::goldenBorders()) {
        TransferResult result;
        CutTarget cut;
        const MeshView cage = scene.cage.view(), target = scene.target.view();
        Status status = transfer(cage, target, options, workspace, result);
        const DecidedTarget decided{target, result.zones.zones, result.projection.segments, result.zones.culledBy};
        if (status.ok()) status = cutBorders(cage, decided, options, workspace, cut);
        if (!status.ok()) return describe(status, {}, {});
        hash.add(cut.sources, cut.weights, cut.indices, cut.origins, cut.uvs, cut.cornerUvs, cut.zones,
                 cut.cosmeticTriangles);
      }
    }
    return hash.text();
  }
};

}  // namespace cagecast
