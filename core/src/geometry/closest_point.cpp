#include "geometry/closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tolerances.hpp"

namespace cagecast {

ClosestEdgePoint closestPointOnEdges(const Triangle& t, const Vec3& p, double v, double w) noexcept {
  ClosestEdgePoint closest{std::numeric_limits<double>::infinity(), 0, 0};  // With its squared distance for now.
  /// @param pointAt  Makes the result from the squared distance and the share of the edge that lies before the point.
  const auto tryEdge = [&](const float* from, const float* to, auto pointAt) {
    const Vec3 corner = Vec3::from(from);
    const Vec3 edge = Vec3::from(to) - corner;
    const Vec3 offset = p - corner;
    const double along = std::min(std::max(dot(offset, edge) * (1 / dot(edge, edge)), 0.0), 1.0);
    const Vec3 away = offset - along * edge;
    if (const double squared = dot(away, away); squared < closest.distance) closest = pointAt(squared, along);
  };
  // Only the edges that the projection lies beyond can be closest.
  if (!(w > 0)) tryEdge(t.a, t.b, [](double squared, double s) { return ClosestEdgePoint{squared, s, 0}; });
  if (!(v + w < 1)) tryEdge(t.b, t.c, [](double squared, double s) { return ClosestEdgePoint{squared, 1 - s, s}; });
  if (!(v > 0)) tryEdge(t.c, t.a, [](double squared, double s) { return ClosestEdgePoint{squared, 0, 1 - s}; });
  closest.distance = std::sqrt(closest.distance);
  return closest;
}

const Candidate& nearestOf(const Candidate* candidates, std::uint32_t count, double diagonal) noexcept {
  const Candidate* const end = candidates + count;
  double least = candidates->point.distance;
  for (const Candidate* c = candidates + 1; c < end; ++c) least = std::min(least, c->point.distance);
  const double most = least + kTieDistance * diagonal;
  double farthest = 0;
  for (const Candidate* c = candidates; c < end; ++c) {
    if (c->point.distance <= most) farthest = std::max(farthest, std::abs(c->point.height));
  }
  const double far = farthest - kTiePlane * diagonal;
  const Candidate* first = nullptr;
  for (const Candidate* c = candidates; c < end; ++c) {
    if (c->point.distance > most || std::abs(c->point.height) < far) continue;
    if (first == nullptr || c->cageTriangle < first->cageTriangle) first = c;
  }
  return *first;
}

}  // namespace cagecast
