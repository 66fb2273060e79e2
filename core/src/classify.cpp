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
    out.zones[v] = zones[v] == Zone::cosmetic && out.culledSegments[segments[v]] ? Zone::culled : zones[v];
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto cosmetic = [&](std::size_t corner) { return out.zones[indices[3 * t + corner]] == Zone::cosmetic; };
    out.cosmeticTriangles[t] = cosmetic(0) && cosmetic(1) && cosmetic(2);
  }
  return {};
}

}  // namespace cagecast
