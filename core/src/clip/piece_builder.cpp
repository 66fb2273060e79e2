#include "clip/piece_builder.hpp"

namespace cagecast {

void PieceBuilder::addCorner(const TrianglePoint& point) noexcept {
  const std::size_t n = polygon_.size();
  if (n > 0 && (polygon_[n - 1].vertex == point.vertex || polygon_[0].vertex == point.vertex)) return;
  polygon_.add(point);
}

/// Clips ears, the one with the shortest cut first.
void PieceBuilder::finishPolygon(std::uint32_t region) noexcept {
  while (polygon_.size() >= 3) {
    const std::size_t n = polygon_.size(), ear = findEar();
    add({polygon_[(ear + n - 1) % n], polygon_[ear], polygon_[(ear + 1) % n]}, region);
    polygon_.remove(ear);
  }
}

/// Finds the ear to clip next; any corner if the polygon has no area.
std::size_t PieceBuilder::findEar() const noexcept {
  const std::size_t n = polygon_.size();
  std::size_t ear = n;
  double shortest = 0;
  for (std::size_t i = 0; i < n && n > 3; ++i) {
    const double cut = length(polygon_[(i + 1) % n].p - polygon_[(i + n - 1) % n].p);
    if ((ear < n && cut >= shortest) || !isEar(i)) continue;
    ear = i;
    shortest = cut;
  }
  return ear < n ? ear : 1;
}

/// Whether a corner is convex, and no other corner lies in the triangle that it makes with its neighbours. Decided by
/// the weights of the target triangle's corners, in which the polygon is flat.
bool PieceBuilder::isEar(std::size_t i) const noexcept {
  const std::size_t n = polygon_.size();
  const TrianglePoint& a = polygon_[(i + n - 1) % n];
  const TrianglePoint& b = polygon_[i];
  const TrianglePoint& c = polygon_[(i + 1) % n];
  if (!(signedArea(a, b, c) > 0)) return false;
  for (std::size_t j = 0; j < n; ++j) {
    const TrianglePoint& p = polygon_[j];
    if (p.vertex == a.vertex || p.vertex == b.vertex || p.vertex == c.vertex) continue;
    if (!(signedArea(a, b, p) < 0 || signedArea(b, c, p) < 0 || signedArea(c, a, p) < 0)) return false;
  }
  return true;
}

void PieceBuilder::add(const TrianglePoint (&corners)[3], std::uint32_t region) noexcept {
  for (const TrianglePoint& corner : corners) triangle_.out.indices.add(corner.vertex);
  triangle_.out.origins.add(triangle_.number());
  triangle_.out.regions.add(region);
  pieces_.add({{corners[0], corners[1], corners[2]}, region});
}

}  // namespace cagecast
