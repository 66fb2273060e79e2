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
  IndexTable sites(vertexCount, scratch);
  IndexTable edgeTable(sideCount, scratch);
  if (scratch.failed()) return false;

  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const Site site = Site::of(mesh, v);
    siteOf[v] = sites.firstEqual(v, IndexTable::hash(site), [&](std::uint32_t other) { return Site::of(mesh, other) == site; });
  }
  out.mostUv = 0;
  UnionFind sets(out.islands, cage.count);
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const CageTriangle& triangle = cage.triangles[t];
    const std::uint32_t* index = mesh.indices.data() + std::size_t{3} * triangle.index;
    const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
    double stretch = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3;
      const std::uint32_t side = 3 * t + k;
      const std::uint64_t low = std::min(siteOf[index[k]], siteOf[index[l]]);
      const std::uint64_t edge = low << 32 | std::max(siteOf[index[k]], siteOf[index[l]]);
      edges[side] = edge;
      const std::uint32_t first =
          edgeTable.firstEqual(side, IndexTable::mix(0, edge), [&](std::uint32_t other) { return edges[other] == edge; });
      out.nextSide[side] = side;
      std::swap(out.nextSide[side], out.nextSide[first]);
      sets.join(t, first / 3);

      const double du = static_cast<double>(triangle.uvs[2 * l]) - static_cast<double>(triangle.uvs[2 * k]);
      const double dv = static_cast<double>(triangle.uvs[2 * l + 1]) - static_cast<double>(triangle.uvs[2 * k + 1]);
      const Vec3 along = corners[l] - corners[k];
      stretch = std::max(stretch, (du * du + dv * dv) * (1 / dot(along, along)));
    }
    out.stretch[t] = std::sqrt(stretch);
    for (const float x : triangle.uvs) out.mostUv = std::max(out.mostUv, std::abs(x));
  }
  sets.flatten(cage.count);
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
