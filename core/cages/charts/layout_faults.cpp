#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "charts/flatten.hpp"
#include "charts/slim.hpp"
#include "charts/unwrap.hpp"
#include "mesh/disjoint_sets.hpp"

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

struct Box {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double high[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(const Uv& uv) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], uv[k]);
      high[k] = std::max(high[k], uv[k]);
    }
  }
  [[nodiscard]] bool meets(const Box& other) const {
    return low[0] < other.high[0] && other.low[0] < high[0] && low[1] < other.high[1] && other.low[1] < high[1];
  }
};

/// The value below which a share of the weight lies.
double quantile(std::vector<std::pair<double, double>> valuesAndWeights, double share) {
  std::sort(valuesAndWeights.begin(), valuesAndWeights.end());
  double whole = 0, sum = 0;
  for (const auto& [value, weight] : valuesAndWeights) whole += weight;
  for (const auto& [value, weight] : valuesAndWeights) {
    sum += weight;
    if (sum >= share * whole) return value;
  }
  return 1;
}

std::uint32_t countCharts(const std::vector<Vec3>& positions, const std::vector<Uv>& uvs,
                          const std::vector<Triangle3>& triangles) {
  std::map<std::array<double, 5>, std::uint32_t> vertices;
  DisjointSets sets(positions.size());
  for (const Triangle3& t : triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
    for (const std::uint32_t v : t) {
      const Vec3& p = positions[v];
      sets.join(v, vertices.try_emplace({p.x, p.y, p.z, uvs[v][0], uvs[v][1]}, v).first->second);
    }
  }
  std::vector<bool> counted(positions.size());
  std::uint32_t charts = 0;
  for (const Triangle3& t : triangles) {
    const std::uint32_t set = sets.find(t[0]);
    if (!counted[set]) ++charts;
    counted[set] = true;
  }
  return charts;
}

}  // namespace

std::uint32_t countOverlaps(const std::vector<Uv>& uvs, const std::vector<Triangle3>& triangles, std::uint32_t most) {
  std::vector<Corners> corners;
  std::vector<Box> boxes;
  Box all;
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
    const double share = (value - all.low[k]) / std::max(all.high[k] - all.low[k], 1e-300);
    return std::clamp(static_cast<int>(share * cells), 0, cells - 1);
  };
  std::vector<std::vector<std::uint32_t>> grid(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  std::vector<std::uint32_t> testedWith(corners.size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    const Box& box = boxes[i];
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

LayoutFaults layoutFaults(const std::vector<Vec3>& positions, const std::vector<Uv>& uvs,
                          const std::vector<Triangle3>& triangles) {
  LayoutFaults faults;
  faults.charts = countCharts(positions, uvs, triangles);
  faults.overlaps = countOverlaps(uvs, triangles, kNone);
  for (const Uv& uv : uvs)
    if (!(uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1)) ++faults.outside;
  std::uint32_t left = 0, right = 0;
  double flat = 0, solid = 0;
  for (const Triangle3& t : triangles) {
    const double area = doubledArea(uvs[t[0]], uvs[t[1]], uvs[t[2]]);
    if (area > 0) ++left;
    if (area < 0) ++right;
    flat += std::abs(area) / 2;
    solid += length(cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]])) / 2;
  }
  faults.flips = static_cast<std::uint32_t>(triangles.size()) - std::max(left, right);
  faults.coverage = flat;
  std::vector<std::pair<double, double>> angles, areas;
  const double scale = flat / std::max(solid, 1e-300);
  for (const Triangle3& t : triangles) {
    const TriangleMesh one{{positions[t[0]], positions[t[1]], positions[t[2]]}, {{0, 1, 2}}};
    const double area = length(areaNormal(one, one.triangles[0])) / 2;
    if (!(area > 0)) continue;
    const Jacobian j = jacobianOf(restShapesOf(one).gradients[0], {0, 1, 2}, {uvs[t[0]], uvs[t[1]], uvs[t[2]]});
    const auto [longest, shortest] = j.singularValues();
    const double density = longest * shortest / scale;
    angles.emplace_back(shortest > 0 ? longest / shortest : 1e9, area);
    areas.emplace_back(density > 0 ? std::max(density, 1 / density) : 1e9, area);
  }
  faults.angleMedian = quantile(angles, 0.5);
  faults.angle95 = quantile(std::move(angles), 0.95);
  faults.areaMedian = quantile(areas, 0.5);
  faults.area95 = quantile(std::move(areas), 0.95);
  return faults;
}

}  // namespace cagecast::cages
