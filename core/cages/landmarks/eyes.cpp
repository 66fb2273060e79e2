#include "landmarks/eyes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "landmarks/landmark_list.hpp"
#include "linear/dense.hpp"
#include "mesh/bounds.hpp"
#include "mesh/samples.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// A shape is an eyeball, or the front of one, if it fits a sphere this well; else the middle of its box serves.
constexpr double kBall = 0.12;
/// The sizes of two eyes differ by at most this share.
constexpr double kAlike = 0.15;

/// The ball of an eye: a sphere if it is one (a front half's box has its middle too far to the front), else about the
/// middle of the box if it is flat or bulges. The residual is a sphere's in any case.
Sphere ballOf(const TriangleMesh& shape) {
  const Bounds bounds = boundsOf(shape);
  const Vec3 size = bounds.size();
  const double radius = 0.5 * std::max(size.y, std::min(size.x, size.z));
  const Sphere sphere = fitSphere(shape.positions);
  const bool round = sphere.residual < kBall && sphere.radius < 1.3 * radius && sphere.radius > 0.8 * radius;
  return round ? sphere : Sphere{bounds.middle(), radius, sphere.residual};
}

/// The heading that horizontal positions spread along most.
Vec3 mainHeading(const std::vector<Vec3>& points) {
  const Vec3 mean = meanOf(points);
  SquareMatrix<2> spread{};
  for (const Vec3& p : points) {
    const Vec3 d = p - mean;
    spread[0][0] += d.x * d.x;
    spread[0][1] += d.x * d.z;
    spread[1][1] += d.z * d.z;
  }
  spread[1][0] = spread[0][1];
  const auto [x, z] = eigenpairsOf(spread)[1].vector;
  return {x, 0, z};
}

constexpr Vec3 kUp{0, 1, 0};

/// Which of the two horizontal directions across `left` is away from the head: the head is behind the eyes.
Vec3 frontOf(const TriangleMesh& mesh, const Vec3& left, const Vec3& eyes, double distance) {
  const Vec3 across = cross(left, kUp);
  Vec3 sum{0, 0, 0};
  double area = 0;
  for (const Triangle3& t : mesh.triangles) {
    const Vec3 middle = centroid(mesh, t);
    if (length(middle - eyes) > 3 * distance) continue;
    const double weight = length(areaNormal(mesh, t));
    sum = sum + weight * (middle - eyes);
    area += weight;
  }
  if (area == 0) return across;
  return dot(sum, across) > 0 ? -1 * across : across;
}

/// Completes what is known of two eyes: which is the left one, and where the front is.
void orient(const Figure& figure, Eyes& eyes) {
  Vec3 apart = eyes.centres[0] - eyes.centres[1];
  apart.y = 0;
  const double distance = length(apart);
  eyes.left = 1 / distance * apart;
  eyes.front = frontOf(figure.mesh, eyes.left, eyes.middle(), distance);
  if (figure.front && dot(eyes.front, *figure.front) < 0) eyes.front = -1 * eyes.front;
  // Right-handed: left x up = front.
  if (dot(cross(eyes.left, kUp), eyes.front) < 0) {
    std::swap(eyes.centres[0], eyes.centres[1]);
    eyes.left = -1 * eyes.left;
  }
}

/// Shares of a component's triangles that are seen from `direction` and from its opposite.
std::array<double, 2> seen(const Surface& surface, const TriangleMesh& part, const Vec3& direction, double diagonal) {
  const double clear = 1e-4 * diagonal;
  std::array<double, 2> out{};
  for (int side = 0; side < 2; ++side) {
    const Vec3 toward = side == 0 ? direction : -1 * direction;
    std::vector<SurfaceRay> rays;
    for (const Vec3& p : spreadPoints(part, 60)) rays.push_back({p + clear * toward, toward});
    double free = 0;
    for (const double distance : surface.distances(rays)) free += std::isinf(distance) ? 1 : 0;
    out[static_cast<std::size_t>(side)] = free / static_cast<double>(rays.size());
  }
  return out;
}

/// The balls of eyes. Pieces whose boxes meet are one: an iris lies in its eyeball.
/// @param piece  Per triangle, as of `connectedPieces`.
std::vector<Sphere> ballsOf(const TriangleMesh& eyes, const std::vector<std::uint32_t>& piece, std::uint32_t count) {
  constexpr std::uint32_t kMaxPieces = 200;  // Each is compared with each.
  if (count > kMaxPieces) return {};
  std::vector<Bounds> balls;
  for (const TriangleMesh& one : split(eyes, piece, count)) {
    Bounds box = boundsOf(one);
    const auto meeting = [&] {
      return std::find_if(balls.begin(), balls.end(), [&](const Bounds& ball) { return ball.distance(box) == 0; });
    };
    for (auto ball = meeting(); ball != balls.end(); ball = meeting()) {
      box.add(ball->low);
      box.add(ball->high);
      balls.erase(ball);  // What is larger now may meet others.
    }
    balls.push_back(box);
  }
  std::vector<Sphere> out(balls.size());
  std::transform(balls.begin(), balls.end(), out.begin(), [](const Bounds& box) {
    return Sphere{box.middle(), 0.5 * box.size().y, 0};
  });
  return out;
}

/// A component that may be an eye.
struct Candidate {
  TriangleMesh mesh;
  Bounds bounds;
  std::uint32_t component = 0;
  Sphere ball;
  std::optional<std::array<double, 2>> seen = {};  ///< What `seen` gives, once it is needed.
};

/// The candidate that is nearest to another one and as large and as round as an eye beside an eye.
std::optional<std::size_t> nearestLike(const std::vector<Candidate>& candidates, std::size_t of) {
  const Sphere& ball = candidates[of].ball;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Sphere& other = candidates[c].ball;
    const double distance = length(other.centre - ball.centre);
    const bool isLike = std::abs(other.radius - ball.radius) < kAlike * ball.radius && other.residual <= 2 * kBall;
    if (c == of || !isLike || !(distance > ball.radius) || distance >= least) continue;
    nearest = c;
    least = distance;
  }
  return nearest;
}

/// The components that are about as large and as round as an eye.
std::vector<Candidate> eyeCandidates(const Figure& figure, double diagonal) {
  constexpr std::size_t kMinTriangles = 8;
  constexpr double kSmallest = 0.002, kLargest = 0.15;  // Radii, as shares of the diagonal: of a figure, of a head.
  constexpr std::size_t kMaxCandidates = 500;           // The largest: a coat of mail has thousands of rings.
  std::vector<std::uint32_t> components = figure.components;
  for (std::size_t t = 0; t < components.size(); ++t)
    if (figure.roles[t] != Role::surface) components[t] = kNone;
  std::vector<TriangleMesh> parts = split(figure.mesh, components, figure.componentCount);
  std::vector<Candidate> candidates;
  for (std::uint32_t c = 0; c < figure.componentCount; ++c) {
    const std::size_t size = parts[c].triangles.size();
    if (size < kMinTriangles || 2 * size > figure.components.size()) continue;
    const Bounds bounds = boundsOf(parts[c]);
    const Vec3 box = bounds.size();
    const double wide = std::hypot(box.x, box.z);
    const bool round = box.y > 0.5 * wide && box.y < 2 * wide;
    if (!round || box.y < 2 * kSmallest * diagonal || box.y > 2 * kLargest * diagonal) continue;
    const Sphere ball = ballOf(parts[c]);
    candidates.push_back({std::move(parts[c]), bounds, c, ball});
  }
  if (candidates.size() > kMaxCandidates) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return areaOf(a.mesh) > areaOf(b.mesh); });
    candidates.resize(kMaxCandidates);
  }
  return candidates;
}

}  // namespace

Sphere fitSphere(const std::vector<Vec3>& points) {
  Sphere out;
  out.residual = std::numeric_limits<double>::infinity();
  if (points.size() < 6) return out;
  const Vec3 mean = meanOf(points);
  std::vector<double> matrix(16), right(4);
  for (const Vec3& p : points) {
    const Vec3 d = p - mean;
    const double row[] = {2 * d.x, 2 * d.y, 2 * d.z, 1};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < 4; ++k) matrix[4 * i + k] += row[i] * row[k];
      right[i] += dot(d, d) * row[i];
    }
  }
  const std::vector<double> solution = solveDense(std::move(matrix), std::move(right), 4);
  const Vec3 centre{solution[0], solution[1], solution[2]};
  const double squared = solution[3] + dot(centre, centre);
  if (!(squared > 0)) return out;
  out.centre = mean + centre;
  out.radius = std::sqrt(squared);
  double sum = 0;
  for (const Vec3& p : points) sum += std::abs(length(p - out.centre) - out.radius);
  out.residual = sum / static_cast<double>(points.size()) / out.radius;
  return out;
}

std::optional<Eyes> findNamedEyes(const Figure& figure) {
  if (!figure.has(Role::eye)) return std::nullopt;
  const TriangleMesh all = figure.only(Role::eye);
  const Vec3 heading = mainHeading(all.positions);
  const auto [low, high] = rangeOf(all.positions, heading);
  // Whole components go to one side: a bulging iris may be a component of its own.
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> component = connectedPieces(all, count);
  Eyes eyes;
  eyes.areOfSeveralHeads = haveSeveralHeads(ballsOf(all, component, count));
  if (eyes.areOfSeveralHeads) return eyes;
  std::vector<double> sums(count), areas(count);
  for (std::size_t t = 0; t < component.size(); ++t) {
    const double area = length(areaNormal(all, all.triangles[t]));
    for (const std::uint32_t v : all.triangles[t])
      sums[component[t]] += area / 3 * (dot(heading, all.positions[v]) - 0.5 * (low + high));
    areas[component[t]] += area;
  }
  std::vector<bool> isFirst(component.size()), isSecond(component.size());
  for (std::size_t t = 0; t < component.size(); ++t) {
    isFirst[t] = sums[component[t]] >= 0;
    isSecond[t] = !isFirst[t];
  }
  const TriangleMesh first = subset(all, isFirst), second = subset(all, isSecond);
  if (first.empty() || second.empty()) return std::nullopt;
  const Sphere one = ballOf(first), other = ballOf(second);
  eyes.centres = {one.centre, other.centre};
  eyes.radius = std::min(one.radius, other.radius);
  const Vec3 apart = eyes.centres[0] - eyes.centres[1];
  // Side by side, alike, and apart: else the parts have these names for another reason.
  if (!(length(apart) > 1.2 * eyes.radius) || std::abs(apart.y) > 0.5 * length(apart)) return std::nullopt;
  const bool alike = std::max(one.radius, other.radius) < 1.3 * eyes.radius;
  eyes.confidence = alike ? 0.95 : 0.6;
  eyes.isNamed = true;
  eyes.triangles.resize(figure.roles.size());
  for (std::size_t t = 0; t < figure.roles.size(); ++t) eyes.triangles[t] = figure.roles[t] == Role::eye;
  orient(figure, eyes);
  return eyes;
}

std::optional<Eyes> findHintedEyes(const Figure& figure, const std::vector<Landmark>& hints) {
  constexpr double kRadius = 0.55;  ///< Of an eyeball, as a share of the distance of the corners of its lids.
  std::array<Vec3, 4> corners{};
  std::size_t count = 0;
  for (const char* name : {"eye_inner_left", "eye_outer_left", "eye_inner_right", "eye_outer_right"})
    if (const auto place = placeOf(hints, name)) corners[count++] = *place;
  const auto [inner, outer, otherInner, otherOuter] = corners;
  Eyes eyes;
  eyes.centres = {0.5 * (inner + outer), 0.5 * (otherInner + otherOuter)};
  eyes.radius = 0.5 * kRadius * (length(outer - inner) + length(otherOuter - otherInner));
  const Vec3 apart = eyes.centres[0] - eyes.centres[1];
  // False, too, if it is not finite.
  const bool areApart = eyes.radius > 0 && length(apart) > 1.2 * eyes.radius && length(apart) < diagonalOf(figure.mesh);
  if (count < corners.size() || !areApart || std::abs(apart.y) > 0.5 * length(apart)) return std::nullopt;
  eyes.confidence = 0.9;
  eyes.isNamed = true;
  orient(figure, eyes);
  // Lids are in front of the eyeballs.
  for (Vec3& centre : eyes.centres) centre = centre - eyes.radius * eyes.front;
  return eyes;
}

std::optional<Eyes> findJointedEyes(const Figure& figure, const std::vector<Landmark>& joints) {
  constexpr double kRadius = 0.2;    ///< Of an eyeball, as a share of the distance of the eyes.
  constexpr double kNearest = 0.02;  ///< Eyes are farther apart than this share of the diagonal of a head.
  const auto left = placeOf(joints, "joint_eye_left"), right = placeOf(joints, "joint_eye_right");
  if (!left || !right) return std::nullopt;
  Eyes eyes;
  eyes.centres = {*left, *right};
  const Vec3 apart = *left - *right;
  eyes.radius = kRadius * length(apart);
  const double diagonal = diagonalOf(figure.mesh);
  if (!(length(apart) > kNearest * diagonal) || length(apart) > diagonal || std::abs(apart.y) > 0.2 * length(apart))
    return std::nullopt;
  eyes.confidence = 0.8;
  eyes.isNamed = true;
  orient(figure, eyes);
  // Joints may be anywhere behind the eyes that they turn.
  const Surface surface(figure.mesh);
  for (Vec3& centre : eyes.centres) {
    const SurfaceRay ray{centre + diagonal * eyes.front, -1 * eyes.front};
    const double skin = diagonal - surface.distance(ray);
    if (std::isfinite(skin)) centre = centre + (skin - eyes.radius) * eyes.front;
  }
  return eyes;
}

std::optional<Eyes> findLooseEyes(const Figure& figure, const MirrorPlane& plane) {
  const double diagonal = diagonalOf(figure.mesh);
  std::vector<Candidate> candidates = eyeCandidates(figure, diagonal);
  const Vec3 across = cross(plane.left, kUp);
  std::optional<Surface> surface;  // Built when it is needed.
  const auto seenOf = [&](Candidate& candidate) {
    if (!surface) surface.emplace(figure.mesh);
    if (!candidate.seen) candidate.seen = seen(*surface, candidate.mesh, across, diagonal);
    return *candidate.seen;
  };
  std::optional<Eyes> best;
  std::array<std::size_t, 2> chosen{};
  double most = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t k = i + 1; k < candidates.size(); ++k) {
      const Bounds &a = candidates[i].bounds, &b = candidates[k].bounds;
      const double size = a.size().y;
      const double off = length(plane.mirrored(a.middle()) - b.middle());
      if (off > 0.3 * size || std::abs(b.size().y - size) > kAlike * size) continue;
      if (std::abs(dot(plane.left, a.middle()) - plane.offset) < 0.5 * size) continue;
      const Sphere &first = candidates[i].ball, &second = candidates[k].ball;
      const double residual = std::max(first.residual, second.residual);
      if (residual > 2 * kBall) continue;
      const std::array<double, 2> one = seenOf(candidates[i]), other = seenOf(candidates[k]);
      const double front = std::min(std::max(one[0], one[1]), std::max(other[0], other[1]));
      const double back = std::max(std::min(one[0], one[1]), std::min(other[0], other[1]));
      if (front < 0.03 || back > 0.5 * front) continue;
      const double score = areaOf(candidates[i].mesh) * (1 - residual / (2 * kBall)) * std::min(front, 0.3);
      if (score <= most) continue;
      most = score;
      best.emplace();
      best->centres = {first.centre, second.centre};
      best->radius = 0.5 * (first.radius + second.radius);
      best->confidence = residual < kBall ? 0.85 : 0.6;
      chosen = {i, k};
    }
  if (!best) return best;
  // Of two heads beside each other, the eyes of one mirror those of the other.
  std::vector<Sphere> balls = {candidates[chosen[0]].ball, candidates[chosen[1]].ball};
  for (const std::size_t c : chosen) {
    const std::optional<std::size_t> other = nearestLike(candidates, c);
    if (other && *other != chosen[0] && *other != chosen[1]) balls.push_back(candidates[*other].ball);
  }
  best->areOfSeveralHeads = haveSeveralHeads(balls);
  if (best->areOfSeveralHeads) return best;
  // What lies within the eyeballs belongs to them: pupils, corneas.
  const Eyes eyes = *best;
  std::vector<bool> inside(figure.componentCount, true);
  for (std::size_t t = 0; t < figure.components.size(); ++t)
    for (const std::uint32_t v : figure.mesh.triangles[t]) {
      const Vec3& p = figure.mesh.positions[v];
      const double distance = std::min(length(p - eyes.centres[0]), length(p - eyes.centres[1]));
      if (distance > 1.15 * eyes.radius) inside[figure.components[t]] = false;
    }
  for (const std::size_t c : chosen) inside[candidates[c].component] = true;
  for (const std::uint32_t component : figure.components) best->triangles.push_back(inside[component]);
  orient(figure, *best);
  return best;
}

}  // namespace cagecast::cages
