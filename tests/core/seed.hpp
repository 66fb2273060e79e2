#pragma once

#include <cstdint>
#include <cstdlib>

namespace cagecast {

/// The first of the seeds that a test tries: 1, or CAGECAST_SEED.
inline std::uint64_t firstSeed() {
  const char* given = std::getenv("CAGECAST_SEED");
  return given == nullptr ? 1 : std::strtoull(given, nullptr, 0);
}

}  // namespace cagecast
