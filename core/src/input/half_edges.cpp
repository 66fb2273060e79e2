#include "input/half_edges.hpp"

#include <algorithm>
#include <utility>

#include "base/hash_index.hpp"
#include "input/equal_positions.hpp"

namespace cagecast {

bool findHalfEdges(const MeshView& mesh, const Cage& cage, Arena& arena, HalfEdges& out) noexcept {
  const std::uint32_t halfEdgeCount = 3 * cage.count;
  const auto vertexCount = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  auto* origins = arena.allocate<std::uint32_t>(halfEdgeCount);
  auto* next = arena.allocate<std::uint32_t>(halfEdgeCount);
  const Arena::Scope scope(arena);
  auto* vertexOf = arena.allocate<std::uint32_t>(vertexCount);
  auto* edges = arena.allocate<std::uint64_t>(halfEdgeCount);
  auto* order = arena.allocate<std::uint32_t>(halfEdgeCount);
  HashIndex vertices(vertexCount, arena);
  HashIndex edgeTable(halfEdgeCount, arena);
  if (arena.failed()) return false;

  findFirstAtPosition(mesh.positions, vertices, vertexOf);
  // In `order`, half-edges from a lower vertex to a higher one come first. Most of these are new to the table below and
  // most of the others are known to it, so the processor predicts its branches.
  std::uint32_t first = 0, last = halfEdgeCount - 1;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const std::uint32_t* index = mesh.indices.data() + std::size_t{3} * cage.triangles[t].index;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t halfEdge = 3 * t + k;
      const std::uint64_t from = vertexOf[index[k]];
      const std::uint64_t to = vertexOf[index[(k + 1) % 3]];
      origins[halfEdge] = vertexOf[index[k]];
      next[halfEdge] = halfEdge;
      edges[halfEdge] = std::min(from, to) << 32 | std::max(from, to);
      order[first] = order[last] = halfEdge;
      const std::uint32_t isUp = from < to;
      first += isUp;
      last -= 1 - isUp;
    }
  }
  for (std::uint32_t i = 0; i < halfEdgeCount; ++i) {
    const std::uint32_t halfEdge = order[i];
    const std::uint64_t edge = edges[halfEdge];
    const std::uint32_t known = edgeTable.firstEqual(halfEdge, HashIndex::mix(0, edge),
                                                     [&](std::uint32_t other) { return edges[other] == edge; });
    std::swap(next[halfEdge], next[known]);  // Swapping the successors of two rings joins them.
  }
  out = {vertexCount, origins, next};
  return true;
}

}  // namespace cagecast
