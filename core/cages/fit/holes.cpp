#include <algorithm>

#include "fit/opening.hpp"

namespace cagecast::cages {

namespace {

/// From the middle of an eye or a mouth to the middle of its hole, at most, in diagonals of the cage.
constexpr double kHoleNear = 0.12;
/// A hole that reaches back by more than this share of its width is no mouth in a face but one along a snout.
constexpr double kMaxBend = 0.5;
/// The cage is this close to lips at the hole between them, in widths of the mouth: seen past the rim from where lips
/// face, too, nothing but what is behind them shows.
constexpr double kLipOffset = 0.02;

/// The hole whose middle is nearest to a spot, and to no other spot; -1 if there is none of its own.
int holeAt(const TemplateCage& cage, const Vec3& spot, const std::vector<Vec3>& others) {
  int best = -1;
  double least = kHoleNear * cage.diagonal;
  for (std::size_t i = 0; i < cage.loops.size(); ++i) {
    if (static_cast<int>(i) == cage.rim) continue;
    const Vec3 middle = middleOf(cage.mesh, cage.loops[i]);
    const double distance = length(middle - spot);
    const bool isAnothers = std::any_of(others.begin(), others.end(),
                                        [&](const Vec3& other) { return distance >= length(middle - other); });
    if (distance >= least || isAnothers) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

std::optional<Vec3> centreOf(const std::vector<Landmark>& landmarks, const std::string& side) {
  if (const auto centre = placeOf(landmarks, "eye_centre_" + side)) return centre;
  const auto inner = placeOf(landmarks, "eye_inner_" + side), outer = placeOf(landmarks, "eye_outer_" + side);
  if (!inner || !outer) return std::nullopt;
  return 0.5 * (*inner + *outer);
}

std::vector<Vec3> placesOf(const std::vector<std::uint32_t>& loop, const std::vector<Vec3>& positions) {
  std::vector<Vec3> out;
  out.reserve(loop.size());
  for (const std::uint32_t v : loop) out.push_back(positions[v]);
  return out;
}

double extent(const std::vector<Vec3>& points, const Vec3& direction) {
  const Range range = rangeOf(points, direction);
  return range.high - range.low;
}

TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const Triangle3& t : other.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return mesh;
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

std::optional<Mouth> mouthOf(const std::vector<Landmark>& landmarks) {
  const auto left = placeOf(landmarks, "mouth_corner_left"), right = placeOf(landmarks, "mouth_corner_right");
  const Axes axes = axesOf(landmarks);
  if (!left || !right || !axes.known) return std::nullopt;
  return Mouth{0.5 * (*left + *right), *left - *right, axes.front};
}

bool fitHoles(const TemplateCage& cage, const HoledFigure& figure, const StepCallback& step, std::vector<Vec3>& tracks,
              std::vector<Vec3>& positions) {
  constexpr double kTreeShare = 0.4, kEachShare = 0.2;  ///< Of the time.
  tracks.assign(positions.size(), Vec3{0, 0, 0});
  if (figure.eyes.empty()) return true;
  const Surface surface(figure.mesh);
  const auto draw = [&](int hole, const FaceOpening& opening, const HoleGround& ground) {
    const std::vector<std::uint32_t>& loop = cage.loops[static_cast<std::size_t>(hole)];
    drawHole(cage, loop, opening, ground, positions);
    for (const std::uint32_t v : loop) tracks[v] = opening.axis;
  };
  for (std::size_t side = 0; side < 2; ++side) {
    if (!step(kTreeShare + static_cast<double>(side) * kEachShare)) return false;
    const EyePair &eye = figure.eyes[side], &other = figure.eyes[1 - side];
    const int hole = holeAt(cage, eye.from, {other.from});
    if (hole < 0) continue;
    if (const auto opening = eyeOpening(figure, eye, other.to, cage.diagonal, surface))
      draw(hole, *opening, {surface, cage.offset});
  }
  if (!step(kTreeShare + 2 * kEachShare)) return false;
  if (!figure.mouth || !figure.face.known) return true;
  const int hole = holeAt(cage, figure.mouth->middle, {figure.eyes[0].from, figure.eyes[1].from});
  if (hole < 0) return true;
  const std::vector<std::uint32_t>& loop = cage.loops[static_cast<std::size_t>(hole)];
  const std::vector<Vec3> own = placesOf(loop, cage.mesh.positions), border = placesOf(loop, positions);
  const double ownSize = extent(own, unit(figure.mouth->across)), size = extent(border, figure.face.left);
  if (!(size > 0 && extent(own, figure.mouth->front) < kMaxBend * ownSize)) return true;
  const double width = size / ownSize * length(figure.mouth->across);
  auto opening = mouthOpening(border, width, figure.face, surface);
  if (!opening) return true;
  for (Vec3& p : opening->fill.positions) p = p + cage.offset * opening->axis;
  draw(hole, *opening, {Surface(joined(figure.hull, opening->fill)), std::min(0.0, kLipOffset * width - cage.offset)});
  return true;
}

}  // namespace cagecast::cages
