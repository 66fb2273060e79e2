#include "cage/boundary_loops.hpp"

#include <algorithm>
#include <bit>

#include "base/union_find.hpp"

namespace cagecast {
namespace {

/// A place within this share of the diagonal of an open edge is on it, so that rounding does not decide.
constexpr double kOnRim = 1e-6;

/// A triangle's corners, its edges as unit vectors and their lengths, and its outward normal.
struct Frame {
  Vec3 corners[3], edges[3], normal;
  double lengths[3];

  explicit Frame(const CageTriangle& t) noexcept
      : corners{Vec3::from(t.a), Vec3::from(t.b), Vec3::from(t.c)}, normal(t.normal.exact) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 edge = corners[(k + 1) % 3] - corners[k];
      lengths[k] = length(edge);
      edges[k] = 1 / lengths[k] * edge;
    }
  }
  [[nodiscard]] Vec3 inward(std::uint32_t k) const noexcept { return cross(normal, edges[k]); }
  /// From corner k to the one before.
  [[nodiscard]] Vec3 back(std::uint32_t k) const noexcept { return -1 * edges[(k + 2) % 3]; }
};

/// How far places are from another in a direction: the least of them.
double leastAlong(Vec3 direction, Vec3 from, std::span<const Vec3> places) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3 p : places) least = std::min(least, dot(p - from, direction));
  return least;
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

std::uint32_t BoundaryLoops::sideAt(const CageTriangle& triangle, std::uint32_t slot, Vec3 q,
                                    double diagonal) const noexcept {
  if (!touches(slot)) return kNone;
  const std::uint32_t* sides = ofSides + std::size_t{6} * slot;
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  const double near = kOnRim * diagonal * kOnRim * diagonal;  // All squared: no roots.
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    if (sides[k] == kNone) continue;
    const Vec3 beside = cross(edge, q - corners[k]);
    if (dot(beside, beside) <= near * dot(edge, edge)) return k;
  }
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 offset = q - corners[k];
    if (sides[3 + k] != kNone && dot(offset, offset) <= near) return 3 + k;
  }
  return kNone;
}

bool BoundaryLoops::areOff(const CageTriangle& triangle, std::uint32_t slot, std::span<const Vec3> corners,
                           double diagonal) const noexcept {
  if (!touches(slot)) return true;
  const std::uint32_t* sides = ofSides + std::size_t{6} * slot;
  const Frame frame(triangle);
  const double doubleArea = dot(frame.corners[2] - frame.corners[0], frame.inward(0)) * frame.lengths[0];
  const double near = 2 * kOnRim * diagonal;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 corner = frame.corners[k];
    // On the inner side of an edge no place is nearest to it but for its ends,
    if (sides[k] != kNone && leastAlong(frame.inward(k), corner, corners) < near) return false;
    if (sides[3 + k] == kNone) continue;
    // and none is to a corner that is on the way to another. So far from there the two edges are far enough from each
    // other.
    const double enough = near * frame.lengths[k] * frame.lengths[(k + 2) % 3] / doubleArea;
    if (doubleArea < 2 * enough * frame.lengths[(k + 1) % 3]) return false;
    if (leastAlong(frame.edges[k], corner, corners) < enough && leastAlong(frame.back(k), corner, corners) < enough)
      return false;
  }
  return true;
}

bool BoundaryLoops::areOn(const CageTriangle& triangle, std::uint32_t slot,
                          std::span<const Vec3> corners) const noexcept {
  if (!touches(slot)) return false;
  const std::uint32_t* sides = ofSides + std::size_t{6} * slot;
  const Frame frame(triangle);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t next = (k + 1) % 3;
    const Vec3 start = frame.corners[k], end = frame.corners[next];
    const auto areBehind = [corners](Vec3 direction, Vec3 from) {
      return leastAlong(-1 * direction, from, corners) >= 0;
    };
    const bool areBehindBack = areBehind(frame.back(k), start);
    // A corner is nearest to what lies behind it along both its edges,
    if (sides[3 + k] != kNone && areBehindBack && areBehind(frame.edges[k], start)) return true;
    // and an edge to what lies beyond it, at either end not past that, or behind the other edge there.
    if (sides[k] != kNone && areBehind(frame.inward(k), start) &&
        (areBehindBack || leastAlong(frame.edges[k], start, corners) >= 0) &&
        (areBehind(frame.edges[next], end) || areBehind(frame.edges[k], end))) {
      return true;
    }
  }
  return false;
}

bool findBoundaryLoops(const Cage& cage, const HalfEdges& edges, Arena& arena, BoundaryLoops& out) noexcept {
  const std::uint32_t sideCount = 3 * cage.count;
  const std::uint32_t vertexCount = edges.vertexCount;
  const std::uint32_t* starts = edges.starts;
  auto* ofSides = arena.allocate<std::uint32_t>(std::size_t{2} * sideCount);
  auto* boxes = arena.allocate<BoundaryLoops::Box>(std::min(sideCount, vertexCount));
  const Arena::Mark mark = arena.mark();
  auto* open = arena.allocate<std::uint32_t>(sideCount);  // Sides that no other triangle has.
  auto* parents = arena.allocate<std::uint32_t>(vertexCount);
  auto* loopAt = arena.allocate<std::uint32_t>(vertexCount);
  if (arena.failed()) return false;

  const auto isOpen = [&edges](std::uint32_t side) { return edges.next[side] == side; };
  const auto endOf = [&edges](std::uint32_t side) { return edges.starts[HalfEdges::after(side)]; };
  std::uint32_t openCount = 0;
  for (std::uint32_t side = 0; side < sideCount; ++side) {
    open[openCount] = side;
    openCount += isOpen(side);
  }
  UnionFind sets(parents, vertexCount);
  for (std::uint32_t i = 0; i < openCount; ++i) sets.join(starts[open[i]], endOf(open[i]));
  std::fill(loopAt, loopAt + vertexCount, BoundaryLoops::kNone);
  out.count = 0;
  for (std::uint32_t i = 0; i < openCount; ++i) {
    const std::uint32_t side = open[i];
    std::uint32_t& loop = loopAt[sets.find(starts[side])];
    if (loop == BoundaryLoops::kNone) {
      boxes[out.count] = {};
      loop = out.count++;
    }
    loopAt[starts[side]] = loopAt[endOf(side)] = loop;
    const CageTriangle& t = cage.triangles[side / 3];
    const float* corners[3] = {t.a, t.b, t.c};
    boxes[loop].grow(Vec3::from(corners[side % 3]));
    boxes[loop].grow(Vec3::from(corners[(side % 3 + 1) % 3]));
  }
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t side = 3 * t + k;
      const std::uint32_t loop = loopAt[starts[side]];
      ofSides[6 * std::size_t{t} + k] = isOpen(side) ? loop : BoundaryLoops::kNone;
      ofSides[6 * std::size_t{t} + 3 + k] = loop;
    }
  }
  out.boxes = boxes;
  out.ofSides = ofSides;
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
