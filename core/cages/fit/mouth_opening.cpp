#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fit/opening.hpp"

namespace cagecast::cages {

namespace {

/// Lengths in widths of the mouth. It is looked at in columns and rows this far to each side of the hole's middle.
constexpr double kSideReach = 0.6, kHeightReach = 0.75;
constexpr int kColumns = 96, kRows = 150, kMiddleRow = 75;
/// The line between the lips is this near to the middle of the hole.
constexpr double kSeamReach = 0.15;
/// What lies this deep between what is above and below is behind the lips: deeper than a crease, about as deep as
/// teeth.
constexpr double kBehind = 0.15;
/// A crease is as certain as it is deep: one of this depth as certain as the hole's own middle.
constexpr double kFaint = 0.03;
/// The line is smooth over this distance.
constexpr double kSmooth = 0.06;
/// Lips are open if the area between them is larger than this square.
constexpr double kMinOpen = 0.1;
/// What is higher is no mouth.
constexpr double kMaxHeight = 1;
/// The hole ends this far inside of the lips' rims, so that all of them is painted.
constexpr double kInside = 0.012;
/// Lips reach this far to the front of a crease: the hole between closed ones is not laid into it.
constexpr double kLip = 0.06;
/// Half the height of the hole between closed lips.
constexpr double kLine = 0.006;
/// Directions of the contour, and places along each of them.
constexpr int kContourDirections = 144, kContourSteps = 144;

/// Looks at a mouth from in front.
class MouthView {
 public:
  MouthView(const std::vector<Vec3>& border, double width, const Axes& face, const Surface& surface)
      : width_(width), step_(2 * kSideReach * width / kColumns), rowStep_(2 * kHeightReach * width / kRows) {
    opening_.middle = meanOf(border);
    opening_.axis = face.front;
    opening_.across = face.left;
    opening_.up = face.up;
    for (const Vec3& p : border) border_.push_back(opening_.flat(p));
    for (int i = 0; i <= kColumns; ++i) columns_.push_back(look(-kSideReach * width + i * step_, surface));
  }

  std::optional<FaceOpening> opening() {
    double area = 0;
    for (const Column& column : columns_) {
      const double height = column.high - column.low;
      if (height > kMaxHeight * width_) return std::nullopt;
      area += step_ * height;
    }
    if (columns_.front().high > columns_.front().low || columns_.back().high > columns_.back().low) return std::nullopt;
    const bool isOpen = area > kMinOpen * kMinOpen * width_ * width_;
    opening_.isClosed = !isOpen;
    drawSeam();
    // The hole's own width, or that of what is open.
    Range across;
    for (const Flat& p : border_)
      if (!isOpen) across.add(p.x);
    for (const Column& column : columns_)
      if (isOpen && column.high > column.low) across.add(column.x);
    const double middle = 0.5 * (across.low + across.high), reach = 0.5 * (across.high - across.low) + 0.5 * step_;
    double most = 0;
    std::vector<double> heights;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column& column = columns_[i];
      const double aside = (column.x - middle) / reach;
      double height = kLine * width_ * std::sqrt(std::max(0.0, 1 - aside * aside));
      if (isOpen && column.high > column.low)
        height = std::max({height, column.high - opening_.seam[i] - kInside * width_,
                           opening_.seam[i] - column.low - kInside * width_});
      heights.push_back(height);
      most = std::max(most, height);
    }
    opening_.stretch = reach / most;
    for (int d = 0; d < kContourDirections; ++d) {
      const double angle = 2 * std::numbers::pi * d / kContourDirections,
                   each = std::numbers::sqrt2 * reach / kContourSteps;
      int last = 0;
      for (int k = 0; k < kContourSteps; ++k) {
        const double x = middle + each * k * std::cos(angle), y = each * k * std::abs(std::sin(angle));
        const auto i =
            static_cast<std::size_t>(std::clamp(std::lround((x - columns_[0].x) / step_), 0L, long{kColumns}));
        if (std::abs(x - middle) < reach && y < opening_.stretch * heights[i]) last = k;
      }
      opening_.contour.push_back(each * (last + 0.5));
    }
    for (std::size_t i = 0; i + 1 < columns_.size(); ++i) {
      const Column &a = columns_[i], &b = columns_[i + 1];
      if (!a.hasRims || !b.hasRims || std::min(std::abs(a.x - middle), std::abs(b.x - middle)) > reach) continue;
      const auto first = static_cast<std::uint32_t>(opening_.fill.positions.size());
      for (const Vec3& p : {a.below, b.below, b.above, a.above}) opening_.fill.positions.push_back(p);
      opening_.fill.triangles.push_back({first, first + 1, first + 2});
      opening_.fill.triangles.push_back({first, first + 2, first + 3});
    }
    opening_.middle = opening_.middle + middle * opening_.across;
    opening_.seamFrom = columns_[0].x - middle;
    opening_.seamStep = step_;
    return opening_;
  }

 private:
  /// What is seen of a mouth at one place across it. Heights are above the middle of its hole.
  struct Column {
    double x, middle;              ///< The middle of the hole.
    double low = 0, high = 0;      ///< What is behind the lips; equal if nothing is.
    Vec3 below{}, above{};         ///< The rims of what is behind, or the lips next to a crease.
    bool hasRims = false;          ///< Whether there is something at both.
    double crease = 0, depth = 0;  ///< The height of the deepest crease and how deep it is; of what is open, too.
  };

  /// The height of the middle of the hole's border; beyond its sides that at the side.
  [[nodiscard]] double middleAt(double x) const {
    Range sides, heights;
    for (const Flat& p : border_) sides.add(p.x);
    const double inset = 0.02 * (sides.high - sides.low);
    x = std::clamp(x, sides.low + inset, sides.high - inset);
    for (std::size_t i = 0; i < border_.size(); ++i) {
      const Flat &a = border_[i], &b = border_[(i + 1) % border_.size()];
      if ((a.x < x) != (b.x < x)) heights.add(a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y));
    }
    return 0.5 * (heights.low + heights.high);
  }

  [[nodiscard]] Column look(double x, const Surface& surface) const {
    Column column{x, middleAt(x)};
    column.crease = column.middle;
    const auto heightOf = [&](int row) { return column.middle + (row - kMiddleRow) * rowStep_; };
    std::vector<SurfaceRay> rays;
    for (int row = 0; row <= kRows; ++row)
      rays.push_back({opening_.place({x, heightOf(row)}) + width_ * opening_.axis, -1.0 * opening_.axis});
    std::vector<double> distances;
    for (const RayHit& hit : surface.trace(rays)) distances.push_back(hit.distance);
    // How far each place is behind the nearest ones above and below.
    std::vector<double> below(distances), above(distances);
    for (std::size_t row = 1; row < below.size(); ++row) below[row] = std::min(below[row], below[row - 1]);
    for (std::size_t row = above.size() - 1; row > 0; --row) above[row - 1] = std::min(above[row - 1], above[row]);
    std::vector<double> depths;
    for (std::size_t row = 0; row < distances.size(); ++row) {
      const double rim = std::max(below[row], above[row]);
      depths.push_back(std::isinf(rim) ? 0 : std::min(distances[row] - rim, kBehind * width_));
    }
    const auto isBehind = [&](int row) {
      return row >= 0 && row <= kRows && depths[static_cast<std::size_t>(row)] >= kBehind * width_;
    };
    const int reach = static_cast<int>(kSeamReach * width_ / rowStep_);
    int first = kRows, last = -1, deepest = kMiddleRow;
    for (int row = kMiddleRow - reach; row <= kMiddleRow + reach; ++row) {
      if (depths[static_cast<std::size_t>(row)] > depths[static_cast<std::size_t>(deepest)]) deepest = row;
      if (!isBehind(row)) continue;
      first = std::min(first, row);
      last = row;
    }
    // What is deepest at the edge is no crease: it goes down from there, as to the root of a nose.
    if (std::abs(deepest - kMiddleRow) < reach) {
      column.crease = heightOf(deepest);
      column.depth = depths[static_cast<std::size_t>(deepest)];
    }
    const auto rim = [&](double height) {
      const auto row = std::clamp(std::lround((height - column.middle) / rowStep_) + kMiddleRow, 0L, long{kRows});
      const double distance = distances[static_cast<std::size_t>(row)];
      if (std::isinf(distance)) column.hasRims = false;
      return opening_.place({x, height}) + (width_ - distance) * opening_.axis;
    };
    if (last >= 0) {
      while (isBehind(first - 1)) --first;
      while (isBehind(last + 1)) ++last;
      column.low = heightOf(first) - 0.5 * rowStep_;
      column.high = heightOf(last) + 0.5 * rowStep_;
      column.crease = 0.5 * (column.low + column.high);
      column.depth = kBehind * width_;
    }
    const double apart = std::max(kLip * width_, 0.5 * (column.high - column.low) + rowStep_);
    column.hasRims = true;
    column.below = rim(column.crease - apart);
    column.above = rim(column.crease + apart);
    return column;
  }

  /// The line where the lips meet, or the middle between them: along creases, else along the middle of the hole.
  void drawSeam() {
    for (const Column& column : columns_) {
      double total = 0, sum = 0;
      for (const Column& other : columns_) {
        const double share = std::exp(-std::pow((other.x - column.x) / (kSmooth * width_), 2));
        total += share * (other.depth + kFaint * width_);
        sum += share * other.depth * (other.crease - other.middle);
      }
      opening_.seam.push_back(column.middle + sum / total);
    }
  }

  double width_, step_, rowStep_;
  FaceOpening opening_;
  std::vector<Flat> border_;
  std::vector<Column> columns_;
};

}  // namespace

std::optional<FaceOpening> mouthOpening(const std::vector<Vec3>& border, double width, const Axes& face,
                                        const Surface& surface) {
  return MouthView(border, width, face, surface).opening();
}

}  // namespace cagecast::cages
