#include "charts/steps.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace cagecast::cages {

namespace {

/// How many pairs of charts are tried at most: each try takes milliseconds.
constexpr int kMaxTries = 40;

/// Cosine by which a chart faces along an axis, on the mean.
constexpr double kFacing = 0.55;

struct Seams {
  std::vector<std::uint32_t> chartOf;  ///< Per triangle of the mesh.
  std::vector<bool> inside;            ///< Per half-edge: a seam within a chart.
};

Seams seamsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& twins, const std::vector<Chart>& charts) {
  Seams seams{std::vector<std::uint32_t>(mesh.triangles.size(), kNone), std::vector<bool>(twins.size())};
  std::vector<std::uint32_t> vertexOf(twins.size(), kNone);
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    const Piece& piece = charts[c].piece;
    for (std::size_t t = 0; t < piece.triangleOf.size(); ++t) {
      seams.chartOf[piece.triangleOf[t]] = c;
      for (std::size_t i = 0; i < 3; ++i) vertexOf[3 * piece.triangleOf[t] + i] = piece.mesh.triangles[t][i];
    }
  }
  for (std::size_t h = 0; h < twins.size(); ++h) {
    const std::uint32_t twin = twins[h];
    if (twin == kNone || seams.chartOf[h / 3] != seams.chartOf[twin / 3]) continue;
    seams.inside[h] = vertexOf[h] != vertexOf[nextInTriangle(twin)] || vertexOf[nextInTriangle(h)] != vertexOf[twin];
  }
  return seams;
}

/// Two charts as one piece, without the seam between them.
std::vector<Piece> joined(const TriangleMesh& mesh, const Seams& seams, std::uint32_t a, std::uint32_t b) {
  const auto isIn = [&](std::size_t t) { return seams.chartOf[t] == a || seams.chartOf[t] == b; };
  std::vector<bool> cut;
  for (std::uint32_t h = 0; h < seams.inside.size(); ++h)
    if (isIn(h / 3)) cut.push_back(seams.inside[h]);
  return componentsOf(cutOpen(partOf(wholeOf(mesh), isIn), cut));
}

/// -1 or 1 if a chart faces mainly along an axis, 0 if it does not.
int facing(const Chart& chart, const Vec3& axis) {
  double sum = 0, whole = 0;
  for (const Triangle3& t : chart.piece.mesh.triangles) {
    const Vec3 n = areaNormal(chart.piece.mesh, t);
    sum += dot(n, axis);
    whole += length(n);
  }
  return sum > kFacing * whole ? 1 : sum < -kFacing * whole ? -1 : 0;
}

bool fits(const Chart& chart, const MergeOptions& options) {
  if (!chart.valid || chart.energy > options.mostEnergy) return false;
  const UvBox box = chart.box();
  return chart.area() >= options.leastFill * box.side(0) * box.side(1) &&
         std::max(box.side(0), box.side(1)) <= options.longest;
}

}  // namespace

void mergeCharts(const TriangleMesh& mesh, const MergeOptions& options, Ticker& ticker, std::vector<Chart>& charts) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  std::set<std::pair<std::uint32_t, std::uint32_t>> failed;  // By first triangles.
  for (int tries = 0; charts.size() > options.enough;) {
    const Seams seams = seamsOf(mesh, twins, charts);
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> borders;
    std::vector<double> around(charts.size());
    for (std::uint32_t h = 0; h < twins.size(); ++h) {
      const double size = lengthOf(mesh, {&h, 1});
      const std::uint32_t a = seams.chartOf[h / 3], b = twins[h] != kNone ? seams.chartOf[twins[h] / 3] : kNone;
      if (a == b) continue;
      around[a] += size;
      if (a < b && b != kNone) borders[{a, b}] += size;
    }
    std::vector<std::pair<double, std::pair<std::uint32_t, std::uint32_t>>> order;
    order.reserve(borders.size());
    for (const auto& [pair, size] : borders)
      order.emplace_back(-size / std::max(1e-300, std::min(around[pair.first], around[pair.second])), pair);
    std::sort(order.begin(), order.end());
    bool merged = false;
    for (const auto& [share, pair] : order) {
      const auto [a, b] = pair;
      const std::pair key{charts[a].piece.triangleOf[0], charts[b].piece.triangleOf[0]};
      if (failed.contains(key) || facing(charts[a], options.axis) != facing(charts[b], options.axis)) continue;
      if (++tries > kMaxTries || ticker.cancelled()) return;
      std::vector<Piece> pieces = joined(mesh, seams, a, b);
      if (pieces.size() == 1) {
        Chart chart = flatten(cutToDisk(std::move(pieces[0]), {}), ticker);
        if (fits(chart, options)) {
          charts[a] = std::move(chart);
          charts.erase(charts.begin() + static_cast<std::ptrdiff_t>(b));
          merged = true;
          break;
        }
      }
      failed.insert(key);
    }
    if (!merged) return;
  }
}

}  // namespace cagecast::cages
