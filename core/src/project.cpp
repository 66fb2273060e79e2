#include <algorithm>

#include "place.hpp"
#include "steps.hpp"

namespace cagecast {

bool projectPoints(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Scratch& scratch,
                   PointResults& results) noexcept {
  const Scratch::Mark mark = scratch.mark();
  auto* found = scratch.take<std::uint32_t>(cage.count);
  auto* candidates = scratch.take<Candidate>(cage.count);
  // Where positions are rounded, so is the search, by less than what a reach more makes it allow for.
  NearestSearch search(tree, points.rests == nullptr ? units.diagonal : units.diagonal + static_cast<double>(units.reach), scratch);
  if (scratch.failed()) return false;

  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t member = i % NearestSearch::kGroup;
    if (member == 0) search.search(points.at(i), std::min(NearestSearch::kGroup, points.count - i));
    const Vec3 p = points.exactly(i);
    const std::uint32_t count = search.candidates(member, found);
    Candidate nearest{found[0], placeOn(cage.triangles[found[0]], p)};
    if (count > 1) {
      candidates[0] = nearest;
      for (std::uint32_t c = 1; c < count; ++c) candidates[c] = {found[c], placeOn(cage.triangles[found[c]], p)};
      nearest = nearestOf(candidates, count, units.diagonal);
    }

    const CageTriangle& t = cage.triangles[nearest.slot];
    const Place& q = nearest.place;
    uvAt(t, q, results.uvs + std::size_t{2} * i);
    results.distances[i] = static_cast<float>(q.distance);
    results.triangles[i] = nearest.slot;
    results.zones[i] = Zone::cosmetic;
    // Strictly inside its triangle, q = p − height · n, so the ray hits it at −height.
    results.meetsCage[i] = q.inside && -q.height > -kRayStart * units.diagonal;
    if (results.cageDistances != nullptr) results.cageDistances[i] = std::max(0.0, -q.height);
  }
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
