#include "charts/steps.hpp"

#include <algorithm>
#include <array>

#include "charts/min_cut.hpp"
#include "charts/shortest_ways.hpp"
#include "mesh/disjoint_sets.hpp"

namespace cagecast::cages {

namespace {

/// A border between sides costs as much as facing wrong by 1 (0 right, 1 square to it) on a strip this share of the
/// size of the mesh wide.
constexpr double kBorderWidth = 0.06;
constexpr int kSegmentSweeps = 4;
constexpr double kMinSide = 0.04;
constexpr std::size_t kMaxSides = 8;
/// Joining two regions looks at each triangle so briefly that this many count as one in the ticker's work.
constexpr std::size_t kTrianglesPerWork = 200;

double edgeLength(const TriangleMesh& mesh, std::size_t h) {
  return length(mesh.positions[endOf(mesh, h)] - mesh.positions[originOf(mesh, h)]);
}

/// The triangle that is furthest from a triangle, by ways from centre to centre.
std::vector<double> distancesFrom(const TriangleMesh& mesh, const std::vector<std::uint32_t>& twins,
                                  std::uint32_t start) {
  std::vector<double> distance(mesh.triangles.size(), kUnreached);
  distance[start] = 0;
  findShortestWays({&start, 1}, distance, [&](std::uint32_t t, const auto& offer) {
    for (std::size_t h = 3 * t; h < 3 * t + 3; ++h)
      if (twins[h] != kNone)
        offer(twins[h] / 3, length(centroid(mesh, mesh.triangles[t]) - centroid(mesh, mesh.triangles[twins[h] / 3])));
  });
  return distance;
}

using Prices = std::vector<std::array<double, 6>>;

/// Gives a label to those triangles where that makes prices and borders cheapest (alpha expansion: Boykov, Veksler,
/// Zabih 2001).
/// @return whether a label changed.
bool expand(const TriangleMesh& mesh, const std::vector<std::uint32_t>& twins, const Prices& price, std::uint32_t label,
            std::vector<std::uint32_t>& labels) {
  const double border = kBorderWidth * diagonalOf(mesh);
  // The first side takes the label: it is the smaller one where that is all the same.
  std::vector<std::array<double, 2>> own(labels.size());
  for (std::size_t t = 0; t < labels.size(); ++t) own[t] = {price[t][labels[t]], price[t][label]};
  MinCut cut(labels.size(), 1e-6 * border * border);
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    if (twins[h] == kNone || twins[h] < h) continue;
    const std::uint32_t a = h / 3, b = twins[h] / 3;
    const double size = border * edgeLength(mesh, h);
    const double keepBoth = labels[a] != labels[b] ? size : 0, keepA = labels[a] != label ? size : 0,
                 keepB = labels[b] != label ? size : 0;
    // keepBoth if both stay, keepA if only b takes the label, keepB if only a does, 0 if both do.
    own[a][0] += keepA;
    own[b][0] += keepBoth - keepA;
    cut.addEdge(a, b, keepA + keepB - keepBoth, 0);
  }
  for (std::uint32_t t = 0; t < labels.size(); ++t) {
    const double least = std::min(own[t][0], own[t][1]);
    cut.addNode(t, own[t][1] - least, own[t][0] - least);
  }
  const std::vector<bool> stays = cut.solve();
  bool changed = false;
  for (std::size_t t = 0; t < labels.size(); ++t) {
    if (stays[t] || labels[t] == label) continue;
    labels[t] = label;
    changed = true;
  }
  return changed;
}

}  // namespace

std::vector<std::uint32_t> regionsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& labels) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  DisjointSets sets(mesh.triangles.size());
  for (std::size_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && labels[h / 3] == labels[twins[h] / 3])
      sets.join(static_cast<std::uint32_t>(h / 3), twins[h] / 3);
  std::uint32_t count = 0;
  return sets.numbers(count);
}

void joinSmallRegions(const TriangleMesh& mesh, double least, std::size_t most, Ticker& ticker,
                      std::vector<std::uint32_t>& regions) {
  /// A half-edge between two regions.
  struct Border {
    std::uint32_t triangle, neighbour;
    double length;
  };
  std::vector<Border> borders;
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && regions[h / 3] != regions[twins[h] / 3])
      borders.push_back({h / 3, twins[h] / 3, edgeLength(mesh, h)});
  std::vector<double> area(regions.size());
  double whole = 0;
  for (std::size_t t = 0; t < regions.size(); ++t) whole += area[t] = length(areaNormal(mesh, mesh.triangles[t]));
  std::size_t count = regions.empty() ? 0 : *std::max_element(regions.begin(), regions.end()) + 1;
  std::vector<double> areas(count, 0), lengths(count);
  for (std::size_t t = 0; t < regions.size(); ++t) areas[regions[t]] += area[t];
  for (; ticker.work(regions.size() / kTrianglesPerWork); --count) {
    // The smallest region that has a neighbour; of equal ones the first.
    std::uint32_t smallest = kNone;
    for (const Border& border : borders) {
      const std::uint32_t region = regions[border.triangle];
      if (smallest == kNone || areas[region] < areas[smallest] ||
          (areas[region] == areas[smallest] && region < smallest))
        smallest = region;
    }
    if (smallest == kNone || (areas[smallest] >= least * whole && count <= most)) return;
    std::fill(lengths.begin(), lengths.end(), -1);
    for (const Border& border : borders) {
      double& sum = lengths[regions[border.neighbour]];
      if (regions[border.triangle] == smallest) sum = std::max(sum, 0.0) + border.length;
    }
    const auto longest = std::max_element(lengths.begin(), lengths.end());
    const auto neighbour = static_cast<std::uint32_t>(longest - lengths.begin());
    // Added up anew, in the order of the triangles: rounding must not depend on how regions were joined.
    areas[neighbour] = 0;
    for (std::size_t t = 0; t < regions.size(); ++t) {
      if (regions[t] == smallest) regions[t] = neighbour;
      if (regions[t] == neighbour) areas[neighbour] += area[t];
    }
    std::erase_if(borders, [&](const Border& border) { return regions[border.triangle] == regions[border.neighbour]; });
  }
}

std::vector<std::uint32_t> sidesOf(const Piece& piece, const UnwrapOptions& options, Ticker& ticker) {
  const TriangleMesh& mesh = piece.mesh;
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  const Vec3 side = cross(options.up, options.front);
  const std::array<Vec3, 3> axes{side, options.up, options.front};
  Prices price(mesh.triangles.size());
  std::vector<std::uint32_t> labels(mesh.triangles.size());
  for (std::size_t t = 0; t < labels.size(); ++t) {
    const Vec3 n = areaNormal(mesh, mesh.triangles[t]);
    const double area = length(n);
    for (std::size_t k = 0; k < 6; ++k) price[t][k] = area - (k % 2 == 0 ? 1 : -1) * dot(n, axes[k / 2]);
    labels[t] = static_cast<std::uint32_t>(std::min_element(price[t].begin(), price[t].end()) - price[t].begin());
  }
  for (int sweep = 0; sweep < kSegmentSweeps; ++sweep) {
    bool changed = false;
    for (std::uint32_t label = 0; label < 6 && ticker.work(labels.size()); ++label)
      changed = expand(mesh, twins, price, label, labels) || changed;
    if (!changed) break;
  }
  std::vector<std::uint32_t> regions = regionsOf(mesh, labels);
  joinSmallRegions(mesh, kMinSide, kMaxSides, ticker, regions);
  return regions;
}

std::vector<std::uint32_t> frontAndBackOf(const TriangleMesh& mesh, const Vec3& front, Ticker& ticker) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  const double border = kBorderWidth * diagonalOf(mesh);
  MinCut cut(mesh.triangles.size(), 1e-6 * border * border);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 n = areaNormal(mesh, mesh.triangles[t]);
    const double area = length(n), ahead = dot(n, front);
    cut.addNode(t, area - ahead, area + ahead);
  }
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && twins[h] > h) cut.addEdge(h / 3, twins[h] / 3, border * edgeLength(mesh, h));
  const std::vector<bool> back = cut.solve();
  std::vector<std::uint32_t> regions = regionsOf(mesh, {back.begin(), back.end()});
  joinSmallRegions(mesh, kMinSide, 2, ticker, regions);
  return regions;
}

std::vector<std::uint32_t> halvesOf(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  const auto furthest = [](const std::vector<double>& distances) {
    return static_cast<std::uint32_t>(std::max_element(distances.begin(), distances.end()) - distances.begin());
  };
  const std::uint32_t one = furthest(distancesFrom(mesh, twins, 0));
  const std::vector<double> fromOne = distancesFrom(mesh, twins, one);
  // Two triangles at the same place are no distance apart.
  const std::uint32_t found = furthest(fromOne), other = found != one ? found : (one == 0 ? 1u : 0u);
  const std::vector<double> fromOther = distancesFrom(mesh, twins, other);
  std::vector<std::uint32_t> labels(mesh.triangles.size());
  for (std::uint32_t t = 0; t < labels.size(); ++t)
    labels[t] = t != one && (t == other || fromOther[t] < fromOne[t]) ? 1 : 0;
  return regionsOf(mesh, labels);
}

}  // namespace cagecast::cages
