#include <algorithm>
#include <cstddef>

#include "input/merge_near.hpp"
#include "steps/project.hpp"

namespace cagecast {

void projectToVertices(const Scene& scene, PointData& data) noexcept {
  const MeshView& mesh = scene.cageMesh;
  const Points& points = data.points;
  const auto vertexCount = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  Arena& arena = scene.arena;
  const Arena::Scope scope(arena);
  auto* triangleOfVertex = arena.allocate<std::uint32_t>(vertexCount);
  auto* vertexOfSite = arena.allocate<std::uint32_t>(vertexCount);
  auto* sites = arena.allocate<float>(Points::kStride * vertexCount);
  auto* nearest = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed()) return;

  // Vertices that no triangle with an area uses are not part of the surface. The first triangle at a vertex stands for
  // it.
  constexpr std::uint32_t kNone = UINT32_MAX;
  std::fill(triangleOfVertex, triangleOfVertex + vertexCount, kNone);
  for (std::uint32_t t = scene.cage.count; t-- > 0;) {
    for (const std::uint32_t v : mesh.indices.subspan(std::size_t{3} * scene.cage.triangles[t].index, 3)) {
      triangleOfVertex[v] = t;
    }
  }
  std::uint32_t siteCount = 0;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    if (triangleOfVertex[v] == kNone) continue;
    float* const site = sites + Points::kStride * siteCount;
    for (std::size_t k = 0; k < 3; ++k) site[k] = mesh.positions[std::size_t{3} * v + k] * scene.units.scale;
    site[3] = 0;
    vertexOfSite[siteCount++] = v;
  }
  if (!nearestSites(sites, siteCount, points.positions, points.count, nearest)) return arena.fail();

  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::uint32_t vertex = vertexOfSite[nearest[i]];
    const Vec3 offset = Vec3::from(points.at(i)) - Vec3::from(sites + Points::kStride * nearest[i]);
    for (std::size_t k = 0; k < 2; ++k) {
      data.uvs[std::size_t{2} * i + k] = mesh.uvs[std::size_t{2} * vertex + k];
    }
    data.distances[i] = static_cast<float>(length(offset));
    data.cageTriangles[i] = triangleOfVertex[vertex];
    data.visibility[i] = Visibility::covered;
  }
}

}  // namespace cagecast
