#include <algorithm>
#include <limits>

#include "input/validate.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 7: a hole is explained if what fails there is so large a share of what is uncovered there.
constexpr double kExplaining = 0.02;

/// docs/method.md, step 5″: a part that a hole is meant for has less than so large a share of all that is covered,
constexpr double kSmallPart = 0.02;
/// and under a hole that nothing explains it bares at least so much, as a share of what is exposed of it and of what is
/// bare there,
constexpr double kBare = 0.15;
constexpr double kMuchOfHole = 0.25;
/// or under any hole it hides so much, as a share of what is exposed of it with that.
constexpr double kHidden = 0.25;

/// docs/method.md, step 5′: copies within this factor of what is asked of them are judged together.
constexpr double kDoubt = 2;

/// How many times what it needs something has.
double times(double has, double needs) { return needs > 0 ? has / needs : std::numeric_limits<double>::infinity(); }

/// The areas of a segment, or of several that are judged together.
struct Tally {
  double area = 0, exposed = 0, covered = 0, sunk = 0;
  double segments = 0;

  static Tally of(const SegmentStats& s) { return {s.area, s.exposedArea, s.coveredArea, s.depthWeightedArea, 1}; }
  void add(const Tally& other) {
    area += other.area;
    exposed += other.exposed;
    covered += other.covered;
    sunk += other.sunk;
    segments += other.segments;
  }
};

/// Step 5: which segments pass.
class Verdicts {
 public:
  Verdicts(std::span<const SegmentStats> stats, const TransferOptions& options) noexcept
      : stats_(stats), options_(options) {
    for (const SegmentStats& s : stats) allCovered_ += s.coveredArea;
  }

  /// The covered area of all segments.
  [[nodiscard]] double allCovered() const noexcept { return allCovered_; }

  /// @param[out] scores  1 per segment: it passes from 1 on.
  /// @return false if memory ran out.
  bool decide(Array<double>& scores) const noexcept {
    bool anyDoubt = false;
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      scores[s] = marginOf(Tally::of(stats_[s]));
      anyDoubt = anyDoubt || isInDoubt(scores[s]);
    }
    return !(options_.steps.twins && options_.steps.floor != Floor::none && anyDoubt) || judgeCopies(scores);
  }

 private:
  static bool isInDoubt(double margin) { return margin >= 1 / kDoubt && margin < kDoubt; }

  /// How many times what is asked of it a tally reaches: it passes from 1 on.
  [[nodiscard]] double marginOf(const Tally& tally) const {
    const double coverage = times(tally.covered, static_cast<double>(options_.threshold) * tally.exposed);
    if (options_.steps.floor == Floor::none) return coverage;
    if (!(tally.covered > 0)) return 0;
    const double ofItself = static_cast<double>(options_.minCovered) * tally.area;
    if (options_.steps.floor == Floor::area) return std::min(coverage, times(tally.covered, ofItself));
    // What is meant to be painted is covered almost wherever it is exposed; an eye or a light in its hole is not.
    const double counted = tally.sunk * (tally.covered / tally.exposed);
    // A part that is mostly hidden passes for what it is of the whole, if where it is exposed it is covered beyond
    // doubt.
    const double ofAll = std::min(
        times(counted, static_cast<double>(options_.steps.minOfAll) * allCovered_ * tally.segments),
        times(static_cast<double>(options_.steps.maxUncovered) * tally.exposed, tally.exposed - tally.covered));
    return std::min(coverage, std::max(times(counted, ofItself), ofAll));
  }

  /// Judges copies that are in doubt together, so that twins do not fall on either side by accident.
  bool judgeCopies(Array<double>& scores) const noexcept {
    Array<Tally> together;  // By the first of the copies.
    if (!together.reset(stats_.size())) return false;
    std::fill(together.begin(), together.end(), Tally{});
    const auto isDoubted = [&](std::size_t s) { return isInDoubt(marginOf(Tally::of(stats_[s]))); };
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      if (isDoubted(s)) together[stats_[s].twinOf].add(Tally::of(stats_[s]));
    }
    for (std::size_t s = 0; s < stats_.size(); ++s) {
      if (isDoubted(s)) scores[s] = marginOf(together[stats_[s].twinOf]);
    }
    return true;
  }

  std::span<const SegmentStats> stats_;
  const TransferOptions& options_;
  double allCovered_ = 0;
};

/// Step 7: finds which holes are meant for what fails behind them. Step 5″ before that, with `small` parts: lowers the
/// scores of those that pass and that a hole is meant for.
/// @param small  A part is small if less than this area of it is covered; 0: none is.
void judgeHoles(std::span<const HoleShare> shares, std::span<const SegmentStats> stats, double small, Zones& out) {
  std::fill(out.explainedHoles.begin(), out.explainedHoles.end(), std::uint8_t{0});
  const auto isCulled = [&](std::size_t s) { return out.culledBy[s] != CulledBy::none; };
  for (std::size_t i = 0, end = 0; i < shares.size(); i = end) {
    double failing = 0;
    double uncovered = 0;
    for (; end < shares.size() && shares[end].hole == shares[i].hole; ++end) {
      (isCulled(shares[end].segment) ? failing : uncovered) +=
          isCulled(shares[end].segment) ? shares[end].exposedArea : shares[end].uncoveredArea;
    }
    const bool isExplained = failing > 0 && failing >= kExplaining * uncovered;
    out.explainedHoles[shares[i].hole] = isExplained;
    for (const HoleShare& share : shares.subspan(i, end - i)) {
      const SegmentStats& part = stats[share.segment];
      if (isCulled(share.segment) || part.coveredArea >= small) continue;
      double& margin = out.scores[share.segment];
      margin = std::min(margin, times(kHidden * (part.exposedArea + share.hiddenArea), share.hiddenArea));
      if (isExplained || share.uncoveredArea < kMuchOfHole * uncovered) continue;
      margin = std::min(margin, times(kBare * part.exposedArea, share.uncoveredArea));
    }
  }
}

}  // namespace

void markCosmetic(const Array<Zone>& zones, std::span<const std::uint32_t> indices, const TransferOptions& options,
                  Array<std::uint8_t>& cosmetic) noexcept {
  static_assert(static_cast<int>(Zone::cosmetic) == 0 && static_cast<int>(Zone::occluded) == 1);
  // The depth buffer hides what is occluded of a triangle. Squares of the others are too much for any sum.
  const int most = options.steps.partialTriangles ? 2 : 0;
  const Zone* zone = zones.data();
  const std::uint32_t* index = indices.data();
  for (std::uint8_t& itsCosmetic : cosmetic) {
    const auto squared = [&](std::size_t corner) {
      return static_cast<int>(zone[index[corner]]) * static_cast<int>(zone[index[corner]]);
    };
    itsCosmetic = squared(0) + squared(1) + squared(2) <= most;
    index += 3;
  }
}

Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices,
                const TransferOptions& options, Zones& out) noexcept {
  if (const Status status = checkOptions(options, Stage::classify); !status.ok()) return status;
  const auto& [zones, segments, stats, recovery, shares] = projection;
  Array<Lock> locks;
  if (const Status status = resolveLocks(options.locks, stats, locks); !status.ok()) return status;
  const std::size_t triangles = indices.size() / 3;
  if (!out.zones.reset(zones.size()) || !out.cosmeticTriangles.reset(triangles) || !out.culledBy.reset(stats.size()) ||
      !out.scores.reset(stats.size()) ||
      !out.explainedHoles.reset(shares.empty() ? 0 : std::size_t{shares.back().hole} + 1)) {
    return {Code::outOfMemory};
  }

  const Verdicts verdicts(stats, options);
  if (!verdicts.decide(out.scores)) return {Code::outOfMemory};
  const auto isLocked = [&](std::size_t s) { return !locks.empty() && locks[s] != Lock::automatic; };
  for (std::size_t s = 0; s < stats.size(); ++s) {
    out.culledBy[s] = out.scores[s] < 1 ? CulledBy::coverage : CulledBy::none;
    if (isLocked(s)) out.culledBy[s] = locks[s] == Lock::exclude ? CulledBy::lock : CulledBy::none;
  }
  const auto isCulled = [&](std::size_t s) { return out.culledBy[s] != CulledBy::none; };
  if (options.steps.holeContents) {
    judgeHoles(shares, stats, kSmallPart * verdicts.allCovered(), out);
    for (std::size_t s = 0; s < stats.size(); ++s) {
      if (!isCulled(s) && out.scores[s] < 1 && !isLocked(s)) out.culledBy[s] = CulledBy::hole;
    }
  }
  judgeHoles(shares, stats, 0, out);
  for (std::size_t v = 0; v < zones.size(); ++v) {
    // As numbers, without a branch: cosmetic is 0, less than the 1 of a segment that is culled.
    const auto zone = static_cast<unsigned>(zones[v]);
    const unsigned becomes = unsigned{isCulled(segments[v])} > zone ? static_cast<unsigned>(Zone::culled) : 0;
    out.zones[v] = static_cast<Zone>(zone | becomes);
  }
  for (std::size_t v = 0; v < recovery.size(); ++v) {
    if (recovery[v] == Recovery::never || isCulled(segments[v])) continue;
    const std::size_t hole = recovery[v] - Recovery::throughHole;
    const bool isExplained = hole < out.explainedHoles.size() && out.explainedHoles[hole] != 0;
    if (recovery[v] == Recovery::always || isExplained) out.zones[v] = Zone::cosmetic;
  }
  markCosmetic(out.zones, indices, options, out.cosmeticTriangles);
  return {};
}

}  // namespace cagecast
