#include <algorithm>

#include "cagecast/transfer.hpp"
#include "check.hpp"

namespace cagecast {
namespace {

/// SPEC §7: a hole is explained if what fails there is so large a share of what is uncovered there.
constexpr double kExplaining = 0.02;

/// Step 5: whether a segment falls short of what is asked of it.
bool fallsShort(const SegmentStats& stats, const ClassifyOptions& options) {
  if (stats.coveredArea < static_cast<double>(options.threshold) * stats.exposedArea) return true;
  if (!(options.minCovered > 0)) return false;
  return !(stats.coveredArea > 0 && stats.coveredArea >= static_cast<double>(options.minCovered) * stats.area);
}

/// Step 7: which holes are meant for what fails behind them.
void explainHoles(std::span<const HoleShare> shares, Zones& out) {
  std::fill(out.explainedHoles.begin(), out.explainedHoles.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < shares.size();) {
    const std::uint32_t hole = shares[i].hole;
    double failing = 0;
    double uncovered = 0;
    for (; i < shares.size() && shares[i].hole == hole; ++i) {
      (out.culledSegments[shares[i].segment] ? failing : uncovered) +=
          out.culledSegments[shares[i].segment] ? shares[i].exposedArea : shares[i].uncoveredArea;
    }
    out.explainedHoles[hole] = failing > 0 && failing >= kExplaining * uncovered;
  }
}

}  // namespace

Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices, const ClassifyOptions& options,
                Zones& out) noexcept {
  if (const Status status = checkClassifyOptions(options); !status.ok()) return status;
  const auto& [zones, segments, stats, restores, shares] = projection;
  if (!options.locks.empty() && options.locks.size() != stats.size()) {
    return {Code::badLocks, Argument::options, static_cast<std::uint32_t>(options.locks.size())};
  }
  const std::size_t triangles = indices.size() / 3;
  if (!out.zones.reset(zones.size()) || !out.cosmeticTriangles.reset(triangles) || !out.culledSegments.reset(stats.size()) ||
      !out.explainedHoles.reset(shares.empty() ? 0 : std::size_t{shares.back().hole} + 1)) {
    return {Code::outOfMemory};
  }

  for (std::size_t s = 0; s < stats.size(); ++s) {
    const Lock lock = options.locks.empty() ? Lock::automatic : options.locks[s];
    out.culledSegments[s] = lock == Lock::automatic ? fallsShort(stats[s], options) : lock == Lock::exclude;
  }
  explainHoles(shares, out);
  for (std::size_t v = 0; v < zones.size(); ++v) {
    // As numbers: clang takes a `&` of truth values for a mistake, and `&&` branches.
    const int culled = static_cast<int>(zones[v] == Zone::cosmetic) & static_cast<int>(out.culledSegments[segments[v]] != 0);
    out.zones[v] = culled != 0 ? Zone::culled : zones[v];
  }
  for (std::size_t v = 0; v < restores.size(); ++v) {
    if (restores[v] == Restores::never || out.culledSegments[segments[v]]) continue;
    if (restores[v] == Restores::always || out.explainedHoles[restores[v] - Restores::throughHole]) out.zones[v] = Zone::cosmetic;
  }

  // The depth buffer hides what is occluded of a triangle.
  const unsigned counting = options.partialTriangles ? ~(1u << static_cast<unsigned>(Zone::occluded)) : ~0u;
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto zone = [&](std::size_t corner) { return 1u << static_cast<unsigned>(out.zones[indices[3 * t + corner]]); };
    out.cosmeticTriangles[t] = ((zone(0) | zone(1) | zone(2)) & counting) == 1u << static_cast<unsigned>(Zone::cosmetic);
  }
  return {};
}

}  // namespace cagecast
