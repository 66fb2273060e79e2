#include "charts/steps.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "charts/min_cut.hpp"
#include "mesh/disjoint_sets.hpp"

namespace cagecast::cages {

namespace {

/// Vertices that mean distances are taken to.
constexpr std::size_t kThicknessSamples = 48;
/// Peaks lower than this share of the whole range of mean distances are no limbs.
constexpr double kMinPeak = 0.14;
/// The loop that cuts off a limb may lie this far up the limb, as a share of its length, …
constexpr double kLoopUp = 0.35;
/// … and this far down the trunk.
constexpr double kLoopDown = 0.25;
/// Best is this height: limbs end in the trunk rather than where they become free of it.
constexpr double kLoopHeight = -0.08;
/// Loops cost so much more at the limits than at this height.
constexpr double kDrift = 4;

/// The mean distance of each vertex to all others, by area.
std::vector<double> meanDistances(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.positions.size());
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) areas[v] += length(areaNormal(mesh, t));
  // Samples are as far from each other as can be; each stands for the vertices that are nearest to it.
  std::vector<std::vector<double>> distances;
  std::vector<double> nearest(mesh.positions.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> sampleOf(mesh.positions.size());
  std::uint32_t at = 0;
  for (std::size_t i = 0; i < std::min(kThicknessSamples, mesh.positions.size()); ++i) {
    distances.push_back(edgeDistances(mesh, {&at, 1}, {}).distance);
    for (std::uint32_t v = 0; v < nearest.size(); ++v)
      if (distances[i][v] < nearest[v]) {
        nearest[v] = distances[i][v];
        sampleOf[v] = i;
      }
    at = static_cast<std::uint32_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  std::vector<double> weights(distances.size()), mean(mesh.positions.size());
  double whole = 0;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    weights[sampleOf[v]] += areas[v];
    whole += areas[v];
  }
  for (std::size_t i = 0; i < distances.size(); ++i)
    for (std::size_t v = 0; v < mean.size(); ++v) mean[v] += weights[i] / std::max(whole, 1e-300) * distances[i][v];
  return mean;
}

struct Peak {
  std::uint32_t tip = 0;
  double height = 0;  ///< Above the level at which the region runs into another.
  double level = 0;
  std::vector<std::uint32_t> region;
};

/// The peaks of a function on the vertices that are at least so high, and their regions.
std::vector<Peak> peaksOf(const TriangleMesh& mesh, const std::vector<double>& value, double least) {
  struct Region {
    std::uint32_t tip = 0;
    bool trunk = false;  ///< Two peaks have met in it.
    std::vector<std::uint32_t> members;
  };
  // Not `Neighbours`: where regions meet, the order of the half-edges decides which is joined first.
  std::vector<std::vector<std::uint32_t>> neighbours(mesh.positions.size());
  for (std::uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    neighbours[originOf(mesh, h)].push_back(endOf(mesh, h));
    neighbours[endOf(mesh, h)].push_back(originOf(mesh, h));
  }
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return value[a] > value[b]; });
  DisjointSets sets(mesh.positions.size());
  std::vector<Region> regions(mesh.positions.size());
  std::vector<bool> done(mesh.positions.size());
  std::vector<Peak> peaks;
  const auto record = [&](const Region& region, double level) {
    if (!region.trunk) peaks.push_back({region.tip, value[region.tip] - level, level, region.members});
  };
  for (const std::uint32_t v : order) {
    done[v] = true;
    regions[v] = {v, false, {v}};
    for (const std::uint32_t other : neighbours[v]) {
      if (!done[other] || sets.find(other) == sets.find(v)) continue;
      Region high = std::move(regions[sets.find(v)]), low = std::move(regions[sets.find(other)]);
      if (value[high.tip] < value[low.tip]) std::swap(high, low);
      if (value[low.tip] - value[v] >= least) {
        record(high, value[v]);
        record(low, value[v]);
        high.trunk = true;
      }
      high.trunk = high.trunk || low.trunk;
      high.members.insert(high.members.end(), low.members.begin(), low.members.end());
      sets.join(v, other);
      regions[sets.find(v)] = std::move(high);
    }
  }
  return peaks;
}

/// The triangles that the shortest loop near the end of a peak's region cuts off.
std::vector<bool> cutOff(const TriangleMesh& mesh, const std::vector<double>& value, const Peak& peak,
                         const std::vector<std::uint32_t>& labels) {
  std::vector<bool> inside(mesh.positions.size());
  for (const std::uint32_t v : peak.region) inside[v] = true;
  const std::vector<double> outside = edgeDistances(mesh, peak.region, {}).distance;
  // How far up the limb, as a share of its length; below 0 outside its region.
  const auto heightOf = [&](std::uint32_t v) {
    return (inside[v] ? value[v] - peak.level : -outside[v]) / peak.height;
  };
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  MinCut cut(mesh.triangles.size(), 1e-6 * diagonalOf(mesh));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle3& c = mesh.triangles[t];
    const double height = (heightOf(c[0]) + heightOf(c[1]) + heightOf(c[2])) / 3;
    if (height > kLoopUp) cut.addNode(t, MinCut::kForbidden, 0);
    if (height < -kLoopDown || labels[t] != 0) cut.addNode(t, 0, MinCut::kForbidden);
  }
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    if (twins[h] == kNone || twins[h] < h) continue;
    const std::uint32_t a = originOf(mesh, h), b = endOf(mesh, h);
    const double height = (heightOf(a) + heightOf(b)) / 2;
    const double away = height - kLoopHeight;
    const double drift = away > 0 ? away / (kLoopUp - kLoopHeight) : -away / (kLoopDown + kLoopHeight);
    cut.addEdge(h / 3, twins[h] / 3, (1 + kDrift * drift) * length(mesh.positions[a] - mesh.positions[b]));
  }
  return cut.solve();
}

}  // namespace

Limbs limbsOf(const TriangleMesh& mesh, std::size_t most) {
  Limbs limbs;
  limbs.labels.assign(mesh.triangles.size(), 0);
  const std::vector<double> value = meanDistances(mesh);
  const auto [low, high] = std::minmax_element(value.begin(), value.end());
  std::vector<Peak> peaks = peaksOf(mesh, value, kMinPeak * (*high - *low));
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.height > b.height; });
  if (peaks.size() > most) peaks.resize(most);
  for (const Peak& peak : peaks) {
    const std::vector<bool> off = cutOff(mesh, value, peak, limbs.labels);
    limbs.tips.push_back(peak.tip);
    for (std::size_t t = 0; t < off.size(); ++t)
      if (off[t]) limbs.labels[t] = static_cast<std::uint32_t>(limbs.tips.size());
  }
  return limbs;
}

}  // namespace cagecast::cages
