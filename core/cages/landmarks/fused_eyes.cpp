#include <algorithm>
#include <cmath>
#include <limits>

#include "landmarks/eyes.hpp"
#include "landmarks/height_map.hpp"

namespace cagecast::cages {

namespace {

// Lengths are shares of the frame's unit, which is about the diagonal of head and neck.
constexpr double kStep = 0.004;
/// From the tip of the nose to the back of the head; from the eyes to the crown, and to the back.
constexpr double kHeadDepth = 0.54, kEyesToCrown = 0.29, kEyesToBack = 0.43;

/// A frame for a head whose eyes are not known, from the depth of what is at the top of the figure.
HeadFrame guessFrame(const TriangleMesh& mesh, const MirrorPlane& plane, double side) {
  HeadFrame frame;
  frame.left = side * plane.left;
  frame.front = cross(frame.left, frame.up);
  double top = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : mesh.positions) top = std::max(top, p.y);
  frame.unit = diagonalOf(mesh);
  double rear = 0;
  for (int round = 0; round < 4; ++round) {
    constexpr double kHead = 0.45;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : mesh.positions) {
      if (p.y < top - kHead * frame.unit) continue;
      low = std::min(low, dot(frame.front, p));
      high = std::max(high, dot(frame.front, p));
    }
    frame.unit = std::min(frame.unit, (high - low) / kHeadDepth);
    rear = low;
  }
  const Vec3 middle = side * plane.offset * frame.left;
  frame.origin = {middle.x, top - kEyesToCrown * frame.unit, middle.z};
  frame.origin = frame.origin + (rear + kEyesToBack * frame.unit - dot(frame.origin, frame.front)) * frame.front;
  return frame;
}

/// How far the midline stands out from both sides of it: most at the tip of a nose.
double ridge(const HeightMap& map, double y) {
  constexpr double kAside = 0.05;
  const double sides = 0.5 * (map.near(-kAside, y) + map.near(kAside, y));
  const double value = map.near(0, y) - sides;
  return std::isfinite(value) ? value : 0;
}

/// How much a surface bulges in the direction in which it bulges least: the lesser principal curvature.
double bulge(const HeightMap& map, double x, double y) {
  constexpr double kReach = 0.012;
  const auto z = [&](int i, int k) { return map.near(x + i * kReach, y + k * kReach); };
  const double xx = z(1, 0) + z(-1, 0) - 2 * z(0, 0);
  const double yy = z(0, 1) + z(0, -1) - 2 * z(0, 0);
  const double xy = 0.25 * (z(1, 1) + z(-1, -1) - z(1, -1) - z(-1, 1));
  const double mean = 0.5 * (xx + yy), off = std::hypot(0.5 * (xx - yy), xy);
  const double value = -(mean + off) / (kReach * kReach);
  return std::isfinite(value) ? value : 0;
}

struct Found {
  double x = 0, y = 0;  ///< Of the left eye.
  double strength = 0;  ///< Curvature.
};

/// The pair of places at the nose's root that bulge most.
Found searchBulges(const HeightMap& map, double noseY, double rootY) {
  constexpr double kInner = 0.045, kOuter = 0.135, kAbove = 0.03, kBelow = 0.05;
  Found best;
  for (double y = std::max(rootY - kBelow, noseY + 0.03); y <= rootY + kAbove; y += kStep)
    for (double x = kInner; x <= kOuter; x += kStep) {
      const double strength = std::min(bulge(map, x, y), bulge(map, -x, y));
      if (strength > best.strength) best = {x, y, strength};
    }
  return best;
}

/// The middle of the region around a bulge that bulges at least half as much.
void centre(const HeightMap& map, Found& found) {
  constexpr double kReach = 0.032;
  double sum = 0, xs = 0, ys = 0;
  for (double y = found.y - kReach; y <= found.y + kReach; y += kStep)
    for (double x = found.x - kReach; x <= found.x + kReach; x += kStep) {
      const double weight = 0.5 * (bulge(map, x, y) + bulge(map, -x, y)) - 0.4 * found.strength;
      if (weight <= 0) continue;
      sum += weight;
      xs += weight * x;
      ys += weight * y;
    }
  if (sum <= 0) return;
  found.x = xs / sum;
  found.y = ys / sum;
}

}  // namespace

std::optional<Eyes> findFusedEyes(const Figure& figure, const MirrorPlane& plane) {
  constexpr double kLeastNose = 0.02;  ///< How far a nose stands out.
  constexpr double kLeastBulge = 6;    ///< Eyeballs have a radius of 0.03 to 0.05; cheeks one of 0.2.
  const TriangleMesh skin = figure.only(Role::surface);
  std::optional<Eyes> best;
  double most = kLeastNose;
  for (const double side : {plane.left.x < 0 ? -1.0 : 1.0, plane.left.x < 0 ? 1.0 : -1.0}) {
    const HeadFrame frame = guessFrame(skin, plane, side);
    const TriangleMesh local = frame.toLocal(within(skin, frame.origin, 0.6 * frame.unit));
    if (local.empty()) continue;
    const Surface surface(local);
    const Grid grid = Grid::over(-0.2, 0.2, -0.3, 0.2, kStep);
    const HeightMap map = blurred(look(surface, kFrontView, grid, 0.7), 0.006);
    double noseY = 0;
    for (double y = -0.22; y < 0.03; y += kStep)
      if (ridge(map, y) > ridge(map, noseY)) noseY = y;
    if (ridge(map, noseY) <= most) continue;
    // The nose's root: the deepest place of the midline over its tip.
    double rootY = noseY + 0.04;
    for (double y = rootY; y < noseY + 0.15; y += kStep)
      if (map.near(0, y) < map.near(0, rootY)) rootY = y;
    Found found = searchBulges(map, noseY, rootY);
    if (found.strength < kLeastBulge) continue;
    centre(map, found);
    most = ridge(map, noseY);
    Eyes eyes;
    constexpr double kEyeRadius = 0.037;
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
      const double x = i == 0 ? found.x : -found.x;
      eyes.centres[i] = frame.toModel({x, found.y, map.near(x, found.y) - kEyeRadius});
    }
    eyes.left = frame.left;
    eyes.front = frame.front;
    eyes.radius = kEyeRadius * frame.unit;
    eyes.confidence = found.strength > 2 * kLeastBulge ? 0.6 : 0.5;
    best = std::move(eyes);
  }
  return best;
}

}  // namespace cagecast::cages
