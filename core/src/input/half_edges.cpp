#include "input/half_edges.hpp"

#include <algorithm>
#include <utility>

#include "base/hash_index.hpp"

namespace cagecast {

bool findHalfEdges(const MeshView& mesh, const Cage& cage, Arena& arena, HalfEdges& out) noexcept {
  const std::uint32_t sideCount = 3 * cage.count;
  const auto vertexCount = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  auto* starts = arena.allocate<std::uint32_t>(sideCount);
  auto* next = arena.allocate<std::uint32_t>(sideCount);
  const Arena::Mark mark = arena.mark();
  auto* vertexOf = arena.allocate<std::uint32_t>(vertexCount);
  auto* edges = arena.allocate<std::uint64_t>(sideCount);
  auto* order = arena.allocate<std::uint32_t>(sideCount);
  HashIndex vertices(vertexCount, arena);
  HashIndex edgeTable(sideCount, arena);
  if (arena.failed()) return false;

  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const float* p = mesh.positions.data() + std::size_t{3} * v;
    const float site[3] = {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f};  // Now −0 is 0.
    vertexOf[v] = vertices.firstEqual(v, HashIndex::hash(site), [&](std::uint32_t other) {
      const float* o = mesh.positions.data() + std::size_t{3} * other;
      return o[0] == p[0] && o[1] == p[1] && o[2] == p[2];
    });
  }
  // The sides from a lower vertex to a higher one, and after them their opposites: most of the former are new to the
  // table, most of the latter known to it, so that neither has to be guessed.
  std::uint32_t first = 0, last = sideCount - 1;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const std::uint32_t* index = mesh.indices.data() + std::size_t{3} * cage.triangles[t].index;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t side = 3 * t + k;
      const std::uint64_t from = vertexOf[index[k]];
      const std::uint64_t to = vertexOf[index[(k + 1) % 3]];
      starts[side] = vertexOf[index[k]];
      next[side] = side;
      edges[side] = std::min(from, to) << 32 | std::max(from, to);
      order[first] = order[last] = side;
      const std::uint32_t isUp = from < to;
      first += isUp;
      last -= 1 - isUp;
    }
  }
  for (std::uint32_t i = 0; i < sideCount; ++i) {
    const std::uint32_t side = order[i];
    const std::uint64_t edge = edges[side];
    const std::uint32_t known =
        edgeTable.firstEqual(side, HashIndex::mix(0, edge), [&](std::uint32_t other) { return edges[other] == edge; });
    std::swap(next[side], next[known]);
  }
  out = {vertexCount, starts, next};
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
