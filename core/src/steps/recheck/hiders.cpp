#include "steps/recheck/hiders.hpp"

#include <algorithm>
#include <limits>

#include "base/hash_index.hpp"
#include "base/tolerances.hpp"
#include "cagecast/result.hpp"
#include "search/ray_search.hpp"
#include "steps/normal_ray.hpp"
#include "steps/typical_depth.hpp"

namespace cagecast {

HiderRecords::HiderRecords(Arena& arena) noexcept : recent_(arena.allocate<std::uint32_t>(kSlots)) {
  words_.add(0);
  if (!arena.failed()) std::fill(recent_, recent_ + kSlots, 0u);
}

bool HiderRecords::isWithin(std::size_t one, std::size_t other) const noexcept {
  const auto end = [&](std::size_t ray) { return &words_[ray] + 1 + words_[ray]; };
  return std::includes(&words_[other] + 1, end(other), &words_[one] + 1, end(one));
}

std::uint32_t HiderRecords::add(std::uint32_t enough, std::span<const std::uint32_t> rays,
                                const SegmentHits& hits) noexcept {
  const std::size_t start = words_.size();
  words_.add(0);
  words_.add(enough);
  words_.add(0);
  // Rays that hit the fewest come first; of equals the first, on every platform.
  std::uint32_t counts[kMaxRays] = {};
  for (std::size_t i = 0; i < rays.size(); ++i) hits.each(rays[i], [&](std::uint32_t) { ++counts[i]; });
  std::uint32_t order[kMaxRays];
  for (std::uint32_t i = 0; i < rays.size(); ++i) order[i] = i;
  std::sort(order, order + rays.size(),
            [&](std::uint32_t a, std::uint32_t b) { return counts[a] != counts[b] ? counts[a] < counts[b] : a < b; });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t at = words_.size();
    words_.add(counts[order[i]]);
    hits.each(rays[order[i]], [&](std::uint32_t segment) { words_.add(segment); });
    if (words_.failed()) return 0;
    std::sort(&words_[at] + 1, &words_[at] + 1 + words_[at]);
    // If it is free, enough others are.
    std::uint32_t within = 0;
    for (std::size_t other = start + kHead; other < at; other += 1 + words_[other]) within += isWithin(other, at);
    if (within >= enough) {
      words_.truncate(at);
    } else {
      ++words_[start + 2];
    }
  }
  return shared(start);
}

std::uint32_t HiderRecords::either(std::uint32_t earlier, std::uint32_t record) noexcept {
  if (earlier == 0 || isFree(record)) return record;
  if (earlier == record || isFree(earlier)) return earlier;
  const std::size_t start = words_.size();
  words_.add(earlier);
  const std::size_t end = endOf(record);
  for (std::size_t i = record + std::size_t{1}; i < end; ++i) {
    const std::uint32_t word = words_[i];  // A copy, as the list may grow.
    words_.add(word);
  }
  return words_.failed() ? 0 : shared(start);
}

std::uint32_t HiderRecords::shared(std::size_t start) noexcept {
  const std::size_t size = words_.size() - start;
  std::uint64_t hash = size;
  for (std::size_t i = start; i < words_.size(); ++i) hash = HashIndex::mix(hash, words_[i]);
  std::uint32_t& recent = recent_[hash >> 32 & (kSlots - 1)];
  if (recent != 0 && start - recent >= size && std::equal(&words_[start], &words_[start] + size, &words_[recent])) {
    words_.truncate(start);
  } else {
    recent = static_cast<std::uint32_t>(start);
  }
  return recent;
}

std::size_t HiderRecords::endOf(std::size_t record) const noexcept {
  std::size_t at = record + kHead;
  for (std::uint32_t rays = words_[record + 2]; rays > 0; --rays) at += 1 + words_[at];
  return at;
}

bool HiderRecords::isFree(std::size_t record) const noexcept {
  // Rays that hit the fewest come first.
  std::uint32_t missing = words_[record + 1];
  std::size_t at = record + kHead;
  for (std::uint32_t rays = words_[record + 2]; rays > 0 && missing > 0 && words_[at] == 0; --rays, ++at) --missing;
  return missing == 0;
}

void findHiders(const Scene& scene, PointData& data, const Array<SegmentStats>& stats, HiderRecords& records) noexcept {
  Arena& arena = scene.arena;
  data.hiddenBy = arena.allocate<std::uint32_t>(data.points.count);
  const Arena::Scope scope(arena);
  auto* rays = arena.allocate<Ray>(RaySearch::kMaxRays);
  auto* pointOfRay = arena.allocate<std::uint32_t>(RaySearch::kMaxRays);
  auto* hitsOwn = arena.allocate<bool>(RaySearch::kMaxRays);
  RaySearch search(scene.targetTree, scene.length(kRayStart), arena);
  SegmentHits hits(data.segments, RaySearch::kMaxRays, arena);
  if (arena.failed()) return;
  std::fill(data.hiddenBy, data.hiddenBy + data.points.count, 0u);
  if (stats.size() < 2) return;
  const double reach = scene.length(static_cast<double>(scene.options.occlusionReach));
  const double deepest = scene.length(TypicalDepth(stats).most());
  std::uint32_t count = 0;
  const auto send = [&] {
    search.search(rays, count, hitsOwn, hits);
    for (std::uint32_t r = 0; r < count; ++r) {
      if (hitsOwn[r]) continue;
      const std::uint32_t p = pointOfRay[r];
      data.hiddenBy[p] = records.add(1, {&r, 1}, hits);
      if (data.cageDistances[p] < std::numeric_limits<double>::infinity()) data.recovery[p] = Recovery::always;
    }
    count = 0;
  };
  for (std::uint32_t p = 0; p < data.points.count; ++p) {
    const std::uint32_t segment = data.segments[p];
    if (data.visibility[p] != Visibility::occluded || !(stats[segment].coveredArea > 0)) continue;
    if (static_cast<double>(data.distances[p]) > deepest) continue;
    if (data.segments[data.occluders[p]] == segment) continue;
    pointOfRay[count] = p;
    hits.own[count] = segment;
    setNormalRay(rays[count], data, scene.cage, p);
    rays[count++].end = data.cageDistances[p] + reach;
    if (count == RaySearch::kMaxRays) send();
  }
  send();
  if (hits.failed() || records.failed()) arena.fail();
}

}  // namespace cagecast
