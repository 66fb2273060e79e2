#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/closest_point.hpp"
#include "steps/steps.hpp"

namespace cagecast {

BorderPlace placeOnBorder(const CageTriangle& t, const Vec3& p, double v, double w) noexcept {
  BorderPlace place{std::numeric_limits<double>::infinity(), 0, 0};
  // On the way from one corner to another.
  const auto look = [&](const float* from, const float* to, auto placeAt) {
    const Vec3 corner = Vec3::from(from);
    const Vec3 edge = Vec3::from(to) - corner;
    const Vec3 offset = p - corner;
    const double along = std::min(std::max(dot(offset, edge) * (1 / dot(edge, edge)), 0.0), 1.0);
    const Vec3 away = offset - along * edge;
    if (const double squared = dot(away, away); squared < place.distance) place = placeAt(squared, along);
  };
  if (!(w > 0)) look(t.a, t.b, [](double squared, double along) { return BorderPlace{squared, along, 0}; });
  if (!(v + w < 1)) look(t.b, t.c, [](double squared, double along) { return BorderPlace{squared, 1 - along, along}; });
  if (!(v > 0)) look(t.c, t.a, [](double squared, double along) { return BorderPlace{squared, 0, 1 - along}; });
  place.distance = std::sqrt(place.distance);
  return place;
}

const Candidate& nearestOf(const Candidate* candidates, std::uint32_t count, double diagonal) noexcept {
  const Candidate* const end = candidates + count;
  double least = candidates->place.distance;
  for (const Candidate* c = candidates + 1; c < end; ++c) least = std::min(least, c->place.distance);
  const double most = least + kTieDistance * diagonal;
  double farthest = 0;
  for (const Candidate* c = candidates; c < end; ++c) {
    if (c->place.distance <= most) farthest = std::max(farthest, std::abs(c->place.height));
  }
  const double far = farthest - kTiePlane * diagonal;
  const Candidate* first = nullptr;
  for (const Candidate* c = candidates; c < end; ++c) {
    if (c->place.distance > most || std::abs(c->place.height) < far) continue;
    if (first == nullptr || c->slot < first->slot) first = c;
  }
  return *first;
}

bool projectPoints(const Points& points, const Cage& cage, const CageTree& tree, const Units& units, Arena& arena,
                   PointResults& results) noexcept {
  const Arena::Mark mark = arena.mark();
  auto* found = arena.allocate<std::uint32_t>(cage.count);
  auto* candidates = arena.allocate<Candidate>(cage.count);
  // Where positions are rounded, so is the search, by less than what a reach more makes it allow for.
  NearestSearch search(
      tree, points.rests == nullptr ? units.diagonal : units.diagonal + static_cast<double>(units.reach), arena);
  if (arena.failed()) return false;

  const auto nearestOfSeveral = [&](std::uint32_t member, Vec3 p) {
    const std::uint32_t count = search.candidates(member, found);
    for (std::uint32_t c = 0; c < count; ++c)
      candidates[c] = {found[c], closestPointOnTriangle(cage.triangles[found[c]], p)};
    return nearestOf(candidates, count, units.diagonal);
  };
  const PointResults out = results;
  const double start = kRayStart * units.diagonal;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t member = i % NearestSearch::kGroup;
    if (member == 0) search.search(points.at(i), std::min(NearestSearch::kGroup, points.count - i));
    const Vec3 p = points.exactly(i);
    const std::uint32_t only = search.onlyCandidate(member);
    const Candidate nearest = only == NearestSearch::kSeveral
                                  ? nearestOfSeveral(member, p)
                                  : Candidate{only, closestPointOnTriangle(cage.triangles[only], p)};

    const ClosestPoint& q = nearest.place;
    simd::storeRounded(out.uvs + std::size_t{2} * i, blendUvs(cage.triangles[nearest.slot], q));
    out.distances[i] = static_cast<float>(q.distance);
    out.triangles[i] = nearest.slot;
    // Strictly inside its triangle, q = p − height · n, so the ray hits it at −height.
    out.meetsCage[i] = q.inside && -q.height > -start;
    if (out.cageDistances != nullptr) out.cageDistances[i] = std::max(0.0, -q.height);
  }
  std::fill(out.zones, out.zones + points.count, Zone::cosmetic);
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
