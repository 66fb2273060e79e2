#include "fit/steps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "linear/dense.hpp"

namespace cagecast::cages {

namespace {

constexpr int kPerSide = 4;          ///< Anchors from front to back on each side of a rim.
constexpr double kRimStep = 0.005;   ///< Distance of samples along a rim, in diagonals.
constexpr double kSmoothing = 0.03;  ///< Ragged rims are smoothed over this share of their length.
/// How many samples a rim has, about, at most: smoothing them takes the square of it. Necks have 200 to 400. There
/// would be millions where landmarks that are close together make the target huge in the template's space.
constexpr std::size_t kMaxSamples = 2000;

/// A border of the target may be its neck if it is about as long as the template's, by these shares, and about where
/// that is: its centre is off by at most this share of the diagonal. Hems of jackets are longer and lower.
constexpr double kShortestNeck = 0.5, kLongestNeck = 2.2, kNeckOff = 0.15;

/// How far the map may stay off landmarks that are not sure (see `Anchor::slack`).
constexpr double kSlack = 0.1;

/// Where on the line from menton to the lobe of an ear the jaw is held, too.
constexpr double kJawShare = 0.35;

/// The loop where a figure ends.
struct Rim {
  std::vector<Vec3> points;
  Vec3 centre{};
  Vec3 normal{};  ///< Of its plane; the figure is on this side.
};

Vec3 perpendicular(const Vec3& v, const Vec3& to) { return v - dot(v, to) * to; }

/// Whether a direction is neither zero nor that of another one.
bool isAcross(const Vec3& v, const Vec3& other) { return length(cross(v, other)) > 0; }

/// Averages the points' heights over the plane along the rim.
void smoothHeights(Rim& rim) {
  std::vector<double> along(1, 0.0);
  for (std::size_t i = 0; i < rim.points.size(); ++i)
    along.push_back(along.back() + length(rim.points[(i + 1) % rim.points.size()] - rim.points[i]));
  std::vector<Vec3> smooth = rim.points;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    double height = 0, total = 0;
    for (std::size_t j = 0; j < smooth.size(); ++j) {
      const double apart = std::abs(along[i] - along[j]);
      const double share = std::min(apart, along.back() - apart) / (kSmoothing * along.back());
      const double weight = std::exp(-share * share);
      height += weight * dot(rim.points[j] - rim.points[i], rim.normal);
      total += weight;
    }
    smooth[i] = smooth[i] + height / total * rim.normal;
  }
  rim.points = std::move(smooth);
}

/// A loop as evenly spaced points, counter-clockwise around the normal of the plane that fits it best; ragged ends are
/// smoothed away.
/// @param inward  Towards the figure, about.
Rim sampleRim(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop, double step, const Vec3& inward) {
  Rim rim;
  std::vector<Vec3> corners;
  const std::size_t stride = 1 + loop.size() / kMaxSamples;
  for (std::size_t i = 0; i < loop.size(); i += stride) corners.push_back(mesh.positions[loop[i]]);
  double around = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) around += length(corners[(i + 1) % corners.size()] - corners[i]);
  step = std::max(step, around / static_cast<double>(kMaxSamples));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], edge = corners[(i + 1) % corners.size()] - a;
    const int pieces = 1 + static_cast<int>(length(edge) / step);
    for (int k = 0; k < pieces; ++k) rim.points.push_back(a + static_cast<double>(k) / pieces * edge);
  }
  const auto count = static_cast<double>(rim.points.size());
  for (const Vec3& p : rim.points) rim.centre = rim.centre + 1 / count * p;
  SquareMatrix<3> spread{};
  for (const Vec3& p : rim.points) {
    const Vec3 d = p - rim.centre;
    const double apart[] = {d.x, d.y, d.z};
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) spread[j][k] += apart[j] * apart[k];
  }
  const auto [x, y, z] = eigenpairsOf(spread)[0].vector;
  rim.normal = {x, y, z};
  if (dot(rim.normal, inward) < 0) rim.normal = -1.0 * rim.normal;
  double turn = 0;
  for (std::size_t i = 0; i < rim.points.size(); ++i)
    turn += dot(cross(rim.points[i] - rim.centre, rim.points[(i + 1) % rim.points.size()] - rim.centre), rim.normal);
  if (turn < 0) std::reverse(rim.points.begin(), rim.points.end());
  smoothHeights(rim);
  return rim;
}

/// Where the mirror plane crosses a rim.
struct Crossing {
  Vec3 place;
  std::size_t next;  ///< The first point of the rim after it.
};

/// Points at equal shares of the length of a path, its end left out.
void divide(const std::vector<Vec3>& path, std::vector<Vec3>& out) {
  std::vector<double> along(1, 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) along.push_back(along.back() + length(path[i] - path[i - 1]));
  std::size_t i = 1;
  for (int k = 0; k < kPerSide; ++k) {
    const double wanted = along.back() * k / kPerSide;
    while (i + 1 < path.size() && along[i] < wanted) ++i;
    const double piece = along[i] - along[i - 1];
    const double share = piece > 0 ? (wanted - along[i - 1]) / piece : 0;
    out.push_back(path[i - 1] + share * (path[i] - path[i - 1]));
  }
}

/// Points at equal shares of the length from front to back on both sides; empty if the mirror plane misses the rim.
std::vector<Vec3> stations(const Rim& rim, const Axes& axes) {
  const std::size_t count = rim.points.size();
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    const Vec3 a = rim.points[i], b = rim.points[next];
    const double before = dot(a - axes.middle, axes.left), after = dot(b - axes.middle, axes.left);
    if ((before <= 0) != (after <= 0)) crossings.push_back({a + before / (before - after) * (b - a), next});
  }
  std::vector<Vec3> out;
  if (crossings.empty()) return out;
  const auto [back, front] =
      std::minmax_element(crossings.begin(), crossings.end(),
                          [&](const Crossing& a, const Crossing& b) { return dot(a.place - b.place, axes.front) < 0; });
  const auto walk = [&](const Crossing& from, const Crossing& to) {
    std::vector<Vec3> path{from.place};
    for (std::size_t i = from.next; i != to.next; i = (i + 1) % count) path.push_back(rim.points[i]);
    path.push_back(to.place);
    divide(path, out);
  };
  walk(*front, *back);
  walk(*back, *front);
  return out;
}

/// The length of a closed line.
double lengthAround(const std::vector<Vec3>& points) {
  double around = 0;
  for (std::size_t k = 0; k < points.size(); ++k) around += length(points[(k + 1) % points.size()] - points[k]);
  return around;
}

/// The neck of a target: its nearest border about as long as a template's rim, not counting how ragged it is.
std::optional<Rim> neckOf(const TriangleMesh& target, const Rim& from, const Vec3& up, double diagonal) {
  const double step = kRimStep * diagonal, own = lengthAround(from.points);
  std::optional<Rim> best;
  double least = kNeckOff * diagonal;
  for (const std::vector<std::uint32_t>& loop : boundaryLoops(target)) {
    std::vector<Vec3> points;
    points.reserve(loop.size());
    for (const std::uint32_t v : loop) points.push_back(target.positions[v]);
    const double off = length(middleOf(target, loop) - from.centre);
    if (lengthAround(points) < kShortestNeck * own || off >= least) continue;
    Rim rim = sampleRim(target, loop, step, up);
    const double around = lengthAround(rim.points);
    if (around < kShortestNeck * own || around > kLongestNeck * own) continue;
    least = off;
    best = std::move(rim);
  }
  return best;
}

}  // namespace

std::vector<Anchor> landmarkAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                                    bool withJoints) {
  static const std::string kCentre = "eye_centre";
  std::vector<Anchor> anchors;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::string& name = from[i].name;
    if (isJoint(name) && !withJoints) continue;
    if (name.starts_with(kCentre)) {
      const std::string side = name.substr(kCentre.size());
      if (placeOf(to, "eye_inner" + side) && placeOf(to, "eye_outer" + side)) continue;
    }
    anchors.push_back({positionOf(from[i]), positionOf(to[i]), kSlack * (1 - static_cast<double>(to[i].confidence))});
  }
  return anchors;
}

std::vector<Anchor> rimAnchors(const TemplateCage& cage, const TriangleMesh& target, const Axes& axes) {
  std::vector<Anchor> anchors;
  if (!axes.known || cage.rim < 0) return anchors;
  const double step = kRimStep * cage.diagonal;
  const Rim from = sampleRim(cage.mesh, cage.loops[static_cast<std::size_t>(cage.rim)], step, axes.up);
  const std::optional<Rim> to = neckOf(target, from, axes.up, cage.diagonal);
  if (!to) return anchors;
  const std::vector<Vec3> a = stations(from, axes), b = stations(*to, axes);
  if (a.size() != b.size()) return anchors;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3 outward = perpendicular(b[i] - to->centre, to->normal);
    anchors.push_back({a[i], b[i] + cage.offset / std::max(length(outward), cage.offset) * outward});
  }
  return anchors;
}

std::vector<bool> belowRim(const TemplateCage& cage, const std::vector<Vec3>& positions, const TriangleMesh& target,
                           double slack) {
  std::vector<bool> out(target.triangles.size());
  if (cage.rim < 0) return out;
  const std::vector<std::uint32_t>& loop = cage.loops[static_cast<std::size_t>(cage.rim)];
  const TriangleMesh placed{positions, cage.mesh.triangles};
  const Rim rim = sampleRim(placed, loop, kRimStep * cage.diagonal, meanOf(positions) - middleOf(placed, loop));
  for (std::size_t t = 0; t < out.size(); ++t)
    out[t] = std::all_of(target.triangles[t].begin(), target.triangles[t].end(), [&](std::uint32_t v) {
      return dot(target.positions[v] - rim.centre, rim.normal) < -slack * cage.diagonal;
    });
  return out;
}

std::vector<Anchor> jawAnchors(const std::vector<Landmark>& own, const std::vector<Landmark>& to) {
  std::vector<Anchor> anchors;
  const auto chin = placeOf(own, "chin"), toChin = placeOf(to, "chin"), below = placeOf(own, "menton");
  if (!chin || !toChin || !below || placeOf(to, "menton")) return anchors;
  const Vec3 move = *toChin - *chin;
  anchors.push_back({*below, *below + move});
  for (const char* side : {"ear_lobe_left", "ear_lobe_right"}) {
    const auto lobe = placeOf(own, side), toLobe = placeOf(to, side);
    if (!lobe || !toLobe) continue;
    const Vec3 edge = *below + kJawShare * (*lobe - *below);
    anchors.push_back({edge, edge + (1 - kJawShare) * move + kJawShare * (*toLobe - *lobe)});
  }
  return anchors;
}

std::vector<Anchor> eyeAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to, const Axes& axes) {
  std::vector<Anchor> anchors;
  for (const std::string side : {"left", "right"}) {
    const auto inner = placeOf(from, "eye_inner_" + side), outer = placeOf(from, "eye_outer_" + side);
    const auto toInner = placeOf(to, "eye_inner_" + side), toOuter = placeOf(to, "eye_outer_" + side);
    if (!inner || !outer || !toInner || !toOuter || !axes.known) continue;
    if (!isAcross(*outer - *inner, axes.up) || !isAcross(*toOuter - *toInner, axes.up)) continue;
    const auto spot = [&](const Vec3& a, const Vec3& b, double sign) {
      const Vec3 along = b - a, up = axes.up - dot(axes.up, along) / dot(along, along) * along;
      return 0.5 * (a + b) + sign * 0.5 * length(along) / length(up) * up;
    };
    for (const double sign : {-1.0, 1.0})
      anchors.push_back({spot(*inner, *outer, sign), spot(*toInner, *toOuter, sign)});
  }
  return anchors;
}

}  // namespace cagecast::cages
