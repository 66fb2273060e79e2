#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/opening.hpp"

namespace cagecast::cages {

namespace {

/// What is next to a hole makes room for it up to this distance, in the largest move of its border.
constexpr double kRoom = 1.6;

Flat stretched(const Flat& p, double by) { return {p.x, by * p.y}; }

/// The mean of points, and their mean distances from it along x and y.
Flat spreadOf(const std::vector<Flat>& points, Flat& middle) {
  const double share = 1 / static_cast<double>(points.size());
  middle = {};
  for (const Flat& p : points) middle = {middle.x + share * p.x, middle.y + share * p.y};
  Flat out;
  for (const Flat& p : points)
    out = {out.x + share * std::abs(p.x - middle.x), out.y + share * std::abs(p.y - middle.y)};
  return out;
}

/// What a hole has to show, and the triangles around it.
HoleContent contentOf(const TemplateCage& cage, const std::vector<std::uint32_t>& loop, const FaceOpening& opening,
                      const std::vector<Vec3>& positions) {
  HoleContent content{opening.contour, opening.covers, {}};
  for (const Triangle3& t : cage.mesh.triangles) {
    HoleContent::Neighbour neighbour;
    bool touches = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = std::find(loop.begin(), loop.end(), t[k]);
      neighbour.places[k] = stretched(opening.flat(positions[t[k]]), opening.stretch);
      neighbour.corners[k] = corner == loop.end() ? -1 : static_cast<int>(corner - loop.begin());
      touches = touches || corner != loop.end();
    }
    if (touches) content.neighbours.push_back(neighbour);
  }
  return content;
}

/// A place in front of a surface.
/// @param from  Where its vertex was, for places where there is no surface.
Vec3 inFrontOf(const Surface& surface, const FaceOpening& opening, const Flat& p, const Vec3& from, double offset) {
  const Vec3 at = opening.place(p);
  const double far = 8 * *std::max_element(opening.contour.begin(), opening.contour.end());
  const SurfaceRay ray{at + far * opening.axis, -1.0 * opening.axis};
  const RayHit hit = surface.trace(std::span(&ray, 1))[0];
  if (std::isinf(hit.distance)) return at + dot(from - at, opening.axis) * opening.axis;
  return at + (far - hit.distance + offset) * opening.axis;
}

/// Where the corners of a hole are and should be.
struct BorderMove {
  const std::vector<std::uint32_t>& loop;
  const std::vector<Flat>&from, &to;
  Flat middle;  ///< Of the hole before.

  /// What needs room: nothing where the hole shrinks, as at lips that are closed.
  [[nodiscard]] Flat at(std::size_t i) const {
    const Flat move{to[i].x - from[i].x, to[i].y - from[i].y};
    return move.x * (from[i].x - middle.x) + move.y * (from[i].y - middle.y) > 0 ? move : Flat{};
  }
};

/// Moves what is next to a hole out of the way of its border: as far as the border moves, less and less up to a
/// distance of `kRoom` moves, so that nothing folds over.
void makeRoom(const TemplateCage& cage, const BorderMove& border, const FaceOpening& opening, const Surface& surface,
              std::vector<Vec3>& positions) {
  double most = 0;
  for (std::size_t i = 0; i < border.loop.size(); ++i)
    most = std::max(most, std::hypot(border.at(i).x, border.at(i).y));
  if (!(most > 0)) return;
  std::vector<bool> done(positions.size());
  for (const std::uint32_t v : border.loop) done[v] = true;
  std::vector<std::uint32_t> next = border.loop;
  // Along edges, so that the back of a head stays where it is.
  while (!next.empty()) {
    const std::uint32_t from = next.back();
    next.pop_back();
    for (const std::uint32_t v : cage.neighbours[from]) {
      if (done[v]) continue;
      done[v] = true;
      const Flat p = opening.flat(positions[v]);
      double total = 0, nearest = kRoom;
      Flat move;
      for (std::size_t i = 0; i < border.loop.size(); ++i) {
        const double distance = std::hypot(p.x - border.from[i].x, p.y - border.from[i].y) / most;
        const double weight = 1 / std::max(1e-12, distance * distance * distance * distance);
        nearest = std::min(nearest, distance);
        total += weight;
        move = {move.x + weight * border.at(i).x, move.y + weight * border.at(i).y};
      }
      const double share = 1 - nearest / kRoom;
      if (!(share > 0)) continue;
      next.push_back(v);
      const Flat there{p.x + share / total * move.x, p.y + share / total * move.y};
      const Vec3 below = inFrontOf(surface, opening, p, positions[v], 0);
      const double before = dot(positions[v] - below, opening.axis);
      const double rise = dot(inFrontOf(surface, opening, there, positions[v], 0) - below, opening.axis);
      // It follows skin that falls, and rises, as from an eye onto a lid, no more than it must.
      const double offset = rise < 0 ? before : std::max(before - rise, cage.offset);
      positions[v] = inFrontOf(surface, opening, there, positions[v], offset);
    }
  }
}

}  // namespace

double FaceOpening::seamAt(double x) const {
  if (seam.empty()) return 0;
  const double at = std::clamp((x - seamFrom) / seamStep, 0.0, static_cast<double>(seam.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), seam.size() - 2);
  return seam[i] + (at - static_cast<double>(i)) * (seam[i + 1] - seam[i]);
}

Flat FaceOpening::flat(const Vec3& p) const {
  const double x = dot(p - middle, across);
  return {x, dot(p - middle, up) - seamAt(x)};
}

Vec3 FaceOpening::place(const Flat& p) const { return middle + p.x * across + (p.y + seamAt(p.x)) * up; }

void drawHole(const TemplateCage& cage, std::vector<std::uint32_t> loop, const FaceOpening& opening,
              const HoleGround& ground, std::vector<Vec3>& positions) {
  double around = 0;
  std::vector<Flat> border;
  border.reserve(loop.size());
  for (const std::uint32_t v : loop) border.push_back(opening.flat(positions[v]));
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Flat &a = border[i], &b = border[(i + 1) % loop.size()];
    around += a.x * b.y - a.y * b.x;
  }
  if (around < 0) {
    std::reverse(loop.begin(), loop.end());
    std::reverse(border.begin(), border.end());
  }
  std::vector<Flat> contour;
  for (std::size_t d = 0; d < opening.contour.size(); ++d) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(d) / static_cast<double>(opening.contour.size());
    contour.push_back({opening.contour[d] * std::cos(angle), opening.contour[d] * std::sin(angle)});
  }
  // The angles of the corners about the middle of the hole, in its own proportions.
  Flat borderMiddle, contourMiddle;
  const Flat borderSpread = spreadOf(border, borderMiddle), contourSpread = spreadOf(contour, contourMiddle);
  if (!(borderSpread.x > 0 && borderSpread.y > 0 && contourSpread.x > 0 && contourSpread.y > 0)) return;
  const std::vector<Flat> before = border;
  for (Flat& p : border)
    p = {(p.x - borderMiddle.x) / borderSpread.x * contourSpread.x,
         (p.y - borderMiddle.y) / borderSpread.y * contourSpread.y};
  const auto outline = [&](const HoleContent& content) {
    std::vector<Flat> corners = fitOutline(border, content);
    for (Flat& p : corners) p = stretched(p, 1 / opening.stretch);
    return corners;
  };
  makeRoom(cage, {loop, before, outline({opening.contour, {}, {}}), borderMiddle}, opening, ground.surface, positions);
  const std::vector<Flat> corners = outline(contentOf(cage, loop, opening, positions));
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Flat at{corners[i].x, opening.isClosed ? 0 : corners[i].y};
    const Vec3 ahead = inFrontOf(ground.surface, opening, at, positions[loop[i]], ground.offset);
    positions[loop[i]] = ahead + (corners[i].y - at.y) * opening.up;
  }
}

}  // namespace cagecast::cages
