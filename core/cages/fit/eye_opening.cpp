#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/opening.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

/// Lengths in diagonals of the cage.
constexpr double kEyeNear = 0.04;    ///< From the landmark to the middle of the component that is the eye, at most.
constexpr double kLargestEye = 0.3;  ///< The size of an eye, at most.
constexpr double kLift = 1e-4;       ///< Rays from a surface start this far off it.
/// Rays to an eye: directions from its middle, places along each of them, and places along the sides of a grid.
constexpr int kDirections = 144, kSteps = 144, kGrid = 48;
/// A component may be the lashes of an eye if all of it is this near to the eye's middle, across and in depth. In
/// largest radii of what is visible of the eye.
constexpr double kCoverReach = 1.6, kCoverDepth = 4;
/// The centre of an eye is in the box of the eyeball, enlarged by this share of its size.
constexpr double kBoxSlack = 0.2;
/// What is this near to the middle of an eyeball, in its radii, belongs to the eye: pupils and corneas, not lashes.
constexpr double kBallSlack = 1.15;
/// An eye that is seen at fewer places of the grid is hidden.
constexpr std::size_t kMinSeen = 32;

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
std::vector<bool> eyeAt(const HoledFigure& figure, const Vec3& centre, const Vec3& other, double diagonal) {
  const std::size_t count = figure.mesh.triangles.size();
  std::vector<Bounds> boxes(figure.componentCount);
  for (std::size_t t = 0; t < count; ++t)
    for (const std::uint32_t v : figure.mesh.triangles[t]) boxes[figure.components[t]].add(figure.mesh.positions[v]);
  std::vector<bool> named(boxes.size()), isNear(boxes.size()), isEye(boxes.size());
  for (std::size_t t = 0; t < count; ++t)
    if (figure.isEye[t]) named[figure.components[t]] = true;
  const bool anyNamed = std::find(named.begin(), named.end(), true) != named.end();
  for (std::size_t c = 0; c < boxes.size(); ++c) {
    if (boxes[c].empty()) continue;
    const double distance = length(boxes[c].middle() - centre);
    if (boxes[c].diagonal() > kLargestEye * diagonal || distance > length(boxes[c].middle() - other)) continue;
    isEye[c] = named[c] && distance < kLargestEye * diagonal;
    isNear[c] = distance < kEyeNear * diagonal;
  }
  const int ball = anyNamed ? -1 : eyeballAt(boxes, isNear, centre);
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
  const std::vector<RayHit> hits = surface.trace(rays);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (std::isinf(hits[i].distance)) sum = sum + normals[i];
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
  std::optional<FaceOpening> opening() {
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
  FaceOpening opening_;
};

/// Adds the pieces of a mesh around an eye that are neither the eye nor skin.
/// @param isEye  Per triangle; may be empty.
void addCovers(const TriangleMesh& mesh, const std::vector<std::uint32_t>& components, std::uint32_t count,
               const std::vector<bool>& isEye, FaceOpening& opening) {
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

}  // namespace

std::optional<FaceOpening> eyeOpening(const HoledFigure& figure, const EyePair& eye, const Vec3& other, double diagonal,
                                      const Surface& surface) {
  const std::vector<bool> isEye = eyeAt(figure, eye.to, other, diagonal);
  if (std::find(isEye.begin(), isEye.end(), true) == isEye.end()) return std::nullopt;
  const Vec3 axis = axisOf(figure.mesh, isEye, surface, diagonal);
  if (!(length(axis) > 0)) return std::nullopt;
  std::optional<FaceOpening> opening = EyeView(figure.mesh, surface, isEye, axis).opening();
  if (!opening) return opening;
  addCovers(figure.mesh, figure.components, figure.componentCount, isEye, *opening);
  addCovers(figure.covers, figure.coverComponents, figure.componentCount, {}, *opening);
  return opening;
}

}  // namespace cagecast::cages
