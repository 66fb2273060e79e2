#include "clip/tie.hpp"

#include <algorithm>
#include <cmath>

#include "base/tolerances.hpp"

namespace cagecast {
namespace {

constexpr std::uint32_t after(std::uint32_t k) { return (k + 1) % 3; }

/// Whether no point is ahead of a corner along a direction.
bool isBehind(Vec3 direction, Vec3 corner, Hull hull) {
  return std::all_of(hull.begin(), hull.end(), [&](Vec3 p) { return dot(p - corner, direction) <= 0; });
}

/// Where the points of a part are closest to one triangle.
class ClosestFeature {
 public:
  ClosestFeature(const CageTriangle& t, Hull hull) noexcept
      : corners_{Vec3::from(t.a), Vec3::from(t.b), Vec3::from(t.c)}, normal_(t.normal.exact), hull_(hull) {}

  /// Whether the points are closest to a corner: they are behind it along both of its edges.
  [[nodiscard]] bool isCorner(std::uint32_t k) const noexcept {
    const std::uint32_t next = after(k), last = after(next);
    return isBehind(corners_[next] - corners_[k], corners_[k], hull_) &&
           isBehind(corners_[last] - corners_[k], corners_[k], hull_);
  }
  /// Whether the points are closest to the edge from a corner to the next one, ends included: they are beyond it, and
  /// at an end with an obtuse angle also behind that along the other edge there. All of this holds between such points
  /// too.
  [[nodiscard]] bool isEdge(std::uint32_t k) const noexcept {
    const Vec3 start = corners_[k], end = corners_[after(k)], opposite = corners_[after(after(k))];
    const Vec3 along = end - start;
    if (!isBehind(cross(normal_, along), start, hull_)) return false;
    const bool isObtuseAtStart = dot(along, opposite - start)<0, isObtuseAtEnd = dot(along, opposite - end)> 0;
    return (!isObtuseAtStart || isBehind(opposite - start, start, hull_)) &&
           (!isObtuseAtEnd || isBehind(opposite - end, end, hull_));
  }

 private:
  Vec3 corners_[3];
  Vec3 normal_;
  Hull hull_;
};

bool hasCorner(const CageTriangle& t, const float* corner) {
  const auto isSame = [&](const float* own) { return std::equal(own, own + 3, corner); };
  return isSame(t.a) || isSame(t.b) || isSame(t.c);
}

/// Whether the plane of one triangle is farther than that of another from all points of a part, by more than `least`.
bool isPlaneFarther(const CageTriangle& far, const CageTriangle& near, Hull hull, double least) {
  const auto height = [](const CageTriangle& t, Vec3 p) { return dot(p - Vec3::from(t.a), t.normal.exact); };
  // On one side of a plane, the difference is concave: it is least at a corner of the part.
  const double side = height(far, hull.front()) < 0 ? -1 : 1;
  return std::all_of(hull.begin(), hull.end(),
                     [&](Vec3 p) { return side * height(far, p) - std::abs(height(near, p)) >= least; });
}

}  // namespace

bool losesTie(const Cage& cage, std::uint32_t loser, std::uint32_t winner, Hull hull, double diagonal) noexcept {
  const CageTriangle& t = cage.triangles[loser];
  const CageTriangle& other = cage.triangles[winner];
  const bool isShared[3] = {hasCorner(other, t.a), hasCorner(other, t.b), hasCorner(other, t.c)};
  if (!isShared[0] && !isShared[1] && !isShared[2]) return false;
  // Of planes that are equally far, the first triangle wins.
  const double least = winner < loser ? 0 : 2 * kTiePlane * diagonal;
  if (!isPlaneFarther(other, t, hull, least)) return false;
  const ClosestFeature closest(t, hull);
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (isShared[k] && (closest.isCorner(k) || (isShared[after(k)] && closest.isEdge(k)))) return true;
  }
  return false;
}

}  // namespace cagecast
