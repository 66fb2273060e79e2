#include "geometry/closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tolerances.hpp"

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

}  // namespace cagecast
