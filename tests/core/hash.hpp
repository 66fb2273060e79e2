#pragma once

#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>

#include "cagecast/clip.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

/// FNV-1a, 64 bits, over the bytes of arrays: equal hashes mean the same answer, bit by bit.
class Hash {
 public:
  template <typename T>
  void add(const Array<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
  }
  /// UVs, zones, triangles and segments: what has to be the same everywhere.
  void add(const TransferResult& result) {
    add(result.projection.uvs);
    add(result.zones.zones);
    add(result.projection.triangles);
    add(result.projection.segments);
  }
  /// The whole of a cut target.
  void add(const CutTarget& cut) {
    add(cut.sources);
    add(cut.weights);
    add(cut.indices);
    add(cut.origins);
    add(cut.uvs);
    add(cut.cornerUvs);
    add(cut.zones);
    add(cut.cosmeticTriangles);
  }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << hash_;
    return out.str();
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace cagecast
