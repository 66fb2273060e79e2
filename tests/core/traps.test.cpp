// Models that were made to be difficult: what must stay bare does, the rest is painted, and each needs the steps that
// it was made for.

#include "scenes/traps.hpp"

#include <algorithm>

#include "checks.hpp"
#include "reference/scene.hpp"

using namespace cagecast;
using scenes::Label;
using scenes::Trap;

namespace {

/// How well a trap is met, as shares of the area of what is to be left bare, and of what is to be painted.
struct Score {
  double suppressed = 0, kept = 0;
};

Score scoreOf(const Trap& trap, const TransferOptions& options) {
  const MeshView target = trap.scene.target.view();
  const TransferResult result = transferred(trap.scene.cage.view(), target, options);
  double all[3] = {}, right[3] = {};
  for (std::size_t i = 0; i < target.indices.size(); ++i) {
    const std::size_t t = i / 3 * 3;
    const reference::Vec a = reference::vertex(target, target.indices[t]);
    const double area = length(cross(reference::vertex(target, target.indices[t + 1]) - a,
                                     reference::vertex(target, target.indices[t + 2]) - a));
    const std::uint32_t v = target.indices[i];
    const auto label = static_cast<std::size_t>(trap.truth[v]);
    all[label] += area;
    if ((result.zones.zones[v] == Zone::cosmetic) == (trap.truth[v] == Label::painted)) right[label] += area;
  }
  const auto share = [&](Label label) {
    const auto i = static_cast<std::size_t>(label);
    return all[i] > 0 ? right[i] / all[i] : 1;
  };
  return {share(Label::bare), share(Label::painted)};
}

}  // namespace

TEST_CASE("on difficult models, what must stay bare does and the rest is painted, at any threshold", "[traps]") {
  for (const Trap& trap : scenes::traps()) {
    for (const float threshold : {0.3f, 0.5f, 0.8f}) {
      INFO(trap.scene.name << ", threshold " << threshold);
      TransferOptions options;
      options.threshold = threshold;
      const Score score = scoreOf(trap, options);
      CHECK(score.suppressed >= 0.998);
      CHECK(score.kept >= 0.998);
    }
  }
}

TEST_CASE("each difficult model needs the steps that it was made for", "[traps]") {
  struct Need {
    Trap trap;
    const char* step;
    void (*leaveOut)(TransferOptions&);
    double maxSuppressed, maxKept;
  };
  const auto withoutReach = [](TransferOptions& o) { o.occlusionReach = kInfinity; };
  const auto withoutPoke = [](TransferOptions& o) { o.pokeThrough = 0; };
  const auto withoutSamples = [](TransferOptions& o) { o.steps.interiorSamples = false; };
  const auto withoutFloor = [](TransferOptions& o) { o.steps.floor = false; };
  const auto withoutRecheck = [](TransferOptions& o) { o.steps.recheck = false; };
  const auto withoutHoles = [](TransferOptions& o) { o.steps.holes = false; };
  const Need needs[] = {{scenes::domed(), "occlusionReach", withoutReach, 1, 0},
                        {scenes::wrapped(), "pokeThrough", withoutPoke, 1, 0},
                        {scenes::glazed(), "interiorSamples", withoutSamples, 0, 1},
                        {scenes::clothed(false), "floor", withoutFloor, 0.95, 1},
                        {scenes::clothed(true), "floor", withoutFloor, 0.95, 1},
                        {scenes::doubled(false), "recheck", withoutRecheck, 1, 0.99},
                        {scenes::doubled(true), "recheck", withoutRecheck, 1, 0.99},
                        {scenes::hatted(), "recheck", withoutRecheck, 1, 0.7},
                        {scenes::aside(), "holes", withoutHoles, 0.7, 1},
                        {scenes::bespectacled(), "holes", withoutHoles, 0.6, 1}};
  for (const Need& need : needs) {
    INFO(need.trap.scene.name << " without " << need.step);
    TransferOptions options;
    need.leaveOut(options);
    const Score score = scoreOf(need.trap, options);
    CHECK(score.suppressed <= need.maxSuppressed);
    CHECK(score.kept <= need.maxKept);
  }
}
