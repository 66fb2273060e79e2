#include "atlas.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "index_table.hpp"
#include "union_find.hpp"

namespace cagecast {
namespace {

/// A vertex of the cage as the texture knows it.
struct Site {
  float x, y, z, u, v;

  static Site of(const MeshView& mesh, std::size_t vertex) {
    const float* p = mesh.positions.data() + 3 * vertex;
    const float* uv = mesh.uvs.data() + 2 * vertex;
    return {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f, uv[0] + 0.0f, uv[1] + 0.0f};  // Now −0 is 0.
  }
  friend bool operator==(const Site& a, const Site& b) { return std::memcmp(&a, &b, sizeof(Site)) == 0; }
};

}  // namespace

bool findAtlas(const MeshView& mesh, const Cage& cage, Scratch& scratch, Atlas& out) noexcept {
  const std::size_t sideCount = std::size_t{3} * cage.count;
  out.nextSide = scratch.take<std::uint32_t>(sideCount);
  out.islands = scratch.take<std::uint32_t>(cage.count);
  out.stretch = scratch.take<double>(cage.count);
  const Scratch::Mark mark = scratch.mark();
  const std::size_t vertexCount = mesh.positions.size() / 3;
  auto* siteOf = scratch.take<std::uint32_t>(vertexCount);
  auto* edges = scratch.take<std::uint64_t>(sideCount);
  auto* order = scratch.take<std::uint32_t>(sideCount);
  IndexTable sites(vertexCount, scratch);
  IndexTable edgeTable(sideCount, scratch);
  if (scratch.failed()) return false;

  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const Site site = Site::of(mesh, v);
    siteOf[v] = sites.firstEqual(v, IndexTable::hash(site), [&](std::uint32_t other) { return Site::of(mesh, other) == site; });
  }
  // The sides from a lower vertex to a higher one, and after them their opposites: most of the former are new to the table, most of
  // the latter known to it, so that neither has to be guessed.
  std::size_t next = 0, last = sideCount - 1;
  out.mostUv = 0;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const CageTriangle& triangle = cage.triangles[t];
    const std::uint32_t* index = mesh.indices.data() + std::size_t{3} * triangle.index;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t side = 3 * t + k;
      const std::uint64_t from = siteOf[index[k]];
      const std::uint64_t to = siteOf[index[(k + 1) % 3]];
      edges[side] = std::min(from, to) << 32 | std::max(from, to);
      out.nextSide[side] = side;
      order[next] = order[last] = side;
      const std::size_t isUp = from < to;
      next += isUp;
      last -= 1 - isUp;
    }
    const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
    double stretch = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3;
      const double du = static_cast<double>(triangle.uvs[2 * l]) - static_cast<double>(triangle.uvs[2 * k]);
      const double dv = static_cast<double>(triangle.uvs[2 * l + 1]) - static_cast<double>(triangle.uvs[2 * k + 1]);
      const Vec3 along = corners[l] - corners[k];
      stretch = std::max(stretch, (du * du + dv * dv) * (1 / dot(along, along)));
    }
    out.stretch[t] = std::sqrt(stretch);
    for (const float x : triangle.uvs) out.mostUv = std::max(out.mostUv, std::abs(x));
  }
  UnionFind sets(out.islands, cage.count);
  for (std::size_t i = 0; i < sideCount; ++i) {
    const std::uint32_t side = order[i];
    const std::uint64_t edge = edges[side];
    const std::uint32_t first =
        edgeTable.firstEqual(side, IndexTable::mix(0, edge), [&](std::uint32_t other) { return edges[other] == edge; });
    std::swap(out.nextSide[side], out.nextSide[first]);
    sets.join(side / 3, first / 3, first / 3);
  }
  sets.flatten(cage.count);
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
