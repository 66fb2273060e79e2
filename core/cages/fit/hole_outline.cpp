#include "fit/hole_outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cagecast::cages {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// What must be free is free this much farther out: paint must not reach it. At 1.06 the transfer painted 3 % of it.
constexpr double kOutlineMargin = 1.12;
/// What else is free should be less than this share of what must be free.
constexpr double kMaxSpill = 0.38;
/// Costs of four areas, as shares of what must be free: what of it is covered; what of its margin is covered; what else
/// is free; and what of that is beyond `kMaxSpill`.
constexpr double kCovered = 5, kMarginCovered = 1.5, kSpill = 1, kTooMuch = 10;
/// Costs of covers of the eye that are not free, and of each radian that a corner turns.
constexpr double kCoversCovered = 2, kTurned = 0.1;
/// A transfer leaves out a piece of which less than half is covered: this share of it may be.
constexpr double kMayBeCovered = 0.35;
/// What a triangle costs that is folded over, or has less than this share of the square of its longest edge as its
/// area; or less than half of what it had before.
constexpr double kFolded = 20, kMinArea = 0.04;
/// Corners stay this far apart, and are never farther apart, in radians.
constexpr double kMinGap = 0.1, kMaxGap = 2.8;
/// The search halves its steps, from shares of the radius and radians.
constexpr double kFirstStep = 0.2, kLastStep = 0.005;
constexpr int kMaxRounds = 100;

/// A corner by angle and distance from the origin.
struct Corner {
  double angle, distance;
};

double cross(const Flat& a, const Flat& b) { return a.x * b.y - a.y * b.x; }
Flat flat(const Corner& corner) {
  return {corner.distance * std::cos(corner.angle), corner.distance * std::sin(corner.angle)};
}
double wrapped(double angle) { return angle - kTurn * std::floor(angle / kTurn); }

/// The signed area of a triangle, as a share of the square of its longest edge.
double areaShare(const std::array<Flat, 3>& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest, std::hypot(t[(k + 1) % 3].x - t[k].x, t[(k + 1) % 3].y - t[k].y));
  const double twice = cross({t[1].x - t[0].x, t[1].y - t[0].y}, {t[2].x - t[0].x, t[2].y - t[0].y});
  return longest > 0 ? 0.5 * twice / (longest * longest) : 0;
}

class Search {
 public:
  Search(std::vector<Corner> corners, const HoleContent& content)
      : corners_(std::move(corners)), own_(corners_), contour_(content.contour) {
    // What faces away before, as at the side of a nose, says nothing.
    for (const HoleContent::Neighbour& neighbour : content.neighbours) {
      const double share = areaShare(neighbour.places);
      if (share > 0) neighbours_.push_back({neighbour, std::min(kMinArea, share / 2)});
    }
    for (std::size_t d = 0; d < contour_.size(); ++d) {
      const double angle = kTurn * static_cast<double>(d) / static_cast<double>(contour_.size());
      directions_.push_back({std::cos(angle), std::sin(angle)});
      area_ += contour_[d] * contour_[d];
    }
    for (const HoleContent::Cover& cover : content.covers) {
      covers_.push_back(
          {wrapped(std::atan2(cover.at.y, cover.at.x)), std::hypot(cover.at.x, cover.at.y), cover.area, cover.piece});
      pieceAreas_.resize(std::max(pieceAreas_.size(), cover.piece + 1));
      pieceAreas_[cover.piece] += cover.area;
    }
  }

  std::vector<Flat> run() {
    double least = cost();
    int rounds = 0;
    for (double step = kFirstStep; step > kLastStep; step /= 2)
      for (bool better = true; better && rounds < kMaxRounds; ++rounds) {
        better = false;
        for (Corner& corner : corners_)
          for (const auto& [turn, growth] :
               {std::pair{0.0, 1 + step}, {0.0, 1 / (1 + step)}, {step, 1.0}, {-step, 1.0}}) {
            const Corner before = corner;
            corner.angle += turn;
            corner.distance *= growth;
            const double now = isInOrder() ? cost() : least;
            if (now < least) {
              least = now;
              better = true;
            } else {
              corner = before;
            }
          }
      }
    std::vector<Flat> out;
    for (const Corner& corner : corners_) out.push_back(flat(corner));
    return out;
  }

 private:
  struct Polar {
    double angle, distance, area;
    std::size_t piece;
  };

  [[nodiscard]] bool isInOrder() const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const bool isLast = i + 1 == corners_.size();
      const double gap = corners_[isLast ? 0 : i + 1].angle + (isLast ? kTurn : 0) - corners_[i].angle;
      if (gap < kMinGap || gap > kMaxGap) return false;
    }
    return true;
  }

  /// How far the hole reaches in a direction.
  [[nodiscard]] double reach(const Flat& direction, double angle) const {
    const double from = corners_[0].angle + wrapped(angle - corners_[0].angle);
    std::size_t i = corners_.size() - 1;
    while (i > 0 && corners_[i].angle > from) --i;
    const Flat a = flat(corners_[i]), b = flat(corners_[(i + 1) % corners_.size()]);
    return cross(a, b) / cross(direction, {b.x - a.x, b.y - a.y});
  }

  [[nodiscard]] double cost() const {
    double covered = 0, margin = 0, spill = 0, coversCovered = 0, turned = 0;
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      const double r = reach(directions_[d], kTurn * static_cast<double>(d) / static_cast<double>(directions_.size()));
      const double wanted = contour_[d] * contour_[d];
      covered += std::max(0.0, wanted - r * r) / area_;
      margin += std::max(0.0, kOutlineMargin * kOutlineMargin * wanted - std::max(r * r, wanted)) / area_;
      spill += std::max(0.0, r * r - wanted) / area_;
    }
    std::vector<double> pieces(pieceAreas_.size());
    for (const Polar& cover : covers_)
      if (cover.distance > reach({std::cos(cover.angle), std::sin(cover.angle)}, cover.angle))
        pieces[cover.piece] += cover.area / pieceAreas_[cover.piece];
    for (const double share : pieces)
      coversCovered += std::max(0.0, share - kMayBeCovered) / static_cast<double>(pieces.size());
    for (std::size_t i = 0; i < corners_.size(); ++i)
      turned += std::pow(corners_[i].angle - own_[i].angle, 2) / static_cast<double>(corners_.size());
    double folded = 0;
    for (const auto& [neighbour, least] : neighbours_) {
      std::array<Flat, 3> places = neighbour.places;
      for (std::size_t k = 0; k < 3; ++k)
        if (neighbour.corners[k] >= 0) places[k] = flat(corners_[static_cast<std::size_t>(neighbour.corners[k])]);
      folded += std::max(0.0, least - areaShare(places));
    }
    return kFolded * folded + kCovered * covered + kMarginCovered * margin + kSpill * spill +
           kTooMuch * std::max(0.0, spill - kMaxSpill) + kCoversCovered * coversCovered + kTurned * turned;
  }

  std::vector<Corner> corners_;
  std::vector<Corner> own_;
  const std::vector<double>& contour_;
  std::vector<Flat> directions_;
  std::vector<Polar> covers_;
  std::vector<std::pair<HoleContent::Neighbour, double>> neighbours_;  ///< And their least shares of area.
  std::vector<double> pieceAreas_;
  double area_ = 0;
};

}  // namespace

std::vector<Flat> fitOutline(std::vector<Flat> corners, const HoleContent& content) {
  const std::size_t count = corners.size();
  std::vector<Corner> polar;
  double before = std::atan2(corners[0].y, corners[0].x);
  for (const Flat& corner : corners) {
    before += std::remainder(std::atan2(corner.y, corner.x) - before, kTurn);
    polar.push_back({before, 1});
  }
  // Corners that are out of order, or too close together or far apart, are spread evenly.
  double gap = kMaxGap;
  for (std::size_t i = 0; i < count; ++i) {
    const double next = i + 1 < count ? polar[i + 1].angle : polar[0].angle + kTurn;
    gap = std::min(gap, next - polar[i].angle > kMaxGap ? -1 : next - polar[i].angle);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (gap < kMinGap) polar[i].angle = polar[0].angle + kTurn * static_cast<double>(i) / static_cast<double>(count);
    const auto directions = static_cast<double>(content.contour.size());
    const auto d = static_cast<std::size_t>(wrapped(polar[i].angle) / kTurn * directions) % content.contour.size();
    polar[i].distance = kOutlineMargin * content.contour[d];
  }
  return Search(std::move(polar), content).run();
}

}  // namespace cagecast::cages
