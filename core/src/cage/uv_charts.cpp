#include "cage/uv_charts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/hash_index.hpp"
#include "base/union_find.hpp"

namespace cagecast {
namespace {

/// Both coordinates of a UV in one integer, equal for equal UVs.
using UvBits = std::uint64_t;

UvBits bitsOf(const float* uv) {
  const float normalized[2] = {uv[0] + 0.0f, uv[1] + 0.0f};  // −0 becomes 0.
  UvBits bits;
  std::memcpy(&bits, normalized, sizeof bits);
  return bits;
}

/// The greatest ratio of UV length to length among a triangle's edges.
double stretchOf(const CageTriangle& triangle) {
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  double squared = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t l = (k + 1) % 3;
    const double du = static_cast<double>(triangle.uvs[2 * l]) - static_cast<double>(triangle.uvs[2 * k]);
    const double dv = static_cast<double>(triangle.uvs[2 * l + 1]) - static_cast<double>(triangle.uvs[2 * k + 1]);
    const Vec3 edge = corners[l] - corners[k];
    squared = std::max(squared, (du * du + dv * dv) * (1 / dot(edge, edge)));
  }
  return std::sqrt(squared);
}

/// Links the half-edges that are one edge in UV.
/// @param uvs    1 per half-edge: the UV at its origin.
/// @param fans   For the edges of three or more triangles.
void linkHalfEdges(const HalfEdges& halfEdges, const UvBits* uvs, std::uint32_t count, HashIndex& fans,
                   std::uint32_t* nextHalfEdge) {
  const std::uint32_t* origins = halfEdges.origins;
  const auto isSameEdge = [=](std::uint32_t halfEdge, std::uint32_t other) {
    const std::uint32_t end = HalfEdges::after(halfEdge);
    std::uint32_t from = other, to = HalfEdges::after(other);
    if (origins[halfEdge] != origins[from]) std::swap(from, to);
    return origins[halfEdge] == origins[from] && origins[end] == origins[to] && uvs[halfEdge] == uvs[from] &&
           uvs[end] == uvs[to];
  };
  const auto hashOfOrigin = [=](std::uint32_t halfEdge) {
    return HashIndex::mix(HashIndex::mix(0, origins[halfEdge]), uvs[halfEdge]);
  };
  for (std::uint32_t halfEdge = 0; halfEdge < count; ++halfEdge) {
    std::uint32_t other = halfEdges.nextOfEdge[halfEdge];
    nextHalfEdge[halfEdge] = halfEdge;
    if (halfEdges.nextOfEdge[other] == halfEdge) {
      nextHalfEdge[halfEdge] = isSameEdge(halfEdge, other) ? other : halfEdge;
      continue;
    }
    // A hash table instead of comparing all pairs: hundreds of triangles may share one edge.
    other = fans.firstEqual(halfEdge, hashOfOrigin(halfEdge) + hashOfOrigin(HalfEdges::after(halfEdge)),
                            [&](std::uint32_t known) { return isSameEdge(halfEdge, known); });
    std::swap(nextHalfEdge[halfEdge], nextHalfEdge[other]);  // Swapping the successors of two rings joins them.
  }
}

}  // namespace

bool findUvCharts(const Cage& cage, const HalfEdges& halfEdges, Arena& arena, UvCharts& out) noexcept {
  const std::uint32_t halfEdgeCount = 3 * cage.count;
  out.nextHalfEdge = arena.allocate<std::uint32_t>(halfEdgeCount);
  out.neighbours = arena.allocate<ChartNeighbours>(cage.count);
  out.charts = arena.allocate<std::uint32_t>(cage.count);
  out.stretch = arena.allocate<double>(cage.count);
  const Arena::Scope scope(arena);
  auto* uvs = arena.allocate<UvBits>(halfEdgeCount);
  HashIndex fans(halfEdgeCount, arena);
  if (arena.failed()) return false;

  out.maxUv = 0;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const CageTriangle& triangle = cage.triangles[t];
    for (std::uint32_t k = 0; k < 3; ++k) uvs[3 * t + k] = bitsOf(triangle.uvs + 2 * k);
    out.stretch[t] = stretchOf(triangle);
    for (const float x : triangle.uvs) out.maxUv = std::max(out.maxUv, std::abs(x));
  }
  linkHalfEdges(halfEdges, uvs, halfEdgeCount, fans, out.nextHalfEdge);
  UnionFind sets(out.charts, cage.count);
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    ChartNeighbours& neighbours = out.neighbours[t];
    neighbours.hasFan = 0;
    std::uint32_t next[3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t halfEdge = 3 * t + k;
      const std::uint32_t other = out.nextHalfEdge[halfEdge];
      const bool isFan = out.nextHalfEdge[other] != halfEdge;
      next[k] = other / 3;
      neighbours.triangles[k] = isFan ? t : next[k];
      neighbours.hasFan |= unsigned{isFan};
    }
    sets.join({t, next[0], next[1], next[2]});
  }
  sets.flatten(cage.count);
  return true;
}

}  // namespace cagecast
