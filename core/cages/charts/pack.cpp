#include "charts/steps.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace cagecast::cages {

namespace {

/// More charts than this are packed by their boxes.
constexpr std::size_t kMaxMasks = 40;
/// The first size tried has charts cover this much; each try is smaller by a factor. Once they fit, sizes between are
/// tried.
constexpr double kFirstCoverage = 0.85, kSmaller = 0.94;
constexpr int kRefinements = 2;
/// A cell is no smaller than this, so that masks stay small.
constexpr double kMinGutter = 1.0 / 2048;
constexpr std::size_t kWord = 64;
/// The work of a try, for the ticker, as a number of triangles.
constexpr std::size_t kWorkPerTry = 3000;

/// Cells that a chart touches, row by row.
struct Mask {
  std::size_t width = 0, height = 0, words = 0;
  std::vector<std::uint64_t> bits;

  Mask(std::size_t w, std::size_t h) : width(w), height(h), words((w + kWord - 1) / kWord + 1), bits(words * h) {}
  void set(std::size_t x, std::size_t y) { bits[y * words + x / kWord] |= std::uint64_t{1} << (x % kWord); }
};

/// Marks, row by row, the cells between the leftmost and the rightmost point of a triangle within the row.
void addTriangle(Mask& mask, const std::array<Uv, 3>& corners) {
  const auto [lowest, highest] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
  const auto cell = [](double value, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(0.0, value)), count - 1);
  };
  for (std::size_t y = cell(lowest, mask.height); y <= cell(highest, mask.height); ++y) {
    const auto bottom = static_cast<double>(y), top = bottom + 1;
    double left = std::numeric_limits<double>::infinity(), right = -left;
    const auto add = [&](double x) {
      left = std::min(left, x);
      right = std::max(right, x);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const Uv &a = corners[i], &b = corners[(i + 1) % 3];
      if (a[1] >= bottom && a[1] <= top) add(a[0]);
      for (const double line : {bottom, top})
        if ((a[1] - line) * (b[1] - line) < 0) add(a[0] + (line - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    }
    if (left > right) continue;
    for (std::size_t x = cell(left - 1e-6, mask.width); x <= cell(right + 1e-6, mask.width); ++x) mask.set(x, y);
  }
}

Mask maskOf(const Chart& chart, const UvBox& box, double scale) {
  const auto extent = [&](std::size_t k) { return static_cast<std::size_t>(scale * box.side(k)) + 1; };
  Mask mask(extent(0), extent(1));
  for (const Triangle3& t : chart.piece.mesh.triangles) {
    std::array<Uv, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 2; ++k) corners[i][k] = scale * (chart.uvs[t[i]][k] - box.low[k]);
    addTriangle(mask, corners);
  }
  return mask;
}

/// The square that is being filled: cells that are taken, or next to taken ones.
class Square {
 public:
  /// Wide enough for masks that stand out on the right by a word.
  explicit Square(std::size_t cells) : cells_(cells), taken_(cells + 2 * kWord, cells) {}

  /// The lowest place for a mask, of these the leftmost.
  [[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> place(const Mask& mask) const {
    if (mask.width > cells_ || mask.height > cells_) return std::nullopt;
    std::size_t bestY = cells_ - mask.height + 1, bestX = 0;
    // Rows that are far apart first: they find out sooner that a place is taken.
    std::vector<std::size_t> rows;
    for (std::size_t step = 32; step > 0; step /= 2)
      for (std::size_t row = 0; row < mask.height; row += step)
        if (step == 32 || row % (2 * step) != 0) rows.push_back(row);
    std::vector<std::uint64_t> shifted(mask.bits.size());
    for (std::size_t x = 0; x + mask.width <= cells_; ++x) {
      const std::size_t shift = x % kWord;
      for (std::size_t i = 0; i < shifted.size(); ++i)
        shifted[i] = shift == 0
                         ? mask.bits[i]
                         : mask.bits[i] << shift | (i % mask.words == 0 ? 0 : mask.bits[i - 1] >> (kWord - shift));
      for (std::size_t y = 0; y < bestY; ++y)
        if (isFree(mask.words, rows, shifted.data(), taken_.bits.data() + y * taken_.words + x / kWord)) {
          bestY = y;
          bestX = x;
        }
    }
    if (bestY + mask.height > cells_) return std::nullopt;
    return std::pair{bestX, bestY};
  }

  void take(const Mask& mask, std::size_t x, std::size_t y) {
    for (std::size_t row = 0; row < mask.height; ++row)
      for (std::size_t column = 0; column < mask.width; ++column) {
        if ((mask.bits[row * mask.words + column / kWord] >> (column % kWord) & 1) == 0) continue;
        const std::size_t cx = x + column, cy = y + row;
        for (std::size_t ny = cy == 0 ? 0 : cy - 1; ny <= std::min(cy + 1, cells_ - 1); ++ny)
          for (std::size_t nx = cx == 0 ? 0 : cx - 1; nx <= std::min(cx + 1, cells_ - 1); ++nx) taken_.set(nx, ny);
      }
  }

 private:
  /// @param mask  Its bits; `rows` are those to look at.
  /// @param taken  The word of the square that the mask's first word is laid on.
  [[nodiscard]] bool isFree(std::size_t words, const std::vector<std::size_t>& rows, const std::uint64_t* mask,
                            const std::uint64_t* taken) const {
    for (const std::size_t row : rows)
      for (std::size_t i = 0; i < words; ++i)
        if ((mask[row * words + i] & taken[row * taken_.words + i]) != 0) return false;
    return true;
  }

  std::size_t cells_;
  Mask taken_;
};

using Places = std::vector<Uv>;  ///< Of the lower left corners, in cells.

std::optional<Places> placeMasks(const std::vector<Chart>& charts, const std::vector<UvBox>& boxes,
                                 const std::vector<std::size_t>& order, std::pair<double, std::size_t> scaleAndCells) {
  const auto [scale, cells] = scaleAndCells;
  Square square(cells);
  Places places(charts.size());
  for (const std::size_t i : order) {
    const Mask mask = maskOf(charts[i], boxes[i], scale);
    const auto place = square.place(mask);
    if (!place) return std::nullopt;
    square.take(mask, place->first, place->second);
    places[i] = {static_cast<double>(place->first), static_cast<double>(place->second)};
  }
  return places;
}

/// Rows of boxes, the highest first.
std::optional<Places> placeBoxes(const std::vector<UvBox>& boxes, const std::vector<std::size_t>& order, double scale,
                                 double cells) {
  Places places(boxes.size());
  double x = 0, y = 0, rowHeight = 0;
  for (const std::size_t i : order) {
    const double width = scale * boxes[i].side(0), height = scale * boxes[i].side(1);
    if (x > 0 && x + width > cells) {
      y += rowHeight + 1;
      x = rowHeight = 0;
    }
    rowHeight = std::max(rowHeight, height);
    if (width > cells || y + height > cells) return std::nullopt;
    places[i] = {x, y};
    x += width + 1;
  }
  return places;
}

}  // namespace

bool packCharts(double gutter, Ticker& ticker, std::vector<Chart>& charts) {
  if (charts.empty()) return true;
  std::vector<UvBox> boxes;
  double area = 0;
  for (const Chart& chart : charts) {
    boxes.push_back(chart.box());
    area += chart.area();
  }
  // Large charts first, by what makes them large: height (which rows of boxes need), area of the box, longest side.
  std::vector<std::vector<std::size_t>> orders;
  for (const auto& size : std::initializer_list<std::function<double(std::size_t)>>{
           [&](std::size_t i) { return boxes[i].side(1); },
           [&](std::size_t i) { return boxes[i].side(0) * boxes[i].side(1); },
           [&](std::size_t i) { return std::max(boxes[i].side(0), boxes[i].side(1)); },
           [&](std::size_t i) { return boxes[i].side(0); }}) {
    std::vector<std::size_t> order(charts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return size(x) > size(y); });
    orders.push_back(std::move(order));
  }
  // A cell is a gutter wide. Charts take whole cells and leave one free, and half a cell is left at the border.
  gutter = std::min(std::max(gutter, kMinGutter), 0.2 / std::sqrt(static_cast<double>(charts.size())));
  const auto cells = std::max(std::size_t{1}, static_cast<std::size_t>(1 / gutter) - 1);
  const auto side = static_cast<double>(cells);
  double scale = side * std::sqrt(kFirstCoverage / std::max(area, 1e-300));
  for (const UvBox& box : boxes)
    for (std::size_t k = 0; k < 2; ++k) scale = std::min(scale, 0.999 * side / std::max(box.side(k), 1e-300));
  std::optional<Places> places;
  const auto fits = [&](double size) {
    for (const std::vector<std::size_t>& order : orders) {
      if (!ticker.work(kWorkPerTry)) return false;
      auto found = charts.size() > kMaxMasks ? placeBoxes(boxes, order, size, side)
                                             : placeMasks(charts, boxes, order, {size, cells});
      if (!found) continue;
      places = std::move(found);
      scale = size;
      return true;
    }
    return false;
  };
  double tooLarge = scale;
  for (double size = scale; !fits(size); size *= kSmaller) {
    if (ticker.cancelled()) return false;
    tooLarge = size;
  }
  for (int i = 0; i < kRefinements; ++i) {
    const double middle = (scale + tooLarge) / 2;
    if (!fits(middle)) tooLarge = middle;
  }
  if (ticker.cancelled()) return false;
  const double cell = 1 / (side + 1);
  for (std::size_t i = 0; i < charts.size(); ++i)
    for (Uv& uv : charts[i].uvs)
      for (std::size_t k = 0; k < 2; ++k) uv[k] = cell * (0.5 + (*places)[i][k] + scale * (uv[k] - boxes[i].low[k]));
  return true;
}

}  // namespace cagecast::cages
