#include "make/marks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace cagecast::cages {

namespace {

constexpr double kBorderValue = 0.5;
/// Each averages a vertex with its neighbours: details of about two voxels go.
constexpr int kSmoothings = 6;
/// What a ray meets at more than so many times the distance to the nearest part is seen through a gap, such as teeth
/// between lips, and does not count.
constexpr double kStraightBelow = 1.5;
/// The hull is refined as far as this from the borders of the marks, in edges.
constexpr int kRefinedRings = 3;
/// Gaps between marks narrower than twice this, in edges, are no paint.
constexpr int kGapRings = 3;
/// Fewer marked vertices next to each other than this are an error of the sampling, not a part.
constexpr std::size_t kLeastMark = 4;
/// The neighbours of each vertex: those of v are `list[first[v]]` to `list[first[v + 1] - 1]`.
struct Neighbours {
  std::vector<std::uint32_t> first, list;
};

/// Those along the edges of a closed mesh, each once.
Neighbours neighboursIn(const TriangleMesh& mesh) {
  Neighbours out;
  out.first.assign(mesh.positions.size() + 1, 0);
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) ++out.first[v + 1];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) out.first[v + 1] += out.first[v];
  out.list.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (const Triangle3& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) out.list[next[t[i]]++] = t[(i + 1) % 3];
  return out;
}

std::vector<double> marksBelow(const TriangleMesh& hull, const MarkedMesh& model) {
  const std::vector<Vec3> normals = vertexNormals(hull);
  std::vector<SurfaceRay> rays(hull.positions.size());
  for (std::size_t v = 0; v < rays.size(); ++v) rays[v] = {hull.positions[v], -1 * normals[v]};
  const std::vector<RayHit> hits = model.surface->trace(rays);
  const std::vector<SurfacePoint> nearest = model.surface->closest(hull.positions);
  std::vector<double> marks(hull.positions.size());
  for (std::size_t v = 0; v < marks.size(); ++v) {
    const bool isBelow = hits[v].distance < kStraightBelow * nearest[v].distance;
    const std::uint32_t triangle = isBelow ? hits[v].triangle : nearest[v].triangle;
    marks[v] = model.isMarked[triangle] ? 1 : 0;
  }
  return marks;
}

/// Points all over the marked triangles, about `spacing` apart.
std::vector<Vec3> samplesOf(const MarkedMesh& model, double spacing) {
  constexpr double kMostSteps = 64;
  std::vector<Vec3> samples;
  for (std::size_t t = 0; t < model.isMarked.size(); ++t) {
    if (!model.isMarked[t]) continue;
    const Triangle3& triangle = model.mesh->triangles[t];
    const Vec3 a = model.mesh->positions[triangle[0]];
    const Vec3 ab = model.mesh->positions[triangle[1]] - a, ac = model.mesh->positions[triangle[2]] - a;
    const double longest = std::max({length(ab), length(ac), length(ac - ab)});
    const double steps = std::clamp(std::ceil(longest / spacing), 1.0, kMostSteps);
    for (double i = 0; i < steps; ++i)
      for (double j = 0; i + j < steps; ++j)
        samples.push_back(a + (i + 1.0 / 3) / steps * ab + (j + 1.0 / 3) / steps * ac);
  }
  return samples;
}

/// Marks the vertices of the hull that are nearest to marked parts just below it, if these are seen from there.
void markAbove(const TriangleMesh& hull, const MarkedMesh& model, double depth, std::vector<double>& marks) {
  const std::vector<Vec3> samples = samplesOf(model, depth / 4);
  const std::vector<SurfacePoint> above = Surface(hull).closest(samples);
  std::vector<SurfaceRay> rays;
  std::vector<std::uint32_t> vertices;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = above[i];
    if (point.distance > depth || !(point.distance > 0)) continue;
    const auto heaviest = std::max_element(point.weights.begin(), point.weights.end()) - point.weights.begin();
    vertices.push_back(hull.triangles[point.triangle][static_cast<std::size_t>(heaviest)]);
    rays.push_back({point.position, 1 / point.distance * (samples[i] - point.position)});
  }
  const std::vector<RayHit> hits = model.surface->trace(rays);
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (std::isfinite(hits[i].distance) && model.isMarked[hits[i].triangle]) marks[vertices[i]] = 1;
}

/// The vertices of marks that are next to vertices without, and those.
std::vector<std::uint32_t> borderOf(const Neighbours& neighbours, const std::vector<double>& marks) {
  std::vector<std::uint32_t> border;
  for (std::uint32_t v = 0; v < marks.size(); ++v) {
    bool isBorder = false;
    for (std::uint32_t i = neighbours.first[v]; i < neighbours.first[v + 1]; ++i)
      isBorder = isBorder || marks[neighbours.list[i]] != marks[v];
    if (isBorder) border.push_back(v);
  }
  return border;
}

/// The vertices within some edges of others.
std::vector<bool> within(const Neighbours& neighbours, std::vector<std::uint32_t> front, int rings) {
  std::vector<bool> reached(neighbours.first.size() - 1, false);
  for (const std::uint32_t v : front) reached[v] = true;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t v : front)
      for (std::uint32_t i = neighbours.first[v]; i < neighbours.first[v + 1]; ++i) {
        const std::uint32_t n = neighbours.list[i];
        if (reached[n]) continue;
        reached[n] = true;
        next.push_back(n);
      }
    front.swap(next);
  }
  return reached;
}

/// Halves the edges of triangles of which a vertex is chosen; their neighbours are cut to fit.
void refine(const std::vector<bool>& isChosen, TriangleMesh& mesh) {
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const auto keyOf = [](std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  };
  for (const Triangle3& t : mesh.triangles) {
    if (!isChosen[t[0]] && !isChosen[t[1]] && !isChosen[t[2]]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const auto [found, isNew] = middles.try_emplace(keyOf(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (isNew) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    }
  }
  std::vector<Triangle3> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) {
    std::array<std::uint32_t, 3> middle{};
    unsigned cuts = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = middles.find(keyOf(t[i], t[(i + 1) % 3]));
      middle[i] = found == middles.end() ? UINT32_MAX : found->second;
      cuts += found == middles.end() ? 0 : 1;
    }
    if (cuts == 0) {
      triangles.push_back(t);
    } else if (cuts == 3) {
      for (std::size_t i = 0; i < 3; ++i) triangles.push_back({t[i], middle[i], middle[(i + 2) % 3]});
      triangles.push_back({middle[0], middle[1], middle[2]});
    } else {
      // Turned so that the first edge is cut, and the last one is not.
      std::size_t i = 0;
      while (middle[i] == UINT32_MAX || middle[(i + 2) % 3] != UINT32_MAX) ++i;
      const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3], m = middle[i], n = middle[(i + 1) % 3];
      triangles.push_back({a, m, c});
      if (cuts == 1) {
        triangles.push_back({m, b, c});
      } else {
        triangles.push_back({m, b, n});
        triangles.push_back({m, n, c});
      }
    }
  }
  mesh.triangles.swap(triangles);
}

/// Marks what lies between marks that are close together: widens all of them, and takes the margin away again.
void closeGaps(const Neighbours& neighbours, int rings, std::vector<double>& marks) {
  const auto grow = [&](double value) {
    std::vector<std::uint32_t> front;
    for (std::uint32_t v = 0; v < marks.size(); ++v)
      if (marks[v] == value) front.push_back(v);
    const std::vector<bool> reached = within(neighbours, std::move(front), rings);
    for (std::size_t v = 0; v < marks.size(); ++v)
      if (reached[v]) marks[v] = value;
  };
  grow(1);
  grow(0);
}

void smooth(const Neighbours& neighbours, std::vector<double>& field) {
  std::vector<double> next(field.size());
  for (std::size_t v = 0; v < field.size(); ++v) {
    double sum = field[v];
    for (std::uint32_t i = neighbours.first[v]; i < neighbours.first[v + 1]; ++i) sum += field[neighbours.list[i]];
    next[v] = sum / (1 + neighbours.first[v + 1] - neighbours.first[v]);
  }
  field.swap(next);
}

/// Sets connected marks to 1 again, of which smoothing has left nothing.
void restoreVanished(const Neighbours& neighbours, const std::vector<double>& marks, std::vector<double>& field) {
  std::vector<bool> seen(marks.size(), false);
  std::vector<std::uint32_t> mark;
  for (std::uint32_t start = 0; start < marks.size(); ++start) {
    if (seen[start] || marks[start] < kBorderValue) continue;
    mark.assign(1, start);
    seen[start] = true;
    bool remains = false;
    for (std::size_t i = 0; i < mark.size(); ++i) {
      remains = remains || field[mark[i]] >= kBorderValue;
      for (std::uint32_t j = neighbours.first[mark[i]]; j < neighbours.first[mark[i] + 1]; ++j) {
        const std::uint32_t n = neighbours.list[j];
        if (seen[n] || marks[n] < kBorderValue) continue;
        seen[n] = true;
        mark.push_back(n);
      }
    }
    if (remains || mark.size() < kLeastMark) continue;
    for (const std::uint32_t v : mark) field[v] = 1;
  }
}

}  // namespace

std::vector<double> holeField(const MarkedMesh& model, double depth, int refinements, TriangleMesh& hull) {
  std::vector<double> marks;
  for (int level = 0;; ++level) {
    marks = marksBelow(hull, model);
    markAbove(hull, model, depth, marks);
    if (level == refinements) break;
    const Neighbours neighbours = neighboursIn(hull);
    refine(within(neighbours, borderOf(neighbours, marks), kRefinedRings), hull);
  }
  const Neighbours neighbours = neighboursIn(hull);
  closeGaps(neighbours, kGapRings, marks);
  std::vector<double> field = marks;
  for (int i = 0; i < kSmoothings; ++i) smooth(neighbours, field);
  restoreVanished(neighbours, marks, field);
  return field;
}

}  // namespace cagecast::cages
