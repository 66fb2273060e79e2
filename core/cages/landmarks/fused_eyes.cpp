#include <algorithm>
#include <cmath>

#include "landmarks/head.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

// Lengths are shares of the frame's unit, which is about the diagonal of head and neck.
constexpr double kEyeStep = 0.004;

/// How far the midline stands out from both sides of it: most at the tip of a nose.
double ridge(const HeightMap& map, double y) {
  constexpr double kAside = 0.035;
  const double sides = 0.5 * (map.near(-kAside, y) + map.near(kAside, y));
  const double value = map.near(0, y) - sides;
  return std::isfinite(value) ? value : 0;
}

/// Where the centres of balls of some radius would be under a surface: each place of a height map votes for the point
/// that far below it, along its normal (a Hough transform). Eyeballs and the lids around them agree on a centre.
struct BallVotes {
  HeightMap density;  ///< Votes per place: 1 on planes.
  HeightMap depth;    ///< Mean height of the centres that are voted for.
};

BallVotes voteForBalls(const HeightMap& map, double radius) {
  constexpr double kReach = 0.008, kSteepest = 1.5, kBlur = 0.006;
  const Grid& grid = map.grid;
  BallVotes votes{map, map};
  std::fill(votes.density.heights.begin(), votes.density.heights.end(), 0);
  std::fill(votes.depth.heights.begin(), votes.depth.heights.end(), 0);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const double x = grid.a(column), y = grid.b(row);
      const double dx = (map.near(x + kReach, y) - map.near(x - kReach, y)) / (2 * kReach);
      const double dy = (map.near(x, y + kReach) - map.near(x, y - kReach)) / (2 * kReach);
      if (!(std::hypot(dx, dy) < kSteepest)) continue;
      const double size = std::sqrt(1 + dx * dx + dy * dy);
      const int c = grid.columnOf(x + radius * dx / size), r = grid.rowOf(y + radius * dy / size);
      if (!grid.has(c, r)) continue;
      votes.density.heights[map.index(c, r)] += 1;
      votes.depth.heights[map.index(c, r)] += map.at(column, row) - radius / size;
    }
  votes.density = blurred(votes.density, kBlur);
  votes.depth = blurred(votes.depth, kBlur);
  for (std::size_t i = 0; i < votes.depth.heights.size(); ++i)
    votes.depth.heights[i] /= std::max(votes.density.heights[i], 1e-6);
  return votes;
}

struct Found {
  double x = 0, y = 0, z = 0;  ///< Of the left eye's centre.
  double radius = 0;
  double votes = 0;
};

/// The pair of balls beside the nose's root that most places agree on.
Found searchBalls(const HeightMap& map, double noseY, double rootY) {
  constexpr double kInner = 0.045, kOuter = 0.135, kAbove = 0.02, kBelow = 0.03;
  Found best;
  for (const double radius : {0.03, 0.036, 0.043, 0.052}) {
    const BallVotes votes = voteForBalls(map, radius);
    for (double y = std::max(rootY - kBelow, noseY + 0.03); y <= rootY + kAbove; y += kEyeStep)
      for (double x = kInner; x <= kOuter; x += kEyeStep) {
        const double count = std::min(votes.density.near(x, y), votes.density.near(-x, y));
        if (count <= best.votes) continue;
        best = {x, y, 0.5 * (votes.depth.near(x, y) + votes.depth.near(-x, y)), radius, count};
      }
  }
  return best;
}

}  // namespace

std::optional<Eyes> findFusedEyes(const Figure& figure, const MirrorPlane& plane) {
  constexpr double kTop = 0.05, kBottom = -0.25;
  constexpr double kMinNose = 0.012;                    ///< How far a nose stands out.
  constexpr double kMinVotes = 2.2, kClearVotes = 3.5;  ///< Planes have 1.
  constexpr double kMinHead = 0.02;                     ///< Of the diagonal: figures are ten heads tall at most.
  const TriangleMesh skin = figure.only(Role::surface);
  const double diagonal = diagonalOf(skin);
  std::optional<Eyes> best;
  double most = kMinNose;
  for (const double side : {plane.left.x < 0 ? -1.0 : 1.0, plane.left.x < 0 ? 1.0 : -1.0}) {
    const HeadFrame frame = guessHeadFrame(skin, plane, side);
    if (figure.front && dot(frame.front, *figure.front) < 0) continue;
    if (!(frame.unit > kMinHead * diagonal)) continue;
    const TriangleMesh local = frame.toLocal(within(skin, frame.origin, 0.6 * frame.unit));
    if (local.empty()) continue;
    const Surface surface(local);
    const Grid grid = Grid::over(-0.2, 0.2, -0.3, 0.2, kEyeStep);
    const HeightMap map = blurred(closed(heightMapOf(surface, kFrontView, grid, 0.7), 0.008), 0.004);
    // From the top down: a chin may stand out more than a nose.
    double standsOut = 0;
    for (double y = kTop; y > kBottom; y -= kEyeStep) standsOut = std::max(standsOut, ridge(map, y));
    if (standsOut <= most) continue;
    most = standsOut;
    best.reset();
    double noseY = kTop;
    while (ridge(map, noseY) < 0.5 * standsOut) noseY -= kEyeStep;
    while (ridge(map, noseY - kEyeStep) > ridge(map, noseY)) noseY -= kEyeStep;
    // A ridge may be highest at its root: the tip is where the profile is foremost before it falls back.
    for (double y = noseY; y > -0.25 && map.near(0, y) > map.near(0, noseY) - 0.012; y -= kEyeStep)
      if (map.near(0, y) > map.near(0, noseY)) noseY = y;
    // The nose's root: the hollow over its tip. Eyes are beside it; without it they could be anywhere.
    constexpr double kRises = 0.0006;  ///< By so much the brow comes out again above it.
    const double rootEnd = noseY + 0.17;
    double rootY = noseY + 0.04, y = rootY;
    for (; y < rootEnd && map.near(0, y) < map.near(0, rootY) + kRises; y += kEyeStep)
      if (map.near(0, y) < map.near(0, rootY)) rootY = y;
    if (y >= rootEnd) continue;
    const Found found = searchBalls(map, noseY, rootY);
    if (found.votes < kMinVotes) continue;
    Eyes eyes;
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
      const double x = i == 0 ? found.x : -found.x;
      eyes.centres[i] = frame.toModel({x, found.y, found.z});
    }
    eyes.left = frame.left;
    eyes.front = frame.front;
    eyes.radius = found.radius * frame.unit;
    eyes.confidence = found.votes > kClearVotes ? 0.6 : 0.5;
    best = std::move(eyes);
  }
  return best;
}

}  // namespace cagecast::cages
