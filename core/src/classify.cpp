#include "cagecast/transfer.hpp"
#include "check.hpp"

namespace cagecast {

Status classify(std::span<const Zone> zones, std::span<const std::uint32_t> segments,
                std::span<const SegmentStats> stats, std::span<const std::uint32_t> indices,
                const ClassifyOptions& options, Zones& out) noexcept {
  if (const Status status = checkClassifyOptions(options); !status.ok()) return status;
  const std::size_t triangles = indices.size() / 3;
  if (!out.zones.reset(zones.size()) || !out.cosmeticTriangles.reset(triangles) || !out.culledSegments.reset(stats.size())) {
    return {Code::outOfMemory};
  }
  const double threshold = static_cast<double>(options.threshold);
  for (std::size_t s = 0; s < stats.size(); ++s) {
    out.culledSegments[s] = stats[s].coveredArea < threshold * stats[s].exposedArea;
  }
  for (std::size_t v = 0; v < zones.size(); ++v) {
    // As numbers: clang takes a `&` of truth values for a mistake, and `&&` branches.
    const int culled = static_cast<int>(zones[v] == Zone::cosmetic) & static_cast<int>(out.culledSegments[segments[v]] != 0);
    out.zones[v] = culled != 0 ? Zone::culled : zones[v];
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto zone = [&](std::size_t corner) { return static_cast<unsigned>(out.zones[indices[3 * t + corner]]); };
    out.cosmeticTriangles[t] = (zone(0) | zone(1) | zone(2)) == static_cast<unsigned>(Zone::cosmetic);
  }
  return {};
}

}  // namespace cagecast
