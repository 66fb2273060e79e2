#include <algorithm>
#include <cmath>
#include <limits>

#include "place.hpp"
#include "steps.hpp"

namespace cagecast {

Place placeOnEdge(const CageTriangle& t, Vec3 p, double height, double v, double w) noexcept {
  const Vec3 corners[3] = {Vec3::from(t.a), Vec3::from(t.b), Vec3::from(t.c)};
  const bool isBeyond[3] = {!(w > 0), !(v + w < 1), !(v > 0)};
  Place place{std::numeric_limits<double>::infinity(), 0, 0, height, false};
  for (int i = 0; i < 3; ++i) {
    if (!isBeyond[i]) continue;
    const Vec3 edge = corners[(i + 1) % 3] - corners[i];
    const Vec3 offset = p - corners[i];
    const double along = std::min(std::max(dot(offset, edge) * (1 / dot(edge, edge)), 0.0), 1.0);
    const Vec3 away = offset - along * edge;
    const double squared = dot(away, away);
    if (!(squared < place.distance)) continue;
    const double ofB[3] = {along, 1 - along, 0}, ofC[3] = {0, along, 1 - along};
    place = {squared, ofB[i], ofC[i], height, false};
  }
  place.distance = std::sqrt(place.distance);
  return place;
}

const Candidate& nearestOf(const Candidate* candidates, std::uint32_t count, double diagonal) noexcept {
  double least = candidates[0].place.distance;
  for (std::uint32_t i = 1; i < count; ++i) least = std::min(least, candidates[i].place.distance);
  const auto near = [&](const Candidate& c) { return c.place.distance <= least + kTieDistance * diagonal; };
  double farthest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (near(candidates[i])) farthest = std::max(farthest, std::abs(candidates[i].place.height));
  }
  const Candidate* first = nullptr;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Candidate& c = candidates[i];
    if (!near(c) || std::abs(c.place.height) < farthest - kTiePlane * diagonal) continue;
    if (first == nullptr || c.slot < first->slot) first = &c;
  }
  return *first;
}

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
    const Uv uv = uvAt(t, q);
    results.uvs[2 * i] = static_cast<float>(uv.u);
    results.uvs[2 * i + 1] = static_cast<float>(uv.v);
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
