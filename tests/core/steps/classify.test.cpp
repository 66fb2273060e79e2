// Verdicts on segments that are made by hand: the numbers of docs/method.md, each from both sides.

#include "checks.hpp"

using namespace cagecast;

namespace {

/// A projection of one vertex per segment.
struct Segments {
  std::vector<SegmentStats> stats;
  std::vector<HoleShare> shares;
  TransferOptions options;

  Segments() {
    options.threshold = 0.25f;
    options.minCovered = 0;
  }
  /// @param covered  Of an exposed area of 1.
  std::uint32_t add(double covered, double exposed = 1) {
    const auto s = static_cast<std::uint32_t>(stats.size());
    stats.push_back({1, 0, s, CulledBy::none, exposed, exposed, covered, covered});
    return s;
  }
  std::vector<CulledBy> culledBy() const {
    const std::vector<Zone> zones(stats.size(), Zone::cosmetic);
    std::vector<std::uint32_t> segments(stats.size());
    for (std::uint32_t s = 0; s < stats.size(); ++s) segments[s] = s;
    Zones out;
    REQUIRE(classify({zones, segments, stats, {}, shares}, {}, options, out).ok());
    return copied(out.culledBy);
  }
};

constexpr auto kKept = CulledBy::none, kCulled = CulledBy::coverage;
using Verdicts = std::vector<CulledBy>;

}  // namespace

TEST_CASE("twins are judged together if the scores of both are from a half to less than 2", "[classify]") {
  // With this threshold, a score is four times the covered area.
  const auto judged = [](double first, double second, auto change) {
    Segments call;
    call.add(first / 4);
    call.add(second / 4);
    call.stats[1].twinOf = 0;
    change(call.options);
    return call.culledBy();
  };
  const auto asUsual = [](TransferOptions&) {};
  CHECK(judged(0.9, 1.2, asUsual) == Verdicts{kKept, kKept});
  CHECK(judged(0.5, 1.9, asUsual) == Verdicts{kKept, kKept});
  CHECK(judged(0.9, 1, asUsual) == Verdicts{kCulled, kCulled});
  CHECK(judged(0.49, 1.9, asUsual) == Verdicts{kCulled, kKept});
  CHECK(judged(0.49, 1.2, asUsual) == Verdicts{kCulled, kKept});
  CHECK(judged(2, 0.9, asUsual) == Verdicts{kKept, kCulled});
  CHECK(judged(0.9, 1.2, [](TransferOptions& to) { to.steps.twins = false; }) == Verdicts{kCulled, kKept});
  CHECK(judged(0.9, 1.2, [](TransferOptions& to) { to.steps.floor = Floor::none; }) == Verdicts{kCulled, kKept});
}

TEST_CASE("a projection that is not whole, or not of this target, is an error", "[classify]") {
  const std::vector<std::uint32_t> indices{0, 1, 2};
  struct Parts {
    std::vector<Zone> zones{3, Zone::cosmetic};
    std::vector<std::uint32_t> segments{0, 0, 1}, recovery{0, 1, 2};
    std::vector<SegmentStats> stats{2};
    std::vector<HoleShare> shares{{0, 1}, {2, 0}};
    Status classify(std::span<const std::uint32_t> of) const {
      Zones out;
      return cagecast::classify({zones, segments, stats, recovery, shares}, of, {}, out);
    }
  };
  CHECK(Parts{}.classify(indices).ok());
  CHECK(Parts{}.classify(std::vector<std::uint32_t>{0, 1, 2, 0}).code == Code::indicesNotTriples);
  const Status stray = Parts{}.classify(std::vector<std::uint32_t>{0, 1, 3});
  CHECK(stray.code == Code::indexOutOfRange);
  CHECK(stray.at == 2);
  const auto isMismatch = [&](auto change) {
    Parts parts;
    change(parts);
    const Status status = parts.classify(indices);
    return status.code == Code::resultMismatch && status.argument == Argument::target;
  };
  CHECK(isMismatch([](Parts& of) { of.segments.pop_back(); }));
  CHECK(isMismatch([](Parts& of) { of.zones.pop_back(); }));
  CHECK(isMismatch([](Parts& of) { of.segments[1] = 2; }));
  CHECK(isMismatch([](Parts& of) { of.recovery.pop_back(); }));
  CHECK(isMismatch([](Parts& of) { of.stats[0].twinOf = 2; }));
  CHECK(isMismatch([](Parts& of) { of.shares[0].segment = 2; }));
  CHECK(isMismatch([](Parts& of) { of.shares[0].hole = 3; }));
  CHECK(isMismatch([](Parts& of) { of.shares[1].hole = UINT32_MAX; }));
}

TEST_CASE("a small part is culled where the hole is meant for it, by the numbers of the method", "[classify]") {
  /// Whether a small part is culled.
  const auto isCulled = [](double uncovered, double hidden, double uncoveredOfOthers, double covered = 0.5,
                           double exposedOfCulled = 0) {
    Segments call;
    const std::uint32_t part = call.add(covered, 2 * covered), others = call.add(99.5, 100), culled = call.add(0);
    call.shares = {{0, part, 1, uncovered, hidden}, {0, others, 1, uncoveredOfOthers, 0}};
    if (exposedOfCulled > 0) call.shares.push_back({0, culled, exposedOfCulled, 0, 0});
    const Verdicts verdicts = call.culledBy();
    CHECK(verdicts[others] == kKept);
    CHECK(verdicts[culled] == kCulled);
    return verdicts[part] == CulledBy::hole;
  };
  // Uncovered in more than .15 of what is exposed of it,
  CHECK(isCulled(0.16, 0, 0));
  CHECK(!isCulled(0.14, 0, 0));
  // with at least a quarter of what is uncovered at the hole,
  CHECK(isCulled(0.5, 0, 1.49));
  CHECK(!isCulled(0.5, 0, 1.51));
  // which nothing explains that is at least a fiftieth of it,
  CHECK(!isCulled(0.5, 0, 0.5, 0.5, 0.021));
  CHECK(isCulled(0.5, 0, 0.5, 0.5, 0.019));
  // or hidden in more than a quarter of what is exposed or hidden of it;
  CHECK(isCulled(0, 0.34, 0));
  CHECK(!isCulled(0, 0.33, 0));
  // all if it has less than a fiftieth of what is covered. (2.03 of 101.53, and 2.05 of 101.55.)
  CHECK(isCulled(0.7, 0, 0, 2.03));
  CHECK(!isCulled(0.7, 0, 0, 2.05));
}
