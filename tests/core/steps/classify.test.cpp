// Verdicts on segments: the numbers of docs/method.md, each from both sides; thresholds and locks.

#include <algorithm>
#include <limits>

#include "checks.hpp"
#include "scenes/traps.hpp"

using namespace cagecast;

namespace {

/// A projection of two segments: a part, and a large one with depth `typical`.
struct Part {
  double covered = 0.5, exposed = 1, area = 1, depth = 0, uncovered = 0, hidden = 0;
  double typical = 0;
  float minCovered = 0;
};

CulledBy judged(const Part& of) {
  const std::vector<Visibility> visibility(2, Visibility::covered);
  const std::vector<std::uint32_t> segments{0, 1};
  std::vector<SegmentStats> stats(2);
  stats[0].area = stats[0].exposedArea = stats[0].coveredArea = 99;
  stats[0].depth = of.typical;
  stats[1].area = of.area, stats[1].exposedArea = of.exposed, stats[1].coveredArea = of.covered;
  stats[1].depth = of.depth;
  const std::vector<HoleShare> shares{{0, 0, 1, 90, 0}, {0, 1, 1, of.uncovered, of.hidden}, {1, 1, 1, 0.01, 0}};
  TransferOptions options;
  options.minCovered = of.minCovered;
  Zones out;
  REQUIRE(classify({visibility, segments, stats, {}, shares}, {}, options, out).ok());
  CHECK(out.culledBy[0] == CulledBy::none);
  CHECK((out.ratios[1].least() < 1) == (out.culledBy[1] != CulledBy::none));
  return out.culledBy[1];
}

Zones classified(const TransferResult& result, const scenes::Scene& scene, const TransferOptions& options) {
  Zones zones;
  REQUIRE(classify(result.projection.view(), scene.target.indices, options, zones).ok());
  return zones;
}

}  // namespace

TEST_CASE("a part is judged by the numbers of the method", "[classify]") {
  using enum CulledBy;
  const struct {
    Part part;
    CulledBy verdict;
  } cases[] = {
      {{.covered = 0.4999}, coverage},
      {{.covered = 0}, coverage},
      {{.covered = 0, .exposed = 0}, coverage},
      // Of a small one, covered area times coverage is at least `minCovered` of its area.
      {{.area = 1, .minCovered = 0.25f}, none},
      {{.area = 1.01, .minCovered = 0.25f}, coverage},
      // It may be .015 deeper than all together.
      {{.depth = 0.0349, .typical = 0.02}, none},
      {{.depth = 0.0352, .typical = 0.02}, coverage},
      // A quarter of what is exposed or hidden of it may be uncovered or hidden in a hole.
      {{.uncovered = 0.25}, none},
      {{.uncovered = 0.2501}, hole},
      {{.hidden = 0.333}, none},
      {{.hidden = 0.334}, hole},
      {{.uncovered = 0.09, .hidden = 0.2}, none},
      {{.uncovered = 0.11, .hidden = 0.2}, hole},
      {{.covered = 0.4999, .uncovered = 1}, coverage},
      // From a hundredth of all covered area on it is large: of that, a quarter of what is exposed may be uncovered.
      {{.covered = 0.99, .exposed = 1, .area = 100, .depth = 1, .uncovered = 1, .minCovered = 1}, coverage},
      {{.covered = 1.01, .exposed = 1.34, .area = 100, .depth = 1, .uncovered = 1, .minCovered = 1}, none},
      {{.covered = 1.01, .exposed = 1.35, .area = 100, .depth = 1, .uncovered = 1, .minCovered = 1}, coverage},
      {{.covered = 1.01, .exposed = 2, .area = 2, .depth = 1, .uncovered = 1, .minCovered = 0.25f}, none},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    INFO("case " << i);
    CHECK(judged(cases[i].part) == cases[i].verdict);
  }
}

TEST_CASE("a segment below the threshold is culled, one at it is not", "[classify]") {
  // Of a square whose corners have 2/6, 1/6, 2/6, 1/6 of its area, one large corner is not covered.
  const scenes::Mesh target = scenes::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  const scenes::Mesh cage =
      without(scenes::box({}, {2, 2, 2}, 4), [](scenes::Point p) { return p[2] < 2 || (p[0] > 0 && p[1] > 0); });
  for (const auto& [threshold, isCulled] : {std::pair{0.0f, false}, {0.66f, false}, {0.67f, true}, {1.0f, true}}) {
    TransferOptions options = TransferOptions::paper();
    options.threshold = threshold;
    const TransferResult result = transferred(cage.view(), target.view(), options);
    const SegmentStats& segment = result.projection.segmentStats[0];
    CHECK(segment.coverage() == Approx(2.0 / 3));
    CHECK(segment.score() == Approx(2.0 / 3 / static_cast<double>(threshold)));
    CHECK(segment.culled() == isCulled);
    const Zone covered = isCulled ? Zone::culled : Zone::cosmetic;
    CHECK(copied(result.zones.zones) == std::vector{covered, covered, covered, Zone::uncovered});
  }
}

TEST_CASE("a verdict is the surer, the farther the score is from 1, and sure where a lock decides", "[classify]") {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  struct Case {
    double score;
    CulledBy culledBy;
    double confidence;
  };
  for (const auto& [score, culledBy, confidence] :
       {Case{1, CulledBy::none, 0.5}, Case{2, CulledBy::none, 1 - 1.0 / 32},
        Case{0.5, CulledBy::coverage, 1 - 1.0 / 32}, Case{0, CulledBy::coverage, 1}, Case{kEndless, CulledBy::none, 1},
        Case{0.99, CulledBy::none, 1}, Case{0.99, CulledBy::lock, 1}, Case{1.01, CulledBy::lock, 1}}) {
    INFO("score " << score);
    SegmentStats stats;
    stats.ratios.floor = score;
    stats.culledBy = culledBy;
    CHECK(stats.confidence() == Approx(confidence));
  }
}

TEST_CASE("classify with another threshold equals transfer with it", "[classify]") {
  for (const scenes::Scene& scene : {scenes::strewn(firstSeed(), 300), scenes::crowdedHead(16, 0.06f)}) {
    for (TransferOptions options : {TransferOptions::paper(), TransferOptions{}}) {
      const TransferResult first = transferred(scene.cage.view(), scene.target.view(), options);
      for (const float threshold : {0.0f, 0.1f, 0.5f, 0.51f, 0.9f, 1.0f}) {
        options.threshold = threshold;
        const TransferResult whole = transferred(scene.cage.view(), scene.target.view(), options);
        const Zones zones = classified(first, scene, options);
        INFO(scene.name << ", threshold " << threshold << ", CAGECAST_SEED=" << firstSeed());
        CHECK(copied(zones.zones) == copied(whole.zones.zones));
        CHECK(copied(zones.cosmeticTriangles) == copied(whole.zones.cosmeticTriangles));
        CHECK(copied(zones.culledBy) == copied(whole.zones.culledBy));
        for (std::size_t s = 0; s < zones.culledBy.size(); ++s)
          CHECK(zones.ratios[s].least() == whole.projection.segmentStats[s].score());
      }
    }
  }
}

TEST_CASE("a lock overrides the verdict on its segment, not the score", "[classify][locks]") {
  const scenes::Scene scene = scenes::crowdedHead(16, 0);
  const TransferResult result = transferred(scene.cage.view(), scene.target.view(), {});
  for (std::uint32_t s = 0; s < result.projection.segmentStats.size(); ++s) {
    for (const Lock lock : {Lock::keep, Lock::exclude, Lock::automatic}) {
      INFO("segment " << s);
      const LockEntry locks[] = {{s, lock}};
      TransferOptions options;
      options.locks = locks;
      const Zones zones = classified(result, scene, options);
      CHECK(zones.culledBy[s] == (lock == Lock::keep      ? CulledBy::none
                                  : lock == Lock::exclude ? CulledBy::lock
                                                          : result.zones.culledBy[s]));
      CHECK(zones.ratios[s].least() == result.zones.ratios[s].least());
      for (std::size_t v = 0; v < scene.target.vertexCount() && lock != Lock::automatic; ++v) {
        if (result.projection.segments[v] != s) continue;
        const Visibility found = result.projection.visibility[v];
        if (found == Visibility::covered) {
          CHECK(zones.zones[v] == (lock == Lock::keep ? Zone::cosmetic : Zone::culled));
        } else if (lock == Lock::exclude) {
          CHECK(zones.zones[v] == (found == Visibility::occluded ? Zone::occluded : Zone::uncovered));
        }
      }
    }
  }
}

TEST_CASE("a lock by segment overrides one by group, and of several the last one counts", "[classify][locks]") {
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  scenes::Mesh target = scenes::box({}, {1, 1, 1}, 1);
  append(target, scenes::box({0.2f, 0, 0}, {1.1f, 1, 1}, 1));
  std::fill(target.groups.begin() + 24, target.groups.end(), 7u);
  using Locked = std::vector<LockEntry>;
  using Groups = std::vector<std::uint32_t>;
  constexpr auto kNone = CulledBy::none, kLock = CulledBy::lock, kIgnore = CulledBy::ignore;
  const struct {
    Locked locks;
    Groups ignore, keep, exclude;
    std::vector<CulledBy> verdicts;
  } cases[] = {{{}, {}, {}, {}, {kNone, kNone}},
               {{{0, Lock::exclude}}, {}, {}, {}, {kLock, kNone}},
               {{}, {}, {}, {7}, {kNone, kLock}},
               {{}, {}, {7}, {7}, {kNone, kNone}},
               {{}, {7}, {7}, {7}, {kNone, kIgnore}},
               {{{1, Lock::keep}}, {7}, {}, {}, {kNone, kIgnore}},
               {{{1, Lock::keep}}, {}, {}, {7}, {kNone, kNone}},
               {{{1, Lock::keep}, {1, Lock::automatic}}, {}, {}, {7}, {kNone, kNone}}};
  for (const auto& [locks, ignore, keep, exclude, verdicts] : cases) {
    TransferOptions options;
    options.locks = locks;
    options.parts = {ignore, keep, exclude};
    CHECK(copied(transferred(cage.view(), target.view(), options).zones.culledBy) == verdicts);
  }
}

TEST_CASE("a small part bare under a hole is culled, unless it is kept", "[classify]") {
  const scenes::Trap trap = scenes::aside();
  const TransferResult result = transferred(trap.scene.cage.view(), trap.scene.target.view(), {});
  REQUIRE(result.projection.segmentStats.size() == 3);
  using enum CulledBy;
  CHECK(copied(result.zones.culledBy) == std::vector{none, hole, hole});
  CHECK(result.projection.segmentStats[1].coverage() > 0.6);
  CHECK(result.zones.explainedHoles[result.projection.holeShares[0].hole] == 1);
  const LockEntry kept[] = {{1, Lock::keep}};
  TransferOptions options;
  options.locks = kept;
  CHECK(copied(classified(result, trap.scene, options).culledBy) == std::vector{none, none, hole});
}

TEST_CASE("a projection that is not whole, or not of this target, is an error", "[classify][errors]") {
  struct Parts {
    std::vector<Visibility> visibility{3, Visibility::covered};
    std::vector<std::uint32_t> segments{0, 0, 1}, recovery{0, 1, 2}, indices{0, 1, 2}, hiddenBy{0, 1, 6},
        hiders{0, 0, 1, 1, 1, 1, 1, 2, 2, 0, 1, 0};
    std::vector<SegmentStats> stats{2};
    std::vector<HoleShare> shares{{0, 1}, {2, 0}};
  };
  const struct {
    void (*change)(Parts&);
    Code code;
  } cases[] = {{[](Parts&) {}, Code::ok},
               {[](Parts& of) { of.indices.push_back(0); }, Code::indicesNotTriples},
               {[](Parts& of) { of.indices[2] = 3; }, Code::indexOutOfRange},
               {[](Parts& of) { of.segments.pop_back(); }, Code::resultMismatch},
               {[](Parts& of) { of.visibility.pop_back(); }, Code::resultMismatch},
               {[](Parts& of) { of.segments[1] = 2; }, Code::resultMismatch},
               {[](Parts& of) { of.recovery.pop_back(); }, Code::resultMismatch},
               {[](Parts& of) { of.hiddenBy.pop_back(); }, Code::resultMismatch},
               {[](Parts& of) { of.hiddenBy[0] = 11; }, Code::resultMismatch},
               {[](Parts& of) { of.hiddenBy[0] = UINT32_MAX; }, Code::resultMismatch},
               {[](Parts& of) { of.hiders[11] = 2; }, Code::resultMismatch},
               {[](Parts& of) { of.hiders.pop_back(); }, Code::resultMismatch},
               {[](Parts& of) { of.hiders[4] = UINT32_MAX; }, Code::resultMismatch},
               {[](Parts& of) { of.hiders[6] = 6; }, Code::resultMismatch},
               {[](Parts& of) { of.hiders[6] = 4; }, Code::resultMismatch},
               {[](Parts& of) { of.shares[0].segment = 2; }, Code::resultMismatch},
               {[](Parts& of) { of.shares[0].hole = 3; }, Code::resultMismatch},
               {[](Parts& of) { of.shares[1].hole = UINT32_MAX; }, Code::resultMismatch}};
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    Parts of;
    cases[i].change(of);
    Zones out;
    const Hiders hiders{of.hiddenBy, of.hiders};
    const Status status =
        classify({of.visibility, of.segments, of.stats, of.recovery, of.shares, hiders}, of.indices, {}, out);
    INFO("case " << i);
    CHECK(status.code == cases[i].code);
    CHECK(status.argument == (status.ok() ? Argument::none : Argument::target));
    if (status.code == Code::indexOutOfRange) CHECK(status.at == 2);
  }
}
