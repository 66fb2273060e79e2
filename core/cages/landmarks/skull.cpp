#include <algorithm>
#include <cmath>

#include "landmarks/head.hpp"
#include "mesh/bounds.hpp"

// Tried and left out: the nape. Where the neck is furthest in front, or begins to come out again, is 4 % of the head's
// length away from where people put it, on the mean: necks are straight there.
namespace cagecast::cages {

namespace {

constexpr double kSkullStep = 0.004;
/// Blur against partings and coarse triangles: skulls are round.
constexpr double kRound = 0.015;

/// How sure a length is, from 0 to 1, by that of most heads: wholly within a share of it, not at all beyond another.
/// Hair and hats make a head longer than its eyes and its other length suggest; a mask ends early.
constexpr double kUsual = 0.15, kOdd = 0.45;
double likeMost(double length, double ofMost) {
  return std::clamp((kOdd - std::abs(length / ofMost - 1)) / (kOdd - kUsual), 0.0, 1.0);
}

}  // namespace

HeadFrame guessHeadFrame(const TriangleMesh& mesh, const MirrorPlane& plane, double side) {
  constexpr double kHeadDepth = 0.54;  ///< From the tip of the nose to the back of the head.
  HeadFrame frame;
  frame.left = side * plane.left;
  frame.front = cross(frame.left, frame.up);
  const double top = rangeOf(mesh.positions, frame.up).high;
  frame.unit = diagonalOf(mesh);
  double rear = 0;
  for (int round = 0; round < 4; ++round) {
    constexpr double kTopShare = 0.45;
    Range depth;
    for (const Vec3& p : mesh.positions)
      if (p.y >= top - kTopShare * frame.unit) depth.add(dot(frame.front, p));
    frame.unit = std::min(frame.unit, (depth.high - depth.low) / kHeadDepth);
    rear = depth.low;
  }
  const Vec3 middle = side * plane.offset * frame.left;
  frame.origin = {middle.x, top - kEyesToCrown * frame.unit, middle.z};
  frame.origin = frame.origin + (rear + kEyesToBack * frame.unit - dot(frame.origin, frame.front)) * frame.front;
  return frame;
}

void findSkull(Head& head) {
  const Spot* brow = head.find("glabella");
  if (brow == nullptr) brow = head.find("nasion");
  if (brow == nullptr) return;
  const double browZ = brow->position.z;  // Adding a spot may move the others.
  // The back of the head: the rearmost place of the midline, level with the face or above.
  constexpr double kLowest = -0.1, kHighest = 0.3;
  const Grid backGrid = Grid::over(-kSkullStep, kSkullStep, -0.4, kHighest + 0.05, kSkullStep);
  const Curve back = Curve::along(heightMapOf(head.surface, kBackView, backGrid, 1.0)).blurred(kRound);
  const auto rearmost = back.highest(kLowest, kHighest);
  if (!rearmost) return;
  // Skulls are flat there: the middle between where they are a little less far back is steadier.
  constexpr double kFlat = 0.012;
  double low = *rearmost, high = *rearmost;
  while (back.at(low) > back.at(*rearmost) - kFlat) low -= kSkullStep;
  while (back.at(high) > back.at(*rearmost) - kFlat) high += kSkullStep;
  const double rear = 0.5 * (low + high);
  const Vec3 occiput{0, rear, -back.at(rear)};
  const bool inside = low > kLowest - 0.1 && high < kHighest;
  head.add("occiput", occiput, (inside ? 0.65 : 0.3) * likeMost(-occiput.z, kEyesToBack));
  // The crown: above the middle of the head's length. The highest place itself moves far with little, for skulls are
  // flat there.
  const double middle = 0.5 * (browZ + occiput.z);
  const Grid topGrid = Grid::over(-kSkullStep, kSkullStep, middle - 0.1, middle + 0.1, kSkullStep);
  const Curve top = Curve::along(heightMapOf(head.surface, kTopView, topGrid, 1.0)).blurred(kRound);
  const double height = top.at(middle);
  if (!std::isfinite(height)) return;
  const double sure = likeMost(height, kEyesToCrown);
  head.add("crown", {0, height, middle}, 0.65 * sure);
  // The forehead is between brow and crown, as a share of the height over the eyes.
  constexpr double kForehead = 0.61;
  const Grid frontGrid = Grid::over(-kSkullStep, kSkullStep, 0.05, 0.35, kSkullStep);
  const Curve front = Curve::along(heightMapOf(head.surface, kFrontView, frontGrid, 1.0)).blurred(kRound);
  const double forehead = front.at(kForehead * height);
  if (std::isfinite(forehead)) head.add("forehead", {0, kForehead * height, forehead}, 0.55 * sure);
}

}  // namespace cagecast::cages
