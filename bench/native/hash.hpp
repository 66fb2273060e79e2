#pragma once

#include <cstdio>
#include <string>

#include "cagecast/transfer.hpp"

namespace cagecast::bench {

/// FNV-1a, 64 bits, over the bytes of UVs, zones, triangles and segments: equal hashes mean the same answer, bit by bit.
inline std::string hashOf(const TransferResult& result) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash]<typename T>(const Array<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  };
  add(result.projection.uvs);
  add(result.zones.zones);
  add(result.projection.triangles);
  add(result.projection.segments);
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace cagecast::bench
