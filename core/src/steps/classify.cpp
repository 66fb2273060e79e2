#include "steps/classify.hpp"

#include <algorithm>
#include <limits>

#include "cagecast/transfer.hpp"
#include "input/validate.hpp"

namespace cagecast {
namespace {

/// docs/method.md, section 5‴. V and U are the areas at one hole, E, C, U_s and H_s those of one segment there.
/// A hole is explained if the exposed area of culled segments there, V, is at least this share of the uncovered area of
/// the other segments there, U.
constexpr double kExplaining = 0.02;
/// A segment is small if its covered area, C, is less than this share of the covered area of all segments, K.
constexpr double kSmallSegment = 0.02;
/// A small segment is culled if its hidden area under a hole, H_s, is more than this share of E + H_s.
constexpr double kHidden = 0.25;
/// A small segment is culled if its uncovered area at an unexplained hole, U_s, is more than this share of its exposed
/// area, E.
constexpr double kUncoveredOfSegment = 0.15;
/// The previous rule applies only if the segment has at least this share of the uncovered area at the hole, U.
constexpr double kUncoveredOfHole = 0.25;

/// docs/method.md, section 5″: twins with scores within this factor of 1 are judged together.
constexpr double kDoubt = 2;

/// How many times over a need is met; infinity if there is none.
double ratio(double has, double needs) { return needs > 0 ? has / needs : std::numeric_limits<double>::infinity(); }

/// The areas of a segment, or of several that are judged together: A, E, C and D of docs/method.md.
struct Areas {
  double all = 0, exposed = 0, covered = 0, depthWeighted = 0;
  double segments = 0;  ///< How many segments.

  static Areas of(const SegmentStats& s) { return {s.area, s.exposedArea, s.coveredArea, s.depthWeightedArea, 1}; }
  void add(const Areas& other) {
    all += other.all;
    exposed += other.exposed;
    covered += other.covered;
    depthWeighted += other.depthWeighted;
    segments += other.segments;
  }
};

/// Step 5: the scores of the segments.
class Scoring {
 public:
  Scoring(std::span<const SegmentStats> stats, const TransferOptions& options) noexcept
      : stats_(stats), options_(options) {
    for (const SegmentStats& s : stats) allCovered_ += s.coveredArea;
  }

  /// K, the covered area of all segments.
  [[nodiscard]] double allCovered() const noexcept { return allCovered_; }

  /// @param[out] scores  1 per segment.
  /// @return false if memory ran out.
  bool score(Array<double>& scores) const noexcept {
    bool isAnyInDoubt = false;
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      scores[s] = scoreOf(Areas::of(stats_[s]));
      isAnyInDoubt = isAnyInDoubt || isInDoubt(scores[s]);
    }
    const bool areTwinsJoined = options_.steps.twins && options_.steps.floor != Floor::none;
    return !areTwinsJoined || !isAnyInDoubt || scoreTwins(scores);
  }

 private:
  static bool isInDoubt(double score) { return score >= 1 / kDoubt && score < kDoubt; }

  [[nodiscard]] double scoreOf(const Areas& areas) const {
    const double coverage = ratio(areas.covered, static_cast<double>(options_.threshold) * areas.exposed);
    const Steps& steps = options_.steps;
    if (steps.floor == Floor::none) return coverage;
    if (!(areas.covered > 0)) return 0;
    const double neededOfItself = static_cast<double>(options_.minCovered) * areas.all;
    if (steps.floor == Floor::area) return std::min(coverage, ratio(areas.covered, neededOfItself));
    // X = D · F. What is meant to be painted is covered almost wherever it is exposed; an eye or a lamp in its hole is
    // not.
    const double x = areas.depthWeighted * (areas.covered / areas.exposed);
    // A segment that is mostly hidden is kept for its share of the whole, if it is clearly covered where it is exposed.
    const double neededOfAll = static_cast<double>(steps.minOfAll) * allCovered_ * areas.segments;
    const double allowedUncovered = static_cast<double>(steps.maxUncovered) * areas.exposed;
    const double shareOfAll = std::min(ratio(x, neededOfAll), ratio(allowedUncovered, areas.exposed - areas.covered));
    const double floor = std::max(ratio(x, neededOfItself), shareOfAll);
    return std::min(coverage, floor);
  }

  /// Gives twins in doubt the score of their areas together, so that they are not culled one by one by accident.
  bool scoreTwins(Array<double>& scores) const noexcept {
    Array<Areas> together;  // By the first of the twins.
    if (!together.reset(stats_.size())) return false;
    std::fill(together.begin(), together.end(), Areas{});
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      if (isInDoubt(scores[s])) together[stats_[s].twinOf].add(Areas::of(stats_[s]));
    }
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      if (isInDoubt(scores[s])) scores[s] = scoreOf(together[stats_[s].twinOf]);
    }
    return true;
  }

  std::span<const SegmentStats> stats_;
  const TransferOptions& options_;
  double allCovered_ = 0;  ///< K of docs/method.md.
};

/// Steps 5‴ and 7: what the holes mean, given which segments are culled.
class HoleJudge {
 public:
  HoleJudge(const ProjectionView& projection, Zones& out) noexcept
      : shares_(projection.holeShares), stats_(projection.segmentStats), out_(out) {}

  /// Finds which holes are explained by culled segments behind them.
  void explainHoles() const noexcept {
    std::fill(out_.explainedHoles.begin(), out_.explainedHoles.end(), std::uint8_t{0});
    eachHole([&](std::span<const HoleShare> shares) {
      double culledArea = 0;
      for (const HoleShare& share : shares) {
        if (isCulled(share.segment)) culledArea += share.exposedArea;
      }
      const bool isExplained = culledArea > 0 && culledArea >= kExplaining * uncoveredArea(shares);
      out_.explainedHoles[shares.front().hole] = isExplained;
    });
  }

  /// Lowers the scores of segments with less than `small` covered area that a hole is meant for. Needs `explainHoles`.
  void judgeContents(double small) const noexcept {
    eachHole([&](std::span<const HoleShare> shares) {
      const bool isExplained = out_.explainedHoles[shares.front().hole] != 0;
      const double uncovered = uncoveredArea(shares);
      for (const HoleShare& share : shares) {
        const SegmentStats& segment = stats_[share.segment];
        if (isCulled(share.segment) || segment.coveredArea >= small) continue;
        double& score = out_.scores[share.segment];
        score = std::min(score, ratio(kHidden * (segment.exposedArea + share.hiddenArea), share.hiddenArea));
        if (isExplained || share.uncoveredArea < kUncoveredOfHole * uncovered) continue;
        score = std::min(score, ratio(kUncoveredOfSegment * segment.exposedArea, share.uncoveredArea));
      }
    });
  }

 private:
  [[nodiscard]] bool isCulled(std::size_t s) const { return out_.culledBy[s] != CulledBy::none; }

  /// Calls with the shares of each hole.
  template <typename Call>
  void eachHole(Call call) const {
    for (std::size_t i = 0, end = 0; i < shares_.size(); i = end) {
      while (end < shares_.size() && shares_[end].hole == shares_[i].hole) ++end;
      call(shares_.subspan(i, end - i));
    }
  }

  /// U of docs/method.md: the uncovered area of the segments at a hole that are not culled.
  [[nodiscard]] double uncoveredArea(std::span<const HoleShare> shares) const {
    double sum = 0;
    for (const HoleShare& share : shares) {
      if (!isCulled(share.segment)) sum += share.uncoveredArea;
    }
    return sum;
  }

  std::span<const HoleShare> shares_;
  std::span<const SegmentStats> stats_;
  Zones& out_;
};

/// Steps 5 and 5‴: which segments are culled, and which holes that explains.
Status cullSegments(const ProjectionView& projection, const TransferOptions& options, Zones& out) {
  const std::span<const SegmentStats> stats = projection.segmentStats;
  Array<Lock> locks;
  if (const Status status = resolveLocks(options.locks, stats, locks); !status.ok()) return status;
  const Scoring scoring(stats, options);
  if (!scoring.score(out.scores)) return {Code::outOfMemory};
  const auto lockOf = [&](std::size_t s) { return locks.empty() ? Lock::automatic : locks[s]; };
  for (std::size_t s = 0; s < stats.size(); ++s) {
    switch (lockOf(s)) {
      case Lock::automatic: out.culledBy[s] = out.scores[s] < 1 ? CulledBy::coverage : CulledBy::none; break;
      case Lock::keep: out.culledBy[s] = CulledBy::none; break;
      case Lock::exclude: out.culledBy[s] = CulledBy::lock; break;
    }
  }
  const HoleJudge holes(projection, out);
  if (options.steps.holeContents) {
    holes.explainHoles();
    holes.judgeContents(kSmallSegment * scoring.allCovered());
    for (std::size_t s = 0; s < stats.size(); ++s) {
      const bool isLowered = out.culledBy[s] == CulledBy::none && out.scores[s] < 1;
      if (isLowered && lockOf(s) == Lock::automatic) out.culledBy[s] = CulledBy::hole;
    }
  }
  holes.explainHoles();  // Again, by the final verdicts.
  return {};
}

/// Gives every vertex its zone, as its segment and its recovery have it.
void writeZones(const ProjectionView& projection, Zones& out) {
  const std::span<const std::uint32_t> segments = projection.segments;
  const std::span<const std::uint32_t> recovery = projection.recovery;
  const auto isCulled = [&](std::size_t s) { return out.culledBy[s] != CulledBy::none; };
  for (std::size_t v = 0; v < projection.zones.size(); ++v) {
    const Zone zone = projection.zones[v];
    out.zones[v] = isCulled(segments[v]) && zone == Zone::cosmetic ? Zone::culled : zone;
  }
  for (std::size_t v = 0; v < recovery.size(); ++v) {
    if (recovery[v] == Recovery::never || isCulled(segments[v])) continue;
    bool isRecovered = true;
    if (recovery[v] >= Recovery::throughHole) {
      const std::size_t hole = recovery[v] - Recovery::throughHole;
      isRecovered = hole < out.explainedHoles.size() && out.explainedHoles[hole] != 0;
    }
    if (isRecovered) out.zones[v] = Zone::cosmetic;
  }
}

}  // namespace

void markCosmetic(const Array<Zone>& zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept {
  static_assert(static_cast<int>(Zone::cosmetic) == 0 && static_cast<int>(Zone::occluded) == 1);
  // Summing squares takes no branch: up to two occluded corners give at most 2, any other NCZ corner at least 4. The
  // occluded part of a painted triangle is hidden by the depth buffer.
  const int most = options.steps.partialTriangles ? 2 : 0;
  const Zone* zone = zones.data();
  const std::uint32_t* index = indices.data();
  for (std::uint8_t& isCosmetic : cosmetic) {
    const auto squared = [&](std::size_t corner) {
      return static_cast<int>(zone[index[corner]]) * static_cast<int>(zone[index[corner]]);
    };
    isCosmetic = squared(0) + squared(1) + squared(2) <= most;
    index += 3;
  }
}

Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices,
                const TransferOptions& options, Zones& out) noexcept {
  if (const Status status = checkOptions(options, Stage::classify); !status.ok()) return status;
  if (const Status status = checkProjection(projection, indices); !status.ok()) return status;
  const std::size_t segmentCount = projection.segmentStats.size();
  const std::span<const HoleShare> shares = projection.holeShares;
  if (!out.zones.reset(projection.zones.size()) || !out.cosmeticTriangles.reset(indices.size() / 3) ||
      !out.culledBy.reset(segmentCount) || !out.scores.reset(segmentCount) ||
      !out.explainedHoles.reset(shares.empty() ? 0 : std::size_t{shares.back().hole} + 1)) {
    return {Code::outOfMemory};
  }
  if (const Status status = cullSegments(projection, options, out); !status.ok()) return status;
  writeZones(projection, out);
  markCosmetic(out.zones, indices, options, out.cosmeticTriangles);
  return {};
}

}  // namespace cagecast
