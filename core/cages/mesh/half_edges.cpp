#include "mesh/half_edges.hpp"

#include <algorithm>
#include <utility>

namespace cagecast::cages {

std::vector<std::uint32_t> halfEdgeTwins(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h)
    edges.emplace_back(edgeKey(originOf(mesh, h), endOf(mesh, h)), h);
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> twins(edges.size(), kNone);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i + 1; end < edges.size() && edges[end].first == edges[i].first;) ++end;
    if (end != i + 2) continue;
    const std::uint32_t one = edges[i].second, other = edges[i + 1].second;
    if (originOf(mesh, one) == originOf(mesh, other) || one / 3 == other / 3) continue;
    twins[one] = other;
    twins[other] = one;
  }
  return twins;
}

}  // namespace cagecast::cages
