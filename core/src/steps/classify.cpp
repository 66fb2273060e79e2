#include "steps/classify.hpp"

#include <algorithm>
#include <limits>

#include "cagecast/transfer.hpp"
#include "input/validate.hpp"
#include "steps/masks.hpp"
#include "steps/typical_depth.hpp"

namespace cagecast {
namespace {

/// docs/method.md, steps 8 and 10. A segment is small if its covered area is less than this share of the covered area
/// of all segments, K.
constexpr double kSmall = 0.01;
/// A large segment passes the floor if at most this share of its exposed area is uncovered.
constexpr double kMaxUncovered = 0.25;
/// At most this share of a small segment may lie bare or hidden in one hole.
constexpr double kMaxInHole = 0.25;
/// A hole is explained if the exposed area of culled segments there is at least this share of the uncovered area of the
/// other segments there.
constexpr double kExplaining = 0.02;

/// How many times over a need is met; infinity if there is none.
double ratio(double has, double needs) { return needs > 0 ? has / needs : std::numeric_limits<double>::infinity(); }

/// The rules on segments: what each of them has against what it needs.
class Rules {
 public:
  Rules(const ProjectionView& projection, const TransferOptions& options) noexcept
      : projection_(projection), options_(options), typical_(projection.segmentStats) {}

  /// @param[out] ratios  1 per segment.
  void apply(Array<Ratios>& ratios) const noexcept {
    const std::span<const SegmentStats> stats = projection_.segmentStats;
    for (std::size_t s = 0; s < stats.size(); ++s) {
      ratios[s] = {};
      ratios[s].threshold = ratio(stats[s].coveredArea, static_cast<double>(options_.threshold) * stats[s].exposedArea);
      if (options_.steps.floor) applyFloor(stats[s], ratios[s]);
    }
    for (const HoleShare& share : projection_.holeShares) {
      const SegmentStats& segment = stats[share.segment];
      if (!isSmall(segment)) continue;
      const double allowed = kMaxInHole * (segment.exposedArea + share.hiddenArea);
      double& hole = ratios[share.segment].hole;
      hole = std::min(hole, ratio(allowed, share.uncoveredArea + share.hiddenArea));
    }
  }

 private:
  [[nodiscard]] bool isSmall(const SegmentStats& s) const { return s.coveredArea < kSmall * typical_.covered; }

  /// Step 8.
  void applyFloor(const SegmentStats& s, Ratios& ratios) const {
    ratios.floor = 0;
    if (!(s.coveredArea > 0)) return;
    // What is meant to be painted is covered almost wherever it is exposed; an eye or a lamp in its hole is not.
    ratios.floor =
        ratio(s.coveredArea * s.coverage(), static_cast<double>(options_.minCovered) * (s.area - s.beyondArea));
    if (isSmall(s)) {
      // Teeth and tongues lie several times as deep under the cage as the lips around them.
      ratios.depth = ratio(typical_.most(), s.depth);
    } else {
      // The skin of a dressed body: most of it is hidden, but it is clearly covered where it is exposed.
      ratios.floor = std::max(ratios.floor, ratio(kMaxUncovered * s.exposedArea, s.exposedArea - s.coveredArea));
    }
  }

  const ProjectionView& projection_;
  const TransferOptions& options_;
  TypicalDepth typical_;
};

/// Step 10: finds which holes are explained by culled segments behind them.
void explainHoles(std::span<const HoleShare> shares, Zones& out) {
  std::fill(out.explainedHoles.begin(), out.explainedHoles.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < shares.size();) {
    const std::uint32_t hole = shares[i].hole;
    double culled = 0;
    double uncovered = 0;
    for (; i < shares.size() && shares[i].hole == hole; ++i) {
      if (out.culledBy[shares[i].segment] != CulledBy::none) {
        culled += shares[i].exposedArea;
      } else {
        uncovered += shares[i].uncoveredArea;
      }
    }
    out.explainedHoles[hole] = culled > 0 && culled >= kExplaining * uncovered;
  }
}

/// Which rule a segment does not meet.
CulledBy culledByRules(const Ratios& ratios) {
  if (ratios.least() >= 1) return CulledBy::none;
  return std::min({ratios.threshold, ratios.floor, ratios.depth}) < 1 ? CulledBy::coverage : CulledBy::hole;
}

/// Decides which segments are culled: ignored ones, by a lock, or by the rules.
Status cullSegments(const ProjectionView& projection, const TransferOptions& options, Zones& out) {
  Array<Lock> locks;
  if (const Status status = resolveLocks(options, projection.segmentStats, locks); !status.ok()) return status;
  Rules(projection, options).apply(out.ratios);
  for (std::size_t s = 0; s < out.culledBy.size(); ++s) {
    if (projection.segmentStats[s].culledBy == CulledBy::ignore) {
      out.culledBy[s] = CulledBy::ignore;
      continue;
    }
    switch (locks.empty() ? Lock::automatic : locks[s]) {
      case Lock::automatic: out.culledBy[s] = culledByRules(out.ratios[s]); break;
      case Lock::keep: out.culledBy[s] = CulledBy::none; break;
      case Lock::exclude: out.culledBy[s] = CulledBy::lock; break;
    }
  }
  return {};
}

/// The zone of a vertex whose segment is not culled and that is not recovered.
Zone zoneOf(Visibility visibility) {
  const auto areAlike = [](Visibility a, Zone b) { return static_cast<int>(a) == static_cast<int>(b); };
  static_assert(areAlike(Visibility::covered, Zone::cosmetic) && areAlike(Visibility::occluded, Zone::occluded) &&
                areAlike(Visibility::uncovered, Zone::uncovered));
  return visibility == Visibility::beyond ? Zone::uncovered : static_cast<Zone>(visibility);
}

/// Step 9: whether enough rays of a vertex hit nothing but culled segments.
/// @param at  A record of `Hiders`.
template <typename IsCulled>
bool isFree(std::span<const std::uint32_t> records, std::uint32_t at, IsCulled isCulled) {
  std::uint32_t missing = 1;
  for (; at != 0 && missing > 0; at = records[at]) {
    const std::uint32_t* record = &records[at] + 1;
    missing = record[0];
    std::uint32_t rays = record[1];
    for (record += 2; rays > 0 && missing > 0; --rays) {
      const std::uint32_t count = *record++;
      missing -= std::all_of(record, record + count, isCulled);
      record += count;
    }
  }
  return missing == 0;
}

/// Gives every vertex its zone, as its segment and its recovery have it.
void writeZones(const ProjectionView& projection, Zones& out) {
  const std::span<const std::uint32_t> segments = projection.segments;
  const std::span<const std::uint32_t> recovery = projection.recovery;
  const auto isCulled = [&](std::size_t s) { return out.culledBy[s] != CulledBy::none; };
  for (std::size_t v = 0; v < projection.visibility.size(); ++v) {
    const Zone zone = zoneOf(projection.visibility[v]);
    out.zones[v] = isCulled(segments[v]) && zone == Zone::cosmetic ? Zone::culled : zone;
  }
  const auto& [hiddenBy, records] = projection.hiders;
  std::uint32_t last = 0;  // The record of the last hidden vertex: neighbours have mostly the same.
  bool isLastFree = true;
  for (std::size_t v = 0; v < recovery.size(); ++v) {
    if (recovery[v] == Recovery::never || isCulled(segments[v])) continue;
    if (!hiddenBy.empty() && hiddenBy[v] != 0) {
      if (hiddenBy[v] != last) isLastFree = isFree(records, last = hiddenBy[v], isCulled);
      if (!isLastFree) continue;
    }
    bool isRecovered = true;
    if (recovery[v] >= Recovery::throughHole) {
      const std::size_t hole = recovery[v] - Recovery::throughHole;
      isRecovered = hole < out.explainedHoles.size() && out.explainedHoles[hole] != 0;
    }
    if (isRecovered) out.zones[v] = Zone::cosmetic;
  }
}

/// Culls the vertices of ignored parts and their triangles, whatever masks say.
void leaveIgnored(std::span<const std::uint32_t> segments, std::span<const std::uint32_t> indices, Zones& out) {
  const auto isIgnored = [&](std::uint32_t v) { return out.culledBy[segments[v]] == CulledBy::ignore; };
  if (std::find(out.culledBy.begin(), out.culledBy.end(), CulledBy::ignore) == out.culledBy.end()) return;
  for (std::uint32_t v = 0; v < segments.size(); ++v) {
    if (isIgnored(v)) out.zones[v] = Zone::culled;
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (isIgnored(indices[i])) out.cosmeticTriangles[i / 3] = 0;
  }
}

}  // namespace

bool isCosmetic(std::span<const Zone> zones, const std::uint32_t* corners, const TransferOptions& options) noexcept {
  static_assert(static_cast<int>(Zone::cosmetic) == 0 && static_cast<int>(Zone::occluded) == 1);
  // Summing squares takes no branch: up to two occluded corners give at most 2, any other NCZ corner at least 4. The
  // occluded part of a painted triangle is hidden by the depth buffer.
  const int most = options.steps.partialTriangles ? 2 : 0;
  const auto squared = [&](std::uint32_t v) { return static_cast<int>(zones[v]) * static_cast<int>(zones[v]); };
  return squared(corners[0]) + squared(corners[1]) + squared(corners[2]) <= most;
}

void markCosmetic(std::span<const Zone> zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept {
  for (std::size_t t = 0; t < cosmetic.size(); ++t) cosmetic[t] = isCosmetic(zones, &indices[3 * t], options);
}

Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices,
                const TransferOptions& options, Zones& out) noexcept {
  if (const Status status = checkOptions(options, Stage::classify); !status.ok()) return status;
  if (const Status status = checkProjection(projection, indices); !status.ok()) return status;
  if (const Status status = checkMasks(options.masks, projection.visibility.size(), indices.size() / 3); !status.ok())
    return status;
  const std::size_t segmentCount = projection.segmentStats.size();
  const std::span<const HoleShare> shares = projection.holeShares;
  if (!out.zones.reset(projection.visibility.size()) || !out.cosmeticTriangles.reset(indices.size() / 3) ||
      !out.culledBy.reset(segmentCount) || !out.ratios.reset(segmentCount) ||
      !out.explainedHoles.reset(shares.empty() ? 0 : std::size_t{shares.back().hole} + 1)) {
    return {Code::outOfMemory};
  }
  if (const Status status = cullSegments(projection, options, out); !status.ok()) return status;
  explainHoles(shares, out);
  writeZones(projection, out);
  markCosmetic(out.zones, indices, options, out.cosmeticTriangles);
  if (!applyMasks(options, indices, out)) return {Code::outOfMemory};
  leaveIgnored(projection.segments, indices, out);
  return {};
}

}  // namespace cagecast
