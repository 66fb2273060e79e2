#include "reference/scene.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace cagecast::reference {
namespace {

// Shares of the diagonal.
constexpr double kNearestTie = 1e-6;  // Triangles this much farther than the nearest count as equally near.
constexpr double kPlaneTie = 1e-7;    // Planes this much nearer than the farthest count as equally far.
constexpr double kOnRim = 1e-6;       // A place this near an open edge is on it.

using Position = std::tuple<double, double, double>;
Position key(Vec p) { return {p.x, p.y, p.z}; }  // As a key of a map, -0 equals 0.

Points weld(const MeshView& target, double tolerance) {
  const std::uint32_t count = static_cast<std::uint32_t>(target.positions.size() / 3);
  const auto group = [&](std::uint32_t v) { return !target.groups.empty() ? target.groups[v] : 0u; };
  Sets sets(count);
  std::map<std::pair<std::uint32_t, Position>, std::uint32_t> known;
  for (std::uint32_t v = 0; v < count; ++v)
    sets.join(v, known.try_emplace({group(v), key(vertex(target, v))}, v).first->second);
  if (tolerance > 0) {
    for (std::uint32_t v = 0; v < count; ++v)
      for (std::uint32_t w = 0; w < v; ++w)
        if (group(v) == group(w) && length(vertex(target, v) - vertex(target, w)) < tolerance) sets.join(v, w);
  }
  Points points;
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t first = sets.find(v);
    if (first == v) {
      points.ofVertex.push_back(static_cast<std::uint32_t>(points.count()));
      points.positions.push_back(vertex(target, v));
    } else {
      points.ofVertex.push_back(points.ofVertex[first]);
      Vec& position = points.positions[points.ofVertex[v]];
      if (key(vertex(target, v)) < key(position)) position = vertex(target, v);
    }
  }
  return points;
}

/// Numbers the cage's vertices; equal positions are one vertex.
/// @return Where each is.
std::vector<Vec> weldCage(Scene& scene) {
  std::map<Position, std::uint32_t> numbers;
  std::vector<Vec> positions;
  for (const Triangle& triangle : scene.cage.triangles()) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [at, isNew] =
          numbers.try_emplace(key(triangle.corners[c]), static_cast<std::uint32_t>(positions.size()));
      if (isNew) positions.push_back(triangle.corners[c]);
      corners[c] = at->second;
    }
    scene.cageCorners.push_back(corners);
  }
  return positions;
}

BoundaryLoops findBoundaryLoops(const std::vector<std::array<std::uint32_t, 3>>& corners,
                                const std::vector<Vec>& positions) {
  const auto edge = [&](std::size_t t, std::size_t k) { return std::minmax(corners[t][k], corners[t][(k + 1) % 3]); };
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) ++uses[edge(t, k)];

  Sets sets(positions.size());
  std::vector<bool> onRim(positions.size(), false);
  for (const auto& [ends, count] : uses) {
    if (count != 1) continue;
    sets.join(ends.first, ends.second);
    onRim[ends.first] = onRim[ends.second] = true;
  }
  BoundaryLoops loops;
  std::vector<std::int32_t> loopOf(positions.size(), -1);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (!onRim[v]) continue;
    std::int32_t& loop = loopOf[sets.find(v)];
    if (loop < 0) {
      loop = static_cast<std::int32_t>(loops.loops.size());
      loops.loops.emplace_back();
    }
    loopOf[v] = loop;
    loops.loops[static_cast<std::size_t>(loop)].box.add(positions[v]);
  }
  for (std::size_t t = 0; t < corners.size(); ++t) {
    std::array<std::int32_t, 3> ofEdge{}, ofCorner{};
    for (std::size_t k = 0; k < 3; ++k) {
      ofEdge[k] = uses[edge(t, k)] == 1 ? loopOf[corners[t][k]] : -1;
      ofCorner[k] = loopOf[corners[t][k]];
    }
    loops.loopOfEdge.push_back(ofEdge);
    loops.loopOfCorner.push_back(ofCorner);
  }
  return loops;
}

}  // namespace

Scene makeScene(const MeshView& cage, const MeshView& target, double weldTolerance) {
  Scene scene;
  scene.diag = boxOf(target).diagonal();
  scene.points = weld(target, weldTolerance * scene.diag);
  std::vector<Vec> positions;
  for (std::uint32_t v = 0; v < cage.positions.size() / 3; ++v) positions.push_back(vertex(cage, v));
  scene.cage = usableTriangles(cage, positions);
  positions.clear();
  for (const std::uint32_t p : scene.points.ofVertex) positions.push_back(scene.points.positions[p]);
  scene.target = usableTriangles(target, positions);
  for (const Triangle& triangle : scene.target.triangles()) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = scene.points.ofVertex[target.indices[std::size_t{triangle.index} * 3 + c]];
    scene.corners.push_back(corners);
  }
  const std::vector<Vec> cagePositions = weldCage(scene);
  scene.loops = findBoundaryLoops(scene.cageCorners, cagePositions);
  return scene;
}

ClosestPoint project(const std::vector<const Triangle*>& triangles, Vec p, double diag) {
  double least = kInfinity, farthest = 0;
  std::vector<ClosestPoint> near;
  for (const Triangle* triangle : triangles) {
    near.push_back({triangle, nearestOn(*triangle, p)});
    least = std::min(least, near.back().nearest.distance);
  }
  std::erase_if(near, [&](const ClosestPoint& place) { return place.nearest.distance > least + kNearestTie * diag; });
  for (const ClosestPoint& place : near) farthest = std::max(farthest, std::abs(planeDistance(*place.triangle, p)));
  for (const ClosestPoint& place : near)
    if (std::abs(planeDistance(*place.triangle, p)) >= farthest - kPlaneTie * diag) return place;
  return {};
}

ClosestPoint project(const Scene& scene, Vec p) {
  return project(scene.cage.near(p, 2 * kNearestTie * scene.diag), p, scene.diag);
}

std::int32_t loopAt(const Scene& scene, const ClosestPoint& place) {
  const Triangle& triangle = *place.triangle;
  const auto t = static_cast<std::size_t>(&triangle - scene.cage.triangles().data());
  const Vec q = place.position();
  for (std::size_t k = 0; k < 3; ++k) {
    if (scene.loops.loopOfEdge[t][k] < 0) continue;
    const Vec start = triangle.corners[k], edge = triangle.corners[(k + 1) % 3] - start;
    if (length(cross(edge, q - start)) <= kOnRim * scene.diag * length(edge)) return scene.loops.loopOfEdge[t][k];
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (scene.loops.loopOfCorner[t][k] >= 0 && length(q - triangle.corners[k]) <= kOnRim * scene.diag)
      return scene.loops.loopOfCorner[t][k];
  return -1;
}

std::array<double, 2> uvAt(const MeshView& cage, const ClosestPoint& place) {
  std::array<double, 2> uv{};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t corner = cage.indices[std::size_t{place.triangle->index} * 3 + c];
      uv[k] += place.nearest.weights[c] * static_cast<double>(cage.uvs[corner * 2 + k]);
    }
  return uv;
}

}  // namespace cagecast::reference
