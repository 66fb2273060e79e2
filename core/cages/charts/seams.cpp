#include "charts/steps.hpp"

#include <algorithm>
#include <utility>

#include "charts/shortest_ways.hpp"
#include "mesh/disjoint_sets.hpp"

namespace cagecast::cages {

namespace {

/// Holes longer than this share of the longest boundary loop are joined with it by a seam.
constexpr double kLargestHole = 0.45;

std::uint32_t furthest(const EdgeDistances& from) {
  std::uint32_t best = 0;
  double most = -1;
  for (std::uint32_t v = 0; v < from.distance.size(); ++v)
    if (from.distance[v] < kUnreached && from.distance[v] > most) most = from.distance[best = v];
  return best;
}

/// A closed surface is opened between two places that are far apart.
Piece open(const Piece& piece, const SeamCost& cost) {
  const std::uint32_t any = 0;
  const std::uint32_t one = furthest(edgeDistances(piece.mesh, {&any, 1}, {}));
  const std::uint32_t other = furthest(edgeDistances(piece.mesh, {&one, 1}, {}));
  return cutBetween(piece, {&one, 1}, {&other, 1}, cost);
}

long eulerNumber(const TriangleMesh& mesh, std::span<const std::uint32_t> twins) {
  long halves = 0;
  for (const std::uint32_t twin : twins) halves += twin == kNone ? 2 : 1;
  return static_cast<long>(mesh.positions.size()) - halves / 2 + static_cast<long>(mesh.triangles.size());
}

/// Cuts what a tree of triangles and then a tree of edges leave over, which are the handles (tree and cotree), and the
/// ways from them to the boundary.
Piece cutHandles(const Piece& piece, const SeamCost& cost) {
  const TriangleMesh& mesh = piece.mesh;
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  std::vector<std::pair<double, std::uint32_t>> order;
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && twins[h] > h) {
      const std::uint32_t a = originOf(mesh, h), b = endOf(mesh, h);
      order.emplace_back(-(cost ? cost(mesh, a, b) : 1) * length(mesh.positions[a] - mesh.positions[b]), h);
    }
  std::sort(order.begin(), order.end());
  // Triangles are joined across the edges where a seam would cost most; the others are the first cut.
  DisjointSets joined(mesh.triangles.size());
  std::vector<bool> cut(twins.size());
  std::vector<std::uint32_t> uses(mesh.positions.size());
  const auto use = [&](std::uint32_t h, std::uint32_t by) {
    uses[originOf(mesh, h)] += by;
    uses[endOf(mesh, h)] += by;
  };
  for (const auto& [price, h] : order) {
    if (joined.find(h / 3) != joined.find(twins[h] / 3)) {
      joined.join(h / 3, twins[h] / 3);
    } else {
      cut[h] = true;
      use(h, 1);
    }
  }
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] == kNone) use(h, 1);
  // Ends that lead nowhere are not cut.
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t h = 0; h < twins.size(); ++h) {
      if (!cut[h] || (uses[originOf(mesh, h)] > 1 && uses[endOf(mesh, h)] > 1)) continue;
      cut[h] = false;
      use(h, ~0u);
      changed = true;
    }
  }
  return cutOpen(piece, cut);
}

}  // namespace

EdgeDistances edgeDistances(const TriangleMesh& mesh, std::span<const std::uint32_t> starts, const SeamCost& cost) {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> leaving(mesh.positions.size());
  for (std::uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    leaving[originOf(mesh, h)].emplace_back(endOf(mesh, h), h);
    leaving[endOf(mesh, h)].emplace_back(originOf(mesh, h), h);
  }
  EdgeDistances out;
  out.distance.assign(mesh.positions.size(), kUnreached);
  out.cameBy.assign(mesh.positions.size(), kNone);
  for (const std::uint32_t v : starts) out.distance[v] = 0;
  findShortestWays(starts, out.distance, [&](std::uint32_t v, const auto& offer) {
    for (const auto& [to, h] : leaving[v]) {
      const double size = length(mesh.positions[to] - mesh.positions[v]);
      if (offer(to, size * (cost ? cost(mesh, v, to) : 1))) out.cameBy[to] = h;
    }
  });
  return out;
}

Piece cutBetween(const Piece& piece, std::span<const std::uint32_t> starts, std::span<const std::uint32_t> ends,
                 const SeamCost& cost) {
  const EdgeDistances ways = edgeDistances(piece.mesh, starts, cost);
  std::uint32_t at = kNone;
  for (const std::uint32_t v : ends)
    if (at == kNone || ways.distance[v] < ways.distance[at]) at = v;
  std::vector<bool> cut(3 * piece.mesh.triangles.size());
  while (at != kNone && ways.cameBy[at] != kNone) {
    const std::uint32_t h = ways.cameBy[at];
    cut[h] = true;
    at = originOf(piece.mesh, h) == at ? endOf(piece.mesh, h) : originOf(piece.mesh, h);
  }
  return cutOpen(piece, cut);
}

Piece cutToDisk(Piece piece, const SeamCost& cost) {
  if (loopsOf(piece.mesh, halfEdgeTwins(piece.mesh)).empty()) piece = open(piece, cost);
  const std::vector<std::uint32_t> twins = halfEdgeTwins(piece.mesh);
  const auto loops = loopsOf(piece.mesh, twins);
  if (!loops.empty() && eulerNumber(piece.mesh, twins) + static_cast<long>(loops.size()) != 2)
    return cutHandles(piece, cost);
  if (loops.size() < 2) return piece;
  // Each cut changes the vertices, so loops are found anew.
  const double least = kLargestHole * lengthOf(piece.mesh, loops[0]);
  for (std::size_t i = 1; i < loops.size(); ++i) {
    const auto now = loopsOf(piece.mesh, halfEdgeTwins(piece.mesh));
    if (now.size() < 2 || lengthOf(piece.mesh, now[1]) <= least) break;
    piece = cutBetween(piece, originsOf(piece.mesh, now[1]), originsOf(piece.mesh, now[0]), cost);
  }
  return piece;
}

}  // namespace cagecast::cages
