#include "fit/eye_holes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Lengths in diagonals of the cage.
constexpr double kHoleNear = 0.12;   ///< From the centre of an eye to the middle of its hole, at most.
constexpr double kEyeNear = 0.04;    ///< From the landmark to the middle of the component that is the eye, at most.
constexpr double kLargestEye = 0.3;  ///< The size of an eye, at most.
constexpr double kLift = 1e-4;       ///< Rays from a surface start this far off it.
/// The hole is larger than the contour: it is a polygon of few corners, and paint must not reach the eye. At 1.06 the
/// transfer painted 3 % of what it should not.
constexpr double kMargin = 1.3;
constexpr int kDirections = 48, kSteps = 48;
/// An eye of which fewer directions show anything is hidden.
constexpr std::size_t kLeastSeen = 32;

Vec3 unit(const Vec3& v) { return 1 / length(v) * v; }

/// What is visible of an eye, seen along its axis.
struct Opening {
  Vec3 middle{}, axis{}, across{}, up{};
  std::vector<Vec3> contour;  ///< In the plane through `middle`.
};

struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  [[nodiscard]] Vec3 middle() const { return 0.5 * (low + high); }
  [[nodiscard]] double size() const { return length(high - low); }
};

/// The triangles of the eye at a landmark: named parts on its side, else the connected component around it.
std::vector<bool> eyeAt(const EyedFigure& figure, const Vec3& centre, const Vec3& other, double diagonal) {
  const std::size_t count = figure.mesh.triangles.size();
  std::uint32_t componentCount = 0;
  for (const std::uint32_t c : figure.components) componentCount = std::max(componentCount, c + 1);
  std::vector<Box> boxes(componentCount);
  std::vector<bool> named(componentCount);
  bool anyNamed = false;
  for (std::size_t t = 0; t < count; ++t) {
    for (const std::uint32_t v : figure.mesh.triangles[t]) boxes[figure.components[t]].add(figure.mesh.positions[v]);
    if (figure.isEye[t]) named[figure.components[t]] = anyNamed = true;
  }
  std::vector<bool> isEye(componentCount);
  for (std::size_t c = 0; c < componentCount; ++c) {
    const double distance = length(boxes[c].middle() - centre);
    if (boxes[c].size() > kLargestEye * diagonal || distance > length(boxes[c].middle() - other)) continue;
    isEye[c] = anyNamed ? named[c] && distance < kLargestEye * diagonal : distance < kEyeNear * diagonal;
  }
  std::vector<bool> out(count);
  for (std::size_t t = 0; t < count; ++t) out[t] = isEye[figure.components[t]];
  return out;
}

/// The mean direction in which the uncovered part of an eye faces; zero if all of it is covered.
Vec3 axisOf(const TriangleMesh& mesh, const std::vector<bool>& isEye, const Surface& surface, double diagonal) {
  std::vector<SurfaceRay> rays;
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < isEye.size(); ++t) {
    if (!isEye[t]) continue;
    const Triangle3& corners = mesh.triangles[t];
    const Vec3 normal = areaNormal(mesh, corners);
    const Vec3 middle =
        1.0 / 3 * (mesh.positions[corners[0]] + mesh.positions[corners[1]] + mesh.positions[corners[2]]);
    rays.push_back({middle + kLift * diagonal * unit(normal), unit(normal)});
    normals.push_back(normal);
  }
  Vec3 sum{0, 0, 0};
  const std::vector<RayHit> hits = surface.trace(rays);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (std::isinf(hits[i].distance)) sum = sum + normals[i];
  return length(sum) > 0 ? unit(sum) : sum;
}

std::optional<Opening> openingOf(const EyedFigure& figure, const Surface& surface, const std::vector<bool>& isEye,
                                 double diagonal) {
  Opening opening;
  opening.axis = axisOf(figure.mesh, isEye, surface, diagonal);
  if (!(length(opening.axis) > 0)) return std::nullopt;
  Box box;
  for (std::size_t t = 0; t < isEye.size(); ++t)
    if (isEye[t])
      for (const std::uint32_t v : figure.mesh.triangles[t]) box.add(figure.mesh.positions[v]);
  const Vec3 helper = std::abs(opening.axis.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  opening.across = unit(cross(helper, opening.axis));
  opening.up = cross(opening.axis, opening.across);
  const double radius = 0.5 * box.size();
  const auto seenAt = [&](const std::vector<Vec3>& places) {
    std::vector<SurfaceRay> rays;
    rays.reserve(places.size());
    for (const Vec3& p : places) rays.push_back({p + 2 * radius * opening.axis, -1.0 * opening.axis});
    const std::vector<RayHit> hits = surface.trace(rays);
    std::vector<bool> seen;
    seen.reserve(hits.size());
    for (const RayHit& hit : hits) seen.push_back(!std::isinf(hit.distance) && isEye[hit.triangle]);
    return seen;
  };
  // The middle of what is visible, on a square grid.
  std::vector<Vec3> grid;
  for (int i = -kSteps / 2; i <= kSteps / 2; ++i)
    for (int k = -kSteps / 2; k <= kSteps / 2; ++k)
      grid.push_back(box.middle() + 2 * radius / kSteps * (i * opening.across + k * opening.up));
  std::vector<bool> seen = seenAt(grid);
  double count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (seen[i]) {
      opening.middle = opening.middle + grid[i];
      ++count;
    }
  if (count < static_cast<double>(kLeastSeen)) return std::nullopt;
  opening.middle = 1 / count * opening.middle;
  // The farthest visible spot in each direction; lashes of the same mesh may cover what is nearer.
  std::vector<Vec3> spokes;
  for (int d = 0; d < kDirections; ++d) {
    const double angle = 2 * std::numbers::pi * d / kDirections;
    for (int k = 0; k < kSteps; ++k)
      spokes.push_back(opening.middle +
                       2 * radius * k / kSteps * (std::cos(angle) * opening.across + std::sin(angle) * opening.up));
  }
  seen = seenAt(spokes);
  for (std::size_t d = 0; d < kDirections; ++d) {
    std::size_t last = 0;
    for (std::size_t k = 0; k < kSteps; ++k)
      if (seen[d * kSteps + k]) last = k;
    opening.contour.push_back(spokes[d * kSteps + last]);
  }
  return opening;
}

/// The hole of an eye: the loop around its landmark; -1 if there is none of its own.
int holeAt(const TemplateCage& cage, const Vec3& centre, const Vec3& other) {
  int best = -1;
  double least = kHoleNear * cage.diagonal;
  for (std::size_t i = 0; i < cage.loops.size(); ++i) {
    if (static_cast<int>(i) == cage.rim) continue;
    Vec3 middle{0, 0, 0};
    for (const std::uint32_t v : cage.loops[i])
      middle = middle + 1 / static_cast<double>(cage.loops[i].size()) * cage.mesh.positions[v];
    const double distance = length(middle - centre);
    if (distance >= least || distance >= length(middle - other)) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

/// Moves the border of a hole onto a contour, by angles about their middles, each in its own proportions.
void drawTo(const Opening& opening, const std::vector<std::uint32_t>& loop, const Surface& surface, double offset,
            std::vector<Vec3>& positions) {
  struct Flat {
    double x, y;
  };
  const auto flat = [&](const Vec3& p) {
    return Flat{dot(p - opening.middle, opening.across), dot(p - opening.middle, opening.up)};
  };
  const auto spread = [](const std::vector<Flat>& points, Flat& middle) {
    const double share = 1 / static_cast<double>(points.size());
    middle = {0, 0};
    Flat out{0, 0};
    for (const Flat& p : points) middle = {middle.x + share * p.x, middle.y + share * p.y};
    for (const Flat& p : points)
      out = {out.x + share * std::abs(p.x - middle.x), out.y + share * std::abs(p.y - middle.y)};
    return out;
  };
  std::vector<Flat> border, contour;
  for (const std::uint32_t v : loop) border.push_back(flat(positions[v]));
  for (const Vec3& p : opening.contour) contour.push_back(flat(p));
  Flat borderMiddle, contourMiddle;
  const Flat borderSpread = spread(border, borderMiddle), contourSpread = spread(contour, contourMiddle);
  if (!(borderSpread.x > 0 && borderSpread.y > 0 && contourSpread.x > 0 && contourSpread.y > 0)) return;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle =
        std::atan2((border[i].y - borderMiddle.y) / borderSpread.y, (border[i].x - borderMiddle.x) / borderSpread.x);
    Flat best = contourMiddle;
    double least = std::numeric_limits<double>::infinity();
    for (const Flat& p : contour) {
      const double there =
          std::atan2((p.y - contourMiddle.y) / contourSpread.y, (p.x - contourMiddle.x) / contourSpread.x);
      const double turn = std::abs(std::remainder(there - angle, 2 * std::numbers::pi));
      if (turn >= least) continue;
      least = turn;
      best = p;
    }
    const Vec3 at = opening.middle + (contourMiddle.x + kMargin * (best.x - contourMiddle.x)) * opening.across +
                    (contourMiddle.y + kMargin * (best.y - contourMiddle.y)) * opening.up;
    // As far in front of the skin as the cage is elsewhere.
    const SurfaceRay ray{at + 4 * (contourSpread.x + contourSpread.y) * opening.axis, -1.0 * opening.axis};
    const RayHit hit = surface.trace(std::span(&ray, 1))[0];
    const Vec3 height = std::isinf(hit.distance)
                            ? dot(positions[loop[i]] - at, opening.axis) * opening.axis
                            : ray.origin + hit.distance * ray.direction - at + offset * opening.axis;
    positions[loop[i]] = at + height;
  }
}

std::optional<Vec3> centreOf(const std::vector<Landmark>& landmarks, const std::string& side) {
  if (const Landmark* centre = findLandmark(landmarks, "eye_centre_" + side)) return positionOf(*centre);
  const Landmark* inner = findLandmark(landmarks, "eye_inner_" + side);
  const Landmark* outer = findLandmark(landmarks, "eye_outer_" + side);
  if (inner == nullptr || outer == nullptr) return std::nullopt;
  return 0.5 * (positionOf(*inner) + positionOf(*outer));
}

}  // namespace

std::vector<bool> fitEyeHoles(const TemplateCage& cage, const EyedFigure& figure, const std::vector<Landmark>& from,
                              const std::vector<Landmark>& to, std::vector<Vec3>& positions) {
  std::vector<bool> moved(positions.size());
  const std::optional<Vec3> own[2] = {centreOf(from, "left"), centreOf(from, "right")};
  const std::optional<Vec3> there[2] = {centreOf(to, "left"), centreOf(to, "right")};
  if (!own[0] || !own[1] || !there[0] || !there[1]) return moved;
  const Surface surface(figure.mesh);
  for (std::size_t side = 0; side < 2; ++side) {
    const int hole = holeAt(cage, *own[side], *own[1 - side]);
    if (hole < 0) continue;
    const std::vector<bool> isEye = eyeAt(figure, *there[side], *there[1 - side], cage.diagonal);
    if (std::find(isEye.begin(), isEye.end(), true) == isEye.end()) continue;
    const std::optional<Opening> opening = openingOf(figure, surface, isEye, cage.diagonal);
    if (!opening) continue;
    drawTo(*opening, cage.loops[static_cast<std::size_t>(hole)], surface, cage.offset, positions);
    for (const std::uint32_t v : cage.loops[static_cast<std::size_t>(hole)]) moved[v] = true;
  }
  return moved;
}

}  // namespace cagecast::cages
