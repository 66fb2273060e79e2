#include "fit/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fit/hole_outline.hpp"
#include "mesh/bounds.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Lengths in distances of the two eyes.
constexpr double kEyeNear = 0.3;       ///< From the landmark to the middle of the component that is the eye, at most.
constexpr double kLargestEye = 2;      ///< The size of an eye, at most.
constexpr double kMaxOff = 0.3;        ///< From where landmarks have a hole to what is seen of the eye, at most.
constexpr double kMaxOffGiven = 0.07;  ///< The same where a person gave a landmark of it.
/// Rays from a surface start this far off it, in diagonals of the cage.
constexpr double kLift = 1e-4;
/// Rays to an eye: directions from its middle, places along each of them, and places along the sides of a grid.
constexpr int kDirections = 144, kSteps = 144, kGrid = 48;
/// A component may be the lashes of an eye if all of it is this near to the eye's middle, across and in depth. In
/// largest radii of what is visible of the eye.
constexpr double kCoverReach = 1.6, kCoverDepth = 4;
/// The centre of an eye is in the box of the eyeball, enlarged by this share of its size.
constexpr double kBoxSlack = 0.2;
/// What is this near to the middle of an eyeball, in its radii, belongs to the eye: pupils and corneas, not lashes.
constexpr double kBallSlack = 1.15;
/// What is next to a hole makes room for it up to this distance, in the largest move of its border.
constexpr double kRoom = 1.6;
/// An eye that is seen at fewer places of the grid is hidden.
constexpr std::size_t kMinSeen = 32;

/// What is visible of an eye, seen along its axis.
struct EyeOpening {
  Vec3 middle{}, axis{}, across{}, up{};
  std::vector<double> contour;  ///< Distances from `middle`, from `across` to `up`.
  std::vector<HoleContent::Cover> covers;

  [[nodiscard]] Flat flat(const Vec3& p) const { return {dot(p - middle, across), dot(p - middle, up)}; }
  [[nodiscard]] Vec3 place(const Flat& p) const { return middle + p.x * across + p.y * up; }
};

double thickness(const Bounds& box) { return std::min({box.size().x, box.size().y, box.size().z}); }

/// The component that is the eyeball around a landmark, if no name says so: the thickest one. -1 if there is none.
int eyeballAt(const std::vector<Bounds>& boxes, const std::vector<bool>& isNear, const Vec3& centre) {
  int best = -1;
  for (std::size_t c = 0; c < boxes.size(); ++c) {
    const Vec3 off = centre - boxes[c].middle(), most = (0.5 + kBoxSlack) * boxes[c].size();
    if (!isNear[c] || std::abs(off.x) > most.x || std::abs(off.y) > most.y || std::abs(off.z) > most.z) continue;
    if (best < 0 || thickness(boxes[c]) > thickness(boxes[static_cast<std::size_t>(best)])) best = static_cast<int>(c);
  }
  return best;
}

/// The triangles of the eye at a landmark: named parts on its side, else the eyeball around it, and what is inside.
std::vector<bool> eyeAt(const EyedFigure& figure, const Vec3& centre, const Vec3& other) {
  const double apart = length(centre - other);
  const std::size_t count = figure.mesh.triangles.size();
  std::vector<Bounds> boxes(figure.componentCount);
  for (std::size_t t = 0; t < count; ++t)
    for (const std::uint32_t v : figure.mesh.triangles[t]) boxes[figure.components[t]].add(figure.mesh.positions[v]);
  std::vector<bool> named(boxes.size()), isNear(boxes.size()), isEye(boxes.size());
  for (std::size_t t = 0; t < count; ++t)
    if (figure.isEye[t]) named[figure.components[t]] = true;
  for (std::size_t c = 0; c < boxes.size(); ++c) {
    if (boxes[c].empty()) continue;
    const double distance = length(boxes[c].middle() - centre);
    if (boxes[c].diagonal() > kLargestEye * apart || distance > length(boxes[c].middle() - other)) continue;
    isEye[c] = named[c] && distance < kLargestEye * apart;
    isNear[c] = distance < kEyeNear * apart;
  }
  const bool isNamed = std::find(isEye.begin(), isEye.end(), true) != isEye.end();
  const int ball = isNamed ? -1 : eyeballAt(boxes, isNear, centre);
  if (ball >= 0) {
    isEye = isNear;
    const Bounds& box = boxes[static_cast<std::size_t>(ball)];
    const double reach = kBallSlack * 0.5 * std::max({box.size().x, box.size().y, box.size().z});
    for (std::size_t t = 0; t < count; ++t)
      for (const std::uint32_t v : figure.mesh.triangles[t])
        if (length(figure.mesh.positions[v] - box.middle()) > reach) isEye[figure.components[t]] = false;
    isEye[static_cast<std::size_t>(ball)] = true;
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
    rays.push_back({centroid(mesh, corners) + kLift * diagonal * unit(normal), unit(normal)});
    normals.push_back(normal);
  }
  Vec3 sum{0, 0, 0};
  const std::vector<double> free = surface.distances(rays);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (std::isinf(free[i])) sum = sum + normals[i];
  return unit(sum);
}

/// Looks at an eye along its axis.
class EyeView {
 public:
  /// @param axis  In which the eye looks.
  EyeView(const TriangleMesh& mesh, const Surface& surface, const std::vector<bool>& isEye, const Vec3& axis)
      : surface_(surface), isEye_(isEye) {
    for (std::size_t t = 0; t < isEye.size(); ++t)
      if (isEye[t])
        for (const std::uint32_t v : mesh.triangles[t]) box_.add(mesh.positions[v]);
    radius_ = 0.5 * box_.diagonal();
    const Vec3 helper = std::abs(axis.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    opening_.axis = axis;
    opening_.across = unit(cross(helper, axis));
    opening_.up = cross(axis, opening_.across);
  }

  /// What is visible of the eye; nothing if it is hidden.
  std::optional<EyeOpening> opening() {
    if (!findMiddle()) return std::nullopt;
    findContour();
    return opening_;
  }

 private:
  /// Whether the eye is the first thing that is seen at each of some places.
  [[nodiscard]] std::vector<bool> seenAt(const std::vector<Vec3>& places) const {
    std::vector<SurfaceRay> rays;
    rays.reserve(places.size());
    for (const Vec3& p : places) rays.push_back({p + 2 * radius_ * opening_.axis, -1.0 * opening_.axis});
    const std::vector<RayHit> hits = surface_.trace(rays);
    std::vector<bool> seen;
    seen.reserve(hits.size());
    for (const RayHit& hit : hits) seen.push_back(!std::isinf(hit.distance) && isEye_[hit.triangle]);
    return seen;
  }

  /// The middle of what is visible, on a square grid.
  /// @return false if too little of it is.
  bool findMiddle() {
    std::vector<Vec3> grid;
    for (int i = -kGrid / 2; i <= kGrid / 2; ++i)
      for (int k = -kGrid / 2; k <= kGrid / 2; ++k)
        grid.push_back(box_.middle() + 2 * radius_ / kGrid * (i * opening_.across + k * opening_.up));
    const std::vector<bool> seen = seenAt(grid);
    double count = 0;
    for (std::size_t i = 0; i < grid.size(); ++i)
      if (seen[i]) {
        opening_.middle = opening_.middle + grid[i];
        ++count;
      }
    if (count < static_cast<double>(kMinSeen)) return false;
    opening_.middle = 1 / count * opening_.middle;
    return true;
  }

  /// The farthest visible spot in each direction; lashes of the same mesh may cover what is nearer.
  void findContour() {
    const double step = 2 * radius_ / kSteps;
    std::vector<Vec3> spokes;
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 2 * std::numbers::pi * d / kDirections;
      for (int k = 0; k < kSteps; ++k)
        spokes.push_back(opening_.place({step * k * std::cos(angle), step * k * std::sin(angle)}));
    }
    const std::vector<bool> seen = seenAt(spokes);
    for (std::size_t d = 0; d < kDirections; ++d) {
      std::size_t last = 0;
      for (std::size_t k = 0; k < kSteps; ++k)
        if (seen[d * kSteps + k]) last = k;
      opening_.contour.push_back(step * (static_cast<double>(last) + 0.5));
    }
  }

  const Surface& surface_;
  const std::vector<bool>& isEye_;
  Bounds box_;
  double radius_ = 0;
  EyeOpening opening_;
};

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

/// Adds the pieces of a mesh around an eye that are neither the eye nor skin.
/// @param isEye  Per triangle; may be empty.
void addCovers(const TriangleMesh& mesh, const std::vector<std::uint32_t>& components, std::uint32_t count,
               const std::vector<bool>& isEye, EyeOpening& opening) {
  std::vector<HoleContent::Cover>& covers = opening.covers;
  const double radius = *std::max_element(opening.contour.begin(), opening.contour.end());
  std::vector<bool> isCover(count, true);
  for (std::size_t t = 0; t < components.size(); ++t) {
    if (!isEye.empty() && isEye[t]) isCover[components[t]] = false;
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Flat p = opening.flat(mesh.positions[v]);
      const double depth = std::abs(dot(mesh.positions[v] - opening.middle, opening.axis));
      if (std::hypot(p.x, p.y) > kCoverReach * radius || depth > kCoverDepth * radius) isCover[components[t]] = false;
    }
  }
  std::size_t pieces = 0;
  for (const HoleContent::Cover& cover : covers) pieces = std::max(pieces, cover.piece + 1);
  std::vector<std::size_t> pieceOf(count, SIZE_MAX);
  for (std::size_t t = 0; t < components.size(); ++t) {
    const std::uint32_t c = components[t];
    const Triangle3& corners = mesh.triangles[t];
    const double area = length(areaNormal(mesh, corners));
    if (!isCover[c] || !(area > 0)) continue;
    if (pieceOf[c] == SIZE_MAX) pieceOf[c] = pieces++;
    covers.push_back({opening.flat(centroid(mesh, corners)), area, pieceOf[c]});
  }
}

/// What a hole has to show, and the triangles around it.
HoleContent contentOf(const TemplateCage& cage, const std::vector<std::uint32_t>& loop, const EyeOpening& opening,
                      const std::vector<Vec3>& positions) {
  HoleContent content{opening.contour, opening.covers, {}};
  for (const Triangle3& t : cage.mesh.triangles) {
    HoleContent::Neighbour neighbour;
    bool touches = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = std::find(loop.begin(), loop.end(), t[k]);
      neighbour.places[k] = opening.flat(positions[t[k]]);
      neighbour.corners[k] = corner == loop.end() ? -1 : static_cast<int>(corner - loop.begin());
      touches = touches || corner != loop.end();
    }
    if (touches) content.neighbours.push_back(neighbour);
  }
  return content;
}

/// A place in front of the skin.
/// @param from  Where its vertex was, for places that are not in front of skin.
Vec3 inFrontOf(const Surface& skin, const EyeOpening& opening, const Flat& p, const Vec3& from, double offset) {
  const Vec3 at = opening.place(p);
  const double far = 8 * *std::max_element(opening.contour.begin(), opening.contour.end());
  const SurfaceRay ray{at + far * opening.axis, -1.0 * opening.axis};
  const double distance = skin.distance(ray);
  if (std::isinf(distance)) return at + dot(from - at, opening.axis) * opening.axis;
  return at + (far - distance + offset) * opening.axis;
}

/// Where the corners of a hole are and should be.
struct BorderMove {
  const std::vector<std::uint32_t>& loop;
  const std::vector<Flat>&from, &to;
  Flat middle;  ///< Of the hole before.

  /// What needs room: nothing where the hole shrinks.
  [[nodiscard]] Flat at(std::size_t i) const {
    const Flat move{to[i].x - from[i].x, to[i].y - from[i].y};
    return move.x * (from[i].x - middle.x) + move.y * (from[i].y - middle.y) > 0 ? move : Flat{};
  }
};

/// Moves what is next to a hole out of the way of its border: as far as the border moves, less and less up to a
/// distance of `kRoom` moves, so that nothing folds over.
void makeRoom(const TemplateCage& cage, const BorderMove& border, const EyeOpening& opening, const Surface& skin,
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
      const Vec3 below = inFrontOf(skin, opening, p, positions[v], 0);
      const double before = dot(positions[v] - below, opening.axis);
      const double rise = dot(inFrontOf(skin, opening, there, positions[v], 0) - below, opening.axis);
      // It follows skin that falls, and rises, as from an eye onto a lid, no more than it must.
      const double offset = rise < 0 ? before : std::max(before - rise, cage.offset);
      positions[v] = inFrontOf(skin, opening, there, positions[v], offset);
    }
  }
}

/// Moves the border of a hole to where it shows an eye.
void drawTo(const TemplateCage& cage, std::vector<std::uint32_t> loop, const EyeOpening& opening,
            const Surface& surface, std::vector<Vec3>& positions) {
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
  makeRoom(cage, {loop, before, fitOutline(border, {opening.contour, {}, {}}), borderMiddle}, opening, surface,
           positions);
  const std::vector<Flat> outline = fitOutline(border, contentOf(cage, loop, opening, positions));
  for (std::size_t i = 0; i < loop.size(); ++i)
    positions[loop[i]] = inFrontOf(surface, opening, outline[i], positions[loop[i]], cage.offset);
}

/// Whether the visible part of an eye is about where landmarks have it.
bool isInPlace(const FaceHole& hole, const Face& face, const EyeOpening& opening, double apart) {
  return length(face.fromFront(hole.place - opening.middle)) < kMaxOff * apart;
}

/// Moves a hole to where a person has it, but for what the shape of the eye may say.
void obey(const FaceHole& hole, const Face& face, double apart, std::vector<Vec3>& positions) {
  const Vec3 miss = missOf(hole, face, positions);
  const double far = length(miss);
  if (!hole.isGiven || !(far > kMaxOffGiven * apart)) return;
  for (const std::uint32_t v : hole.loop) positions[v] = positions[v] + (1 - kMaxOffGiven * apart / far) * miss;
}

std::optional<Vec3> centreOf(const std::vector<Landmark>& landmarks, const std::string& side) {
  if (const auto centre = placeOf(landmarks, "eye_centre_" + side)) return centre;
  const auto inner = placeOf(landmarks, "eye_inner_" + side), outer = placeOf(landmarks, "eye_outer_" + side);
  if (!inner || !outer) return std::nullopt;
  return 0.5 * (*inner + *outer);
}

}  // namespace

std::vector<EyePair> eyePairs(const std::vector<Landmark>& from, const std::vector<Landmark>& to) {
  std::vector<EyePair> out;
  for (const char* side : {"left", "right"}) {
    const auto own = centreOf(from, side), there = centreOf(to, side);
    if (own && there) out.push_back({*own, *there});
  }
  if (out.size() < 2) out.clear();
  return out;
}

bool fitEyeHoles(const TemplateCage& cage, const EyedFigure& figure, const StepCallback& step,
                 std::vector<Vec3>& tracks, std::vector<Vec3>& positions) {
  constexpr double kTreeShare = 0.4;  ///< Of the time.
  tracks.assign(positions.size(), Vec3{0, 0, 0});
  for (const FaceHole& hole : figure.holes)
    for (const std::uint32_t v : hole.loop) tracks[v] = figure.face.there.front;
  if (figure.eyes.empty()) return true;
  const Surface surface(figure.mesh);
  for (std::size_t side = 0; side < 2; ++side) {
    if (!step(kTreeShare + static_cast<double>(side) * (1 - kTreeShare) / 2)) return false;
    const EyePair &eye = figure.eyes[side], &other = figure.eyes[1 - side];
    const int hole = holeAt(cage, eye.from, other.from);
    if (hole < 0) continue;
    const std::vector<bool> isEye = eyeAt(figure, eye.to, other.to);
    if (std::find(isEye.begin(), isEye.end(), true) == isEye.end()) continue;
    const Vec3 axis = axisOf(figure.mesh, isEye, surface, cage.diagonal);
    if (!(length(axis) > 0)) continue;
    std::optional<EyeOpening> opening = EyeView(figure.mesh, surface, isEye, axis).opening();
    const std::vector<std::uint32_t>& loop = cage.loops[static_cast<std::size_t>(hole)];
    if (!opening) continue;
    const double apart = length(eye.to - other.to);
    const auto placed =
        std::find_if(figure.holes.begin(), figure.holes.end(), [&](const FaceHole& one) { return one.loop == loop; });
    if (placed != figure.holes.end() && !isInPlace(*placed, figure.face, *opening, apart)) continue;
    addCovers(figure.mesh, figure.components, figure.componentCount, isEye, *opening);
    addCovers(figure.covers, figure.coverComponents, figure.componentCount, {}, *opening);
    drawTo(cage, loop, *opening, surface, positions);
    if (placed != figure.holes.end()) obey(*placed, figure.face, apart, positions);
    for (const std::uint32_t v : loop) tracks[v] = opening->axis;
  }
  return true;
}

}  // namespace cagecast::cages
