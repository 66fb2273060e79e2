// Judges the segments of any projection that is consistent in itself, by any options and locks.

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t vertices = input.below(60), segments = 1 + input.below(12), holes = input.below(6);
  std::vector<Visibility> visibility;
  std::vector<std::uint32_t> ofVertex, recovery, indices, hiddenBy, hiders;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    visibility.push_back(static_cast<Visibility>(input.below(3)));
    ofVertex.push_back(input.below(segments));
    recovery.push_back(input.below(Recovery::throughHole + holes));
  }
  for (std::uint32_t i = 3 * input.below(60); i > 0 && vertices > 0; --i) indices.push_back(input.below(vertices));
  std::vector<SegmentStats> stats(segments);
  for (std::uint32_t s = 0; s < segments; ++s) {
    stats[s].area = static_cast<double>(input.share());
    stats[s].exposedArea = stats[s].area * static_cast<double>(input.share());
    stats[s].coveredArea = stats[s].exposedArea * static_cast<double>(input.share());
    stats[s].depth = static_cast<double>(input.share());
    stats[s].group = input.below(4);
  }
  std::vector<HoleShare> shares;
  for (std::uint32_t hole = 0; hole < holes; ++hole)
    shares.push_back({hole, input.below(segments), static_cast<double>(input.share()),
                      static_cast<double>(input.share()), static_cast<double>(input.share())});
  for (std::uint32_t i = input.below(20); i > 0; --i) hiders.push_back(input.below(4));
  if (!hiders.empty()) {
    for (std::uint32_t v = 0; v < vertices; ++v) hiddenBy.push_back(input.below(20));
  }
  TransferOptions options = input.options();
  std::vector<LockEntry> locks;
  for (std::uint32_t i = input.below(4); i > 0; --i)
    locks.push_back({input.below(16), static_cast<Lock>(input.below(3))});
  options.locks = locks;

  const ProjectionView projection{visibility, ofVertex, stats, recovery, shares, {hiddenBy, hiders}};
  Zones out;
  const Status status = classify(projection, indices, options, out);
  if (!status.ok()) return 0;
  require(out.zones.size() == vertices && out.ratios.size() == segments);
  require(3 * out.cosmeticTriangles.size() == indices.size());
  for (const Ratios& of : out.ratios) {
    for (const double ratio : {of.threshold, of.floor, of.depth, of.hole}) require(ratio >= 0);
  }
  for (const Zone zone : out.zones) require(zone <= Zone::culled);
  return 0;
}
