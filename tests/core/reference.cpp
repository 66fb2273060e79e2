#include "reference.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

namespace cagecast::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Tolerances of the method, as shares of the diagonal of the target's bounding box.
constexpr double kNearestTie = 1e-6;    // Triangles this much farther than the nearest count as equally near.
constexpr double kPlaneTie = 1e-7;      // Planes this much nearer than the farthest count as equally far.
constexpr double kSelfHitStart = 1e-5;  // A self hit nearer than this is the surface the point lies on.
constexpr double kCageHitStart = -1e-5; // A point this far outside the cage still counts as covered by it.

// A ray that makes a smaller angle with a triangle (as a sine) lies in its plane: in double precision, and between
// vertices given as floats, less than this cannot be told from nothing.
constexpr double kInPlane = 1e-10;

// To how many sides a ray is turned: a ray that touches a corner hits it from a narrow wedge of them only.
constexpr int kNudges = 16;

// Sums of areas that differ by less than this share may differ only by the order of adding.
constexpr double kSumNoise = 1e-12;

struct Vec {
  double x = 0, y = 0, z = 0;
  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(Vec a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Vec a) { return std::sqrt(dot(a, a)); }
Vec unit(Vec a) { return a * (1.0 / length(a)); }

Vec vertex(const MeshView& mesh, std::uint32_t index) {
  const float* p = &mesh.positions[std::size_t{index} * 3];
  return {p[0], p[1], p[2]};
}

/// A triangle that is not degenerate.
struct Triangle {
  std::uint32_t index;  // Its place in the mesh.
  std::array<Vec, 3> corners;
  Vec normal;  // Unit.
  double area;
  Vec centre;  // Of a sphere around it.
  double radius;
};

/// The triangles that take part: all but those whose area is zero.
/// @param position  Where a vertex of the mesh is.
template <typename Position>
std::vector<Triangle> usableTriangles(const MeshView& mesh, Position position) {
  std::vector<Triangle> triangles;
  for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
    Triangle triangle{t, {}, {}, 0, {}, 0};
    for (std::uint32_t c = 0; c < 3; ++c) triangle.corners[c] = position(mesh.indices[t * 3 + c]);
    const auto& [a, b, c] = triangle.corners;
    const Vec doubleArea = cross(b - a, c - a);
    if (doubleArea.x == 0 && doubleArea.y == 0 && doubleArea.z == 0) continue;
    triangle.normal = unit(doubleArea);
    triangle.area = length(doubleArea) / 2;
    triangle.centre = (a + b + c) * (1.0 / 3);
    for (const Vec& corner : triangle.corners)
      triangle.radius = std::max(triangle.radius, length(corner - triangle.centre) * (1 + 1e-12));
    triangles.push_back(triangle);
  }
  return triangles;
}

double diagonal(const MeshView& mesh) {
  Vec low{kInfinity, kInfinity, kInfinity}, high = low * -1;
  for (std::uint32_t v = 0; v < mesh.positions.size() / 3; ++v) {
    const Vec p = vertex(mesh, v);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(high - low);
}

// ---------------------------------------------------------------------------------------------------------------- Weld

/// The target's vertices, welded.
struct Points {
  std::vector<std::uint32_t> ofVertex;  // The point of each vertex.
  std::vector<Vec> positions;           // Where each point is: at the least (by x, then y, then z) of its vertices.
};

/// Numbers the sets of a union-find by their first element.
struct Sets {
  std::vector<std::uint32_t> parents;
  explicit Sets(std::size_t count) : parents(count) { std::iota(parents.begin(), parents.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  }
  // The lower root stays one, so that the root of a set is its first element.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parents[std::max(a, b)] = std::min(a, b);
  }
};

Points weld(const MeshView& target, double tolerance) {
  const std::uint32_t count = static_cast<std::uint32_t>(target.positions.size() / 3);
  const auto group = [&](std::uint32_t v) { return target.groups.empty() ? 0u : target.groups[v]; };
  Sets sets(count);
  std::map<std::tuple<std::uint32_t, double, double, double>, std::uint32_t> known;
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec p = vertex(target, v);  // As a key of a map, -0 equals 0.
    sets.join(v, known.try_emplace({group(v), p.x, p.y, p.z}, v).first->second);
  }
  if (tolerance > 0) {
    for (std::uint32_t v = 0; v < count; ++v)
      for (std::uint32_t w = 0; w < v; ++w)
        if (group(v) == group(w) && length(vertex(target, v) - vertex(target, w)) <= tolerance) sets.join(v, w);
  }
  Points points;
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t first = sets.find(v);
    if (first == v) {
      points.ofVertex.push_back(static_cast<std::uint32_t>(points.positions.size()));
      points.positions.push_back(vertex(target, v));
    } else {
      points.ofVertex.push_back(points.ofVertex[first]);
      Vec& position = points.positions[points.ofVertex[v]];
      const Vec p = vertex(target, v);
      if (std::tie(p.x, p.y, p.z) < std::tie(position.x, position.y, position.z)) position = p;
    }
  }
  return points;
}

// ----------------------------------------------------------------------------------------------------------- 1 Project

/// The point of a triangle nearest to another point.
struct Nearest {
  double distance = kInfinity;
  std::array<double, 3> weights{};  // Barycentrics; one is exactly zero where the point lies on an edge.
};

double clamp01(double x) { return std::min(1.0, std::max(0.0, x)); }

Nearest nearestOn(const Triangle& triangle, Vec p) {
  Nearest best;
  const auto consider = [&](std::array<double, 3> weights) {
    Vec q;
    for (std::size_t c = 0; c < 3; ++c) q = q + triangle.corners[c] * weights[c];
    const double distance = length(p - q);
    if (distance < best.distance) best = {distance, weights};
  };
  // Inside, if the foot of p on the plane is inside; else on one of the edges.
  const auto& [a, b, c] = triangle.corners;
  const Vec n = cross(b - a, c - a);
  const double whole = dot(n, n);
  const std::array<double, 3> inside{dot(cross(c - b, p - b), n) / whole, dot(cross(a - c, p - c), n) / whole,
                                     dot(cross(b - a, p - a), n) / whole};
  if (inside[0] > 0 && inside[1] > 0 && inside[2] > 0) {
    consider(inside);
    return best;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3;
    const Vec edge = triangle.corners[l] - triangle.corners[k];
    const double along = clamp01(dot(p - triangle.corners[k], edge) / dot(edge, edge));
    std::array<double, 3> weights{};
    weights[k] = 1 - along;
    weights[l] = along;
    consider(weights);
  }
  return best;
}

double planeDistance(const Triangle& triangle, Vec p) { return dot(p - triangle.corners[0], triangle.normal); }

/// A point's place on the cage.
struct Place {
  const Triangle* triangle = nullptr;
  Nearest nearest;
};

/// Finds the nearest place on the cage. Of triangles that are equally near, the one whose plane is farthest from p; of
/// those that are equally far, the one with the lowest index.
Place project(const std::vector<Triangle>& cage, Vec p, double diag) {
  double least = kInfinity;
  std::vector<Place> near;
  for (const Triangle& triangle : cage) {
    if (length(p - triangle.centre) - triangle.radius > least + 2 * kNearestTie * diag) continue;
    const Nearest nearest = nearestOn(triangle, p);
    least = std::min(least, nearest.distance);
    if (nearest.distance <= least + kNearestTie * diag) near.push_back({&triangle, nearest});
  }
  // What was near when it was seen may not be any more.
  std::erase_if(near, [&](const Place& place) { return place.nearest.distance > least + kNearestTie * diag; });
  double farthest = 0;
  for (const Place& place : near) farthest = std::max(farthest, std::abs(planeDistance(*place.triangle, p)));
  for (const Place& place : near)
    if (std::abs(planeDistance(*place.triangle, p)) >= farthest - kPlaneTie * diag) return place;
  return {};
}

// ------------------------------------------------------------------------------------------------------ 2, 3 Ray tests

struct Ray {
  Vec origin, direction;
};

/// Where a ray meets the plane of a triangle that it hits, as a multiple of its direction; NaN if it does not hit.
///
/// Seen along the ray, the origin must not be outside any of the three edges. The sign of an edge comes out opposite,
/// bit by bit, for the two triangles that share it, and zero counts as inside: no ray slips between them.
double hit(const Ray& ray, const Triangle& triangle) {
  constexpr double kMiss = std::numeric_limits<double>::quiet_NaN();
  const Vec d = ray.direction;
  if (std::abs(dot(d, triangle.normal)) <= kInPlane * length(d)) return kMiss;
  int z = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(d[axis]) > std::abs(d[z])) z = axis;
  const int x = (z + 1) % 3, y = (z + 2) % 3;
  std::array<double, 3> px{}, py{}, pz{};  // The corners with the ray as the z axis.
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec corner = triangle.corners[c] - ray.origin;
    pz[c] = corner[z] / d[z];
    px[c] = corner[x] - pz[c] * d[x];
    py[c] = corner[y] - pz[c] * d[y];
  }
  const double a = px[2] * py[1] - py[2] * px[1];
  const double b = px[0] * py[2] - py[0] * px[2];
  const double c = px[1] * py[0] - py[1] * px[0];
  if (std::min({a, b, c}) < 0 && std::max({a, b, c}) > 0) return kMiss;
  const double whole = a + b + c;
  if (whole == 0) return kMiss;
  return (a * pz[0] + b * pz[1] + c * pz[2]) / whole;
}

/// The triangles that a ray, turned by up to `kRayNudge`, can possibly hit.
std::vector<const Triangle*> along(const Ray& ray, const std::vector<Triangle>& triangles) {
  std::vector<const Triangle*> result;
  for (const Triangle& triangle : triangles) {
    const Vec to = triangle.centre - ray.origin;
    const double reach = triangle.radius + 2 * kRayNudge * (length(to) + triangle.radius);
    const Vec aside = to - ray.direction * dot(to, ray.direction);
    if (dot(aside, aside) <= reach * reach) result.push_back(&triangle);
  }
  return result;
}

bool hitsAny(const Ray& ray, const std::vector<const Triangle*>& triangles, double start) {
  return std::any_of(triangles.begin(), triangles.end(), [&](const Triangle* t) { return hit(ray, *t) > start; });
}

/// The two meshes as the steps see them.
struct Scene {
  std::vector<Triangle> cage, target;
  Points points;
  std::vector<std::array<std::uint32_t, 3>> corners;  // The points of each triangle in `target`.
  double diag = 0;
};

/// A point's ray, with the triangles worth testing it against.
struct Sight {
  Ray ray;
  std::vector<const Triangle*> target, cage;
};

Sight look(const Scene& scene, std::uint32_t point, const Place& place) {
  Sight sight;
  sight.ray = {scene.points.positions[point], place.triangle->normal};
  for (const Triangle* t : along(sight.ray, scene.target)) {
    const auto& corners = scene.corners[static_cast<std::size_t>(t - scene.target.data())];
    if (std::find(corners.begin(), corners.end(), point) == corners.end()) sight.target.push_back(t);
  }
  sight.cage = along(sight.ray, scene.cage);
  return sight;
}

/// Step 2: does the target itself lie over the point?
bool occluded(const Scene& scene, const Sight& sight, const Ray& ray) {
  return hitsAny(ray, sight.target, kSelfHitStart * scene.diag);
}

/// Step 3: does the ray come to the cage?
bool covered(const Scene& scene, const Sight& sight, const Ray& ray, const Place& place) {
  const auto& w = place.nearest.weights;
  if (w[0] > 0 && w[1] > 0 && w[2] > 0 && planeDistance(*place.triangle, sight.ray.origin) <= 0) return true;
  return hitsAny(ray, sight.cage, kCageHitStart * scene.diag);
}

/// Steps 2 and 3 for one ray.
Zone zoneOf(const Scene& scene, const Sight& sight, const Ray& ray, const Place& place) {
  if (occluded(scene, sight, ray)) return Zone::occluded;
  return covered(scene, sight, ray, place) ? Zone::cosmetic : Zone::uncovered;
}

/// The zones (as bits) that the ray and the rays beside it come to.
unsigned zonesNearby(const Scene& scene, const Sight& sight, const Place& place) {
  const Vec n = sight.ray.direction;
  const Vec u = unit(cross(n, std::abs(n.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
  const Vec v = cross(n, u);
  unsigned zones = 1u << static_cast<unsigned>(zoneOf(scene, sight, sight.ray, place));
  for (int k = 0; k < kNudges; ++k) {
    const double angle = 2 * std::numbers::pi * k / kNudges;
    const Ray ray{sight.ray.origin, n + (u * std::cos(angle) + v * std::sin(angle)) * kRayNudge};
    zones |= 1u << static_cast<unsigned>(zoneOf(scene, sight, ray, place));
  }
  return zones;
}

// ---------------------------------------------------------------------------------------------------------- 4 Segments

/// The segment of each point, numbered by the first point. Points and vertices come in the same order.
std::vector<std::uint32_t> findSegments(const Scene& scene, std::uint32_t& count) {
  Sets sets(scene.points.positions.size());
  for (const auto& [a, b, c] : scene.corners) {
    sets.join(a, b);
    sets.join(b, c);
  }
  std::vector<std::uint32_t> segments(scene.points.positions.size());
  count = 0;
  for (std::uint32_t p = 0; p < segments.size(); ++p) {
    const std::uint32_t first = sets.find(p);
    segments[p] = first == p ? count++ : segments[first];
  }
  return segments;
}

// --------------------------------------------------------------------------------------------------------- 5 Threshold

/// Whether a segment's verdict could be the other one, given which zones its points might have.
///
/// The segment fails iff Σ (covered − threshold · exposed) < 0, a sum over its points: take every point at its best and
/// at its worst.
bool verdictHangs(const std::vector<double>& areas, const std::vector<unsigned>& nearby,
                  const std::vector<std::uint32_t>& segments, std::uint32_t segment, double threshold) {
  double best = 0, worst = 0, exposed = 0;
  bool unsure = false;
  for (std::size_t p = 0; p < areas.size(); ++p) {
    if (segments[p] != segment) continue;
    double high = -kInfinity, low = kInfinity;
    const auto might = [&](Zone zone, double value) {
      if ((nearby[p] & (1u << static_cast<unsigned>(zone))) == 0) return;
      high = std::max(high, value);
      low = std::min(low, value);
    };
    might(Zone::occluded, 0);
    might(Zone::uncovered, -threshold * areas[p]);
    might(Zone::cosmetic, (1 - threshold) * areas[p]);
    best += high;
    worst += low;
    exposed += areas[p];
    unsure = unsure || !std::has_single_bit(nearby[p]);
  }
  if (unsure && (best >= 0) != (worst >= 0)) return true;
  // With a threshold of 0 or 1 a tie is a sum compared with nothing or with itself: exact, whatever the order.
  const bool exact = threshold == 0 || threshold == 1;
  return !exact && exposed > 0 && std::abs(best) <= kSumNoise * exposed;
}

/// The classical baseline: the nearest vertex of the cage, the lowest of equally near ones; nothing is filtered. A vertex
/// of no triangle, or only of degenerate ones, is not part of the cage; of the triangles at a vertex the first stands
/// for it.
Result nearestVertex(const MeshView& cage, const MeshView& target, const Scene& scene, Result result) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> triangleAt(cage.positions.size() / 3, kNone);
  for (const Triangle& triangle : scene.cage)
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& first = triangleAt[cage.indices[std::size_t{triangle.index} * 3 + c]];
      first = std::min(first, triangle.index);
    }
  for (std::uint32_t v = 0; v < target.positions.size() / 3; ++v) {
    const Vec p = scene.points.positions[scene.points.ofVertex[v]];
    std::uint32_t best = kNone;
    double least = kInfinity;
    for (std::uint32_t w = 0; w < triangleAt.size(); ++w) {
      const Vec offset = p - vertex(cage, w);
      if (triangleAt[w] != kNone && dot(offset, offset) < least) least = dot(offset, offset), best = w;
    }
    result.triangles[v] = triangleAt[best];
    result.distances[v] = static_cast<float>(std::sqrt(least));
    for (std::size_t k = 0; k < 2; ++k) result.uvs[v * 2 + k] = cage.uvs[std::size_t{best} * 2 + k];
  }
  return result;
}

}  // namespace

Result transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options) {
  const double threshold = static_cast<double>(options.threshold);
  Scene scene;
  scene.diag = diagonal(target);
  scene.points = weld(target, static_cast<double>(options.weldTolerance) * scene.diag);
  scene.cage = usableTriangles(cage, [&](std::uint32_t v) { return vertex(cage, v); });
  scene.target =
      usableTriangles(target, [&](std::uint32_t v) { return scene.points.positions[scene.points.ofVertex[v]]; });
  for (const Triangle& triangle : scene.target) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = scene.points.ofVertex[target.indices[std::size_t{triangle.index} * 3 + c]];
    scene.corners.push_back(corners);
  }

  const std::size_t pointCount = scene.points.positions.size();
  const bool filtered = options.projection == ProjectionMode::nearestPoint;
  std::vector<Place> places(pointCount);
  std::vector<Zone> zones(pointCount, Zone::cosmetic);
  std::vector<unsigned> nearby(pointCount, 1u << static_cast<unsigned>(Zone::cosmetic));
  for (std::uint32_t p = 0; filtered && p < pointCount; ++p) {
    places[p] = project(scene.cage, scene.points.positions[p], scene.diag);
    const Sight sight = look(scene, p, places[p]);
    zones[p] = zoneOf(scene, sight, sight.ray, places[p]);
    nearby[p] = zonesNearby(scene, sight, places[p]);
  }

  Result result;
  std::uint32_t segmentCount = 0;
  const std::vector<std::uint32_t> segments = findSegments(scene, segmentCount);
  std::vector<double> areas(pointCount, 0.0);
  for (std::size_t t = 0; t < scene.target.size(); ++t)
    for (const std::uint32_t p : scene.corners[t]) areas[p] += scene.target[t].area / 3;
  result.segmentStats.resize(segmentCount);
  for (std::size_t p = 0; p < pointCount; ++p) {
    SegmentStats& stats = result.segmentStats[segments[p]];
    ++stats.points;
    stats.area += areas[p];
    if (zones[p] != Zone::occluded) stats.exposedArea += areas[p];
    if (zones[p] == Zone::cosmetic) stats.coveredArea += areas[p];
  }
  std::vector<std::uint8_t> hangs(segmentCount, 0);
  for (std::uint32_t s = 0; filtered && s < segmentCount; ++s) {
    SegmentStats& stats = result.segmentStats[s];
    stats.culled = stats.coveredArea < threshold * stats.exposedArea;
    hangs[s] = verdictHangs(areas, nearby, segments, s, threshold);
  }

  const std::size_t vertexCount = target.positions.size() / 3;
  result.uvs.resize(vertexCount * 2);
  result.triangles.resize(vertexCount);
  result.distances.resize(vertexCount);
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t p = scene.points.ofVertex[v];
    const bool culled = zones[p] == Zone::cosmetic && result.segmentStats[segments[p]].culled;
    result.zones.push_back(culled ? Zone::culled : zones[p]);
    result.segments.push_back(segments[p]);
    const bool firm = std::has_single_bit(nearby[p]) && !(zones[p] == Zone::cosmetic && hangs[segments[p]] != 0);
    result.stable.push_back(firm ? 1 : 0);
    if (!filtered) continue;
    const Place& place = places[p];
    result.triangles[v] = place.triangle->index;
    result.distances[v] = static_cast<float>(place.nearest.distance);
    for (std::size_t k = 0; k < 2; ++k) {
      double uv = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t corner = cage.indices[std::size_t{place.triangle->index} * 3 + c];
        uv += place.nearest.weights[c] * static_cast<double>(cage.uvs[corner * 2 + k]);
      }
      result.uvs[v * 2 + k] = static_cast<float>(uv);
    }
  }
  for (std::size_t t = 0; t < target.indices.size(); t += 3) {
    const bool all = std::all_of(&target.indices[t], &target.indices[t] + 3,
                                 [&](std::uint32_t v) { return result.zones[v] == Zone::cosmetic; });
    result.cosmeticTriangles.push_back(all ? 1 : 0);
  }
  return filtered ? result : nearestVertex(cage, target, scene, std::move(result));
}

Differences compare(const Result& reference, const TransferResult& product, const MeshView& target) {
  constexpr std::size_t kMaxLines = 10;
  constexpr double kUvTolerance = 1e-5, kDistanceTolerance = 1e-6, kAreaTolerance = 1e-9, kLeastArea = 1e-13;
  Differences found;
  std::size_t lines = 0;
  const auto report = [&](const char* format, auto... values) {
    if (++lines > kMaxLines) return;
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), format, values...);
    found.details += line.data();
    found.details += '\n';
  };
  const Projection& projection = product.projection;
  const double diag = diagonal(target);
  found.vertices = reference.zones.size();
  if (product.zones.zones.size() != found.vertices || projection.uvs.size() != 2 * found.vertices ||
      projection.triangles.size() != found.vertices || projection.distances.size() != found.vertices ||
      projection.segments.size() != found.vertices || projection.segmentStats.size() != reference.segmentStats.size() ||
      product.zones.culledSegments.size() != reference.segmentStats.size() ||
      product.zones.cosmeticTriangles.size() != reference.cosmeticTriangles.size()) {
    report("the arrays have other lengths: %zu zones of %zu, %zu segments of %zu", product.zones.zones.size(),
           found.vertices, projection.segmentStats.size(), reference.segmentStats.size());
    found.stats = 1;
    return found;
  }
  std::vector<std::uint8_t> firm(reference.segmentStats.size(), 1);
  for (std::size_t v = 0; v < found.vertices; ++v) {
    if (projection.segments[v] != reference.segments[v]) {
      ++found.segments;
      report("vertex %zu: segment %u, expected %u", v, projection.segments[v], reference.segments[v]);
    }
    if (reference.stable[v] == 0) {
      ++found.unstable;
      firm[reference.segments[v]] = 0;
      continue;
    }
    const float* p = &target.positions[v * 3];
    const auto at = [&] {
      std::array<char, 128> text{};
      std::snprintf(text.data(), text.size(), "vertex %zu at (%.9g, %.9g, %.9g)", v, static_cast<double>(p[0]),
                    static_cast<double>(p[1]), static_cast<double>(p[2]));
      return std::string(text.data());
    };
    if (product.zones.zones[v] != reference.zones[v]) {
      ++found.zones;
      report("%s: zone %u, expected %u", at().c_str(), static_cast<unsigned>(product.zones.zones[v]),
             static_cast<unsigned>(reference.zones[v]));
    }
    if (projection.triangles[v] != reference.triangles[v]) {
      ++found.triangles;
      report("%s: cage triangle %u, expected %u", at().c_str(), projection.triangles[v], reference.triangles[v]);
      continue;  // Another triangle has another UV.
    }
    for (std::size_t k = v * 2; k < v * 2 + 2; ++k) {
      const double expected = static_cast<double>(reference.uvs[k]), got = static_cast<double>(projection.uvs[k]);
      if (std::abs(got - expected) <= kUvTolerance * std::max(1.0, std::abs(expected))) continue;
      ++found.uvs;
      report("%s: uv %.9g, expected %.9g", at().c_str(), got, expected);
      break;
    }
    const double expected = static_cast<double>(reference.distances[v]);
    const double got = static_cast<double>(projection.distances[v]);
    if (!(std::abs(got - expected) <= kDistanceTolerance * std::max(diag, expected))) {
      ++found.distances;
      report("%s: distance %.9g, expected %.9g", at().c_str(), got, expected);
    }
  }
  for (std::size_t s = 0; s < reference.segmentStats.size(); ++s) {
    const SegmentStats& expected = reference.segmentStats[s];
    const SegmentStats& got = projection.segmentStats[s];
    // Slivers have areas that rounding makes; they are compared with what matters, the size of the target.
    const double slack = kAreaTolerance * expected.area + kLeastArea * diag * diag;
    const auto differs = [&](double a, double b) { return !(std::abs(a - b) <= slack); };
    bool same = got.points == expected.points && !differs(got.area, expected.area);
    if (firm[s] != 0)
      same = same && got.culled == expected.culled && !differs(got.exposedArea, expected.exposedArea) &&
             !differs(got.coveredArea, expected.coveredArea);
    if (same) continue;
    ++found.stats;
    report("segment %zu: %u points, area %.9g, exposed %.9g, covered %.9g, expected %u, %.9g, %.9g, %.9g", s, got.points,
           got.area, got.exposedArea, got.coveredArea, expected.points, expected.area, expected.exposedArea,
           expected.coveredArea);
  }
  return found;
}

}  // namespace cagecast::reference
