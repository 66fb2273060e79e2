#include "cage/boundary_loops.hpp"

#include <algorithm>
#include <bit>

#include "base/union_find.hpp"

namespace cagecast {
namespace {

/// Points this close to an open edge, as a share of the diagonal, are on it, so that rounding does not decide.
constexpr double kOnLoop = 1e-6;

/// A triangle's corners, its edges as unit vectors and their lengths, its outward normal, and twice its area.
struct Frame {
  Vec3 corners[3], edges[3], normal;
  double lengths[3], doubleArea;

  explicit Frame(const CageTriangle& t) noexcept
      : corners{Vec3::from(t.a), Vec3::from(t.b), Vec3::from(t.c)}, normal(t.normal.exact) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 edge = corners[(k + 1) % 3] - corners[k];
      lengths[k] = length(edge);
      edges[k] = 1 / lengths[k] * edge;
    }
    doubleArea = dot(corners[2] - corners[0], inward(0)) * lengths[0];
  }
  [[nodiscard]] Vec3 inward(std::uint32_t k) const noexcept { return cross(normal, edges[k]); }
  /// From corner k to the one before.
  [[nodiscard]] Vec3 back(std::uint32_t k) const noexcept { return -1 * edges[(k + 2) % 3]; }
  /// How far from corner k along one of its edges a point is at a distance from the line of the other.
  [[nodiscard]] double along(std::uint32_t k, double distance) const noexcept {
    return distance * lengths[k] * lengths[(k + 2) % 3] / doubleArea;
  }
};

/// The least distance of some points from another in a direction.
double leastAlong(Vec3 direction, Vec3 from, std::span<const Vec3> points) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3 p : points) least = std::min(least, dot(p - from, direction));
  return least;
}

/// Whether no point is ahead of another in a direction.
bool areBehind(Vec3 direction, Vec3 from, std::span<const Vec3> points) {
  return leastAlong(-1 * direction, from, points) >= 0;
}

/// Whether all points of a convex hull are closest to the same corner, or the same edge, of a triangle, where that is
/// on no loop; of the edge's ends, only one that is on no loop may be closest.
/// @param loops  6, as in `BoundaryLoops::loopOf`.
/// @param near   How far from an edge that is on a loop, or an end of one, points must be.
bool areClosestOffLoops(const Frame& frame, const std::uint32_t* loops, std::span<const Vec3> hull, double near) {
  constexpr std::uint32_t kNone = BoundaryLoops::kNone;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t next = (k + 1) % 3;
    const Vec3 start = frame.corners[k], end = frame.corners[next];
    const bool isOff = loops[3 + k] == kNone;
    const bool areBehindBack = isOff && areBehind(frame.back(k), start, hull);
    if (areBehindBack && areBehind(frame.edges[k], start, hull)) return true;
    if (loops[k] != kNone || !areBehind(frame.inward(k), start, hull)) continue;
    const bool areAtStart = areBehindBack || leastAlong(frame.edges[k], start, hull) >= frame.along(k, near);
    const bool areAtEnd = (loops[3 + next] == kNone && areBehind(frame.edges[next], end, hull)) ||
                          leastAlong(-1 * frame.edges[k], end, hull) >= frame.along(next, near);
    if (areAtStart && areAtEnd) return true;
  }
  return false;
}

}  // namespace

void BoundaryLoops::Box::grow(Vec3 p) noexcept {
  const double at[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], at[k]);
    high[k] = std::max(high[k], at[k]);
  }
}

double BoundaryLoops::Box::diagonal() const noexcept {
  return length(Vec3{high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

std::uint32_t BoundaryLoops::elementAt(const CageTriangle& triangle, std::uint32_t cageTriangle, Vec3 q,
                                       double diagonal) const noexcept {
  if (!touches(cageTriangle)) return kNone;
  const std::uint32_t* loops = loopOf + std::size_t{6} * cageTriangle;
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  const double near = kOnLoop * diagonal * kOnLoop * diagonal;  // Squared, as all distances here.
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    if (loops[k] == kNone) continue;
    const Vec3 normal = cross(edge, q - corners[k]);
    if (dot(normal, normal) <= near * dot(edge, edge)) return k;
  }
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 offset = q - corners[k];
    if (loops[3 + k] != kNone && dot(offset, offset) <= near) return 3 + k;
  }
  return kNone;
}

bool BoundaryLoops::areSurelyOff(const CageTriangle& triangle, std::uint32_t cageTriangle, std::span<const Vec3> hull,
                                 double diagonal) const noexcept {
  if (!touches(cageTriangle)) return true;
  const std::uint32_t* loops = loopOf + std::size_t{6} * cageTriangle;
  const Frame frame(triangle);
  const double near = 2 * kOnLoop * diagonal;
  // Nothing is certain in a triangle so thin that all its points may be that near to an edge.
  for (const double length : frame.lengths) {
    if (frame.doubleArea < near * length) return false;
  }
  if (areClosestOffLoops(frame, loops, hull, near)) return true;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 corner = frame.corners[k];
    // A point on the inner side of an edge is not closest to the edge, except perhaps to its ends,
    if (loops[k] != kNone && leastAlong(frame.inward(k), corner, hull) < near) return false;
    if (loops[3 + k] == kNone) continue;
    // and it is not closest to a corner if it is ahead of it along one of the two edges there. So far ahead, the edges
    // are far enough from each other for rounding not to matter.
    const double enough = frame.along(k, near);
    if (leastAlong(frame.edges[k], corner, hull) < enough && leastAlong(frame.back(k), corner, hull) < enough)
      return false;
  }
  return true;
}

bool BoundaryLoops::areSurelyOn(const CageTriangle& triangle, std::uint32_t cageTriangle,
                                std::span<const Vec3> hull) const noexcept {
  if (!touches(cageTriangle)) return false;
  const std::uint32_t* loops = loopOf + std::size_t{6} * cageTriangle;
  const Frame frame(triangle);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t next = (k + 1) % 3;
    const Vec3 start = frame.corners[k], end = frame.corners[next];
    const bool areBehindBack = areBehind(frame.back(k), start, hull);
    // Points behind a corner along both of its edges are closest to the corner,
    if (loops[3 + k] != kNone && areBehindBack && areBehind(frame.edges[k], start, hull)) return true;
    // and points beyond an edge are closest to the edge if, at either end, they are not past that end, or are behind
    // the other edge there.
    if (loops[k] != kNone && areBehind(frame.inward(k), start, hull) &&
        (areBehindBack || leastAlong(frame.edges[k], start, hull) >= 0) &&
        (areBehind(frame.edges[next], end, hull) || areBehind(frame.edges[k], end, hull))) {
      return true;
    }
  }
  return false;
}

bool findBoundaryLoops(const Cage& cage, const HalfEdges& halfEdges, Arena& arena, BoundaryLoops& out) noexcept {
  const std::uint32_t halfEdgeCount = 3 * cage.count;
  const std::uint32_t vertexCount = halfEdges.vertexCount;
  const std::uint32_t* origins = halfEdges.origins;
  auto* loopOf = arena.allocate<std::uint32_t>(std::size_t{2} * halfEdgeCount);
  auto* boxes = arena.allocate<BoundaryLoops::Box>(std::min(halfEdgeCount, vertexCount));
  const Arena::Scope scope(arena);
  auto* open = arena.allocate<std::uint32_t>(halfEdgeCount);
  auto* parents = arena.allocate<std::uint32_t>(vertexCount);
  auto* loopAt = arena.allocate<std::uint32_t>(vertexCount);
  if (arena.failed()) return false;

  const auto isOpen = [&](std::uint32_t halfEdge) { return halfEdges.nextOfEdge[halfEdge] == halfEdge; };
  const auto endOf = [&](std::uint32_t halfEdge) { return origins[HalfEdges::after(halfEdge)]; };
  std::uint32_t openCount = 0;
  for (std::uint32_t halfEdge = 0; halfEdge < halfEdgeCount; ++halfEdge) {
    if (isOpen(halfEdge)) open[openCount++] = halfEdge;
  }
  UnionFind sets(parents, vertexCount);
  for (std::uint32_t i = 0; i < openCount; ++i) sets.join(origins[open[i]], endOf(open[i]));
  std::fill(loopAt, loopAt + vertexCount, BoundaryLoops::kNone);
  out.count = 0;
  for (std::uint32_t i = 0; i < openCount; ++i) {
    const std::uint32_t halfEdge = open[i];
    std::uint32_t& loop = loopAt[sets.find(origins[halfEdge])];
    if (loop == BoundaryLoops::kNone) {
      boxes[out.count] = {};
      loop = out.count++;
    }
    loopAt[origins[halfEdge]] = loopAt[endOf(halfEdge)] = loop;
    const CageTriangle& t = cage.triangles[halfEdge / 3];
    const float* corners[3] = {t.a, t.b, t.c};
    boxes[loop].grow(Vec3::from(corners[halfEdge % 3]));
    boxes[loop].grow(Vec3::from(corners[(halfEdge % 3 + 1) % 3]));
  }
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t halfEdge = 3 * t + k;
      const std::uint32_t loop = loopAt[origins[halfEdge]];
      loopOf[6 * std::size_t{t} + k] = isOpen(halfEdge) ? loop : BoundaryLoops::kNone;
      loopOf[6 * std::size_t{t} + 3 + k] = loop;
    }
  }
  out.boxes = boxes;
  out.loopOf = loopOf;
  return true;
}

}  // namespace cagecast
