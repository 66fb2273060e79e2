#include <cmath>

#include "input/merge_near.hpp"
#include "steps/steps.hpp"

namespace cagecast {

bool projectToVertices(const MeshView& cageMesh, const Points& points, const Cage& cage, const Units& units,
                       Arena& arena, PointResults& results) noexcept {
  const auto allSites = static_cast<std::uint32_t>(cageMesh.positions.size() / 3);
  const Arena::Mark mark = arena.mark();
  auto* slotOfVertex = arena.allocate<std::uint32_t>(allSites);
  auto* vertexOfSite = arena.allocate<std::uint32_t>(allSites);
  auto* sites = arena.allocate<float>(Points::kStride * allSites);
  auto* nearest = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed()) return false;

  // Vertices that no triangle with an area uses have no place on the cage. The first triangle at a vertex stands for
  // it.
  std::fill(slotOfVertex, slotOfVertex + allSites, UINT32_MAX);
  for (std::uint32_t slot = cage.count; slot-- > 0;) {
    const std::uint32_t* index = cageMesh.indices.data() + std::size_t{3} * cage.triangles[slot].index;
    for (int i = 0; i < 3; ++i) slotOfVertex[index[i]] = slot;
  }
  std::uint32_t siteCount = 0;
  for (std::size_t v = 0; v < allSites; ++v) {
    if (slotOfVertex[v] == UINT32_MAX) continue;
    for (std::size_t k = 0; k < 3; ++k)
      sites[Points::kStride * siteCount + k] = cageMesh.positions[3 * v + k] * units.scale;
    sites[Points::kStride * siteCount + 3] = 0;
    vertexOfSite[siteCount++] = static_cast<std::uint32_t>(v);
  }

  const bool done = nearestSites(sites, siteCount, points.positions, points.count, nearest);
  for (std::uint32_t i = 0; done && i < points.count; ++i) {
    const std::uint32_t vertex = vertexOfSite[nearest[i]];
    const Vec3 offset = Vec3::from(points.at(i)) - Vec3::from(sites + Points::kStride * nearest[i]);
    for (std::uint32_t k = 0; k < 2; ++k) results.uvs[2 * i + k] = cageMesh.uvs[std::size_t{2} * vertex + k];
    results.distances[i] = static_cast<float>(length(offset));
    results.triangles[i] = slotOfVertex[vertex];
    results.zones[i] = Zone::cosmetic;
  }
  arena.rewind(mark);
  return done;
}

}  // namespace cagecast
