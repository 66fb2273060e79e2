#include <algorithm>
#include <cmath>
#include <utility>

#include "charts/steps.hpp"

namespace cagecast::cages {

namespace {

using Corners = std::array<Uv, 3>;

/// Whether a line along an edge of `a` has all of `b` on its outer side or on it.
bool separates(const Corners& a, const Corners& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    bool outer = true;
    for (const Uv& point : b) outer = outer && doubledArea(a[i], a[(i + 1) % 3], point) <= 0;
    if (outer) return true;
  }
  return false;
}

}  // namespace

std::uint32_t countOverlaps(const std::vector<Uv>& uvs, const std::vector<Triangle3>& triangles, std::uint32_t most) {
  std::vector<Corners> corners;
  std::vector<UvBox> boxes;
  UvBox all;
  for (const Triangle3& t : triangles) {
    Corners c{uvs[t[0]], uvs[t[1]], uvs[t[2]]};
    const double area = doubledArea(c[0], c[1], c[2]);
    if (area < 0) std::swap(c[1], c[2]);
    if (area == 0) continue;  // Has no inside.
    corners.push_back(c);
    boxes.emplace_back();
    for (const Uv& uv : c) {
      boxes.back().add(uv);
      all.add(uv);
    }
  }
  if (corners.empty()) return 0;
  const auto cells = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(corners.size()))));
  const auto cellOf = [&](double value, std::size_t k) {
    const double share = (value - all.low[k]) / std::max(all.side(k), 1e-300);
    return std::clamp(static_cast<int>(share * cells), 0, cells - 1);
  };
  std::vector<std::vector<std::uint32_t>> grid(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  std::vector<std::uint32_t> testedWith(corners.size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    const UvBox& box = boxes[i];
    for (int y = cellOf(box.low[1], 1); y <= cellOf(box.high[1], 1); ++y)
      for (int x = cellOf(box.low[0], 0); x <= cellOf(box.high[0], 0); ++x) {
        auto& cell = grid[static_cast<std::size_t>(y) * static_cast<std::size_t>(cells) + static_cast<std::size_t>(x)];
        for (const std::uint32_t k : cell) {
          if (testedWith[k] == i) continue;
          testedWith[k] = i;
          if (!box.meets(boxes[k]) || separates(corners[i], corners[k]) || separates(corners[k], corners[i])) continue;
          if (++count >= most) return count;
        }
        cell.push_back(i);
      }
  }
  return count;
}

}  // namespace cagecast::cages
