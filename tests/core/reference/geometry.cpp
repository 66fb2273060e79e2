#include "reference/geometry.hpp"

#include <algorithm>
#include <numeric>

namespace cagecast::reference {
namespace {

// A ray that makes a smaller angle with a triangle (as a sine) lies in its plane: in double precision, and between
// vertices given as floats, less than this cannot be told from nothing.
constexpr double kInPlane = 1e-10;

// Spheres are a little larger than what they hold, so that rounding takes nothing out of them.
constexpr double kRoomy = 1 + 1e-12;

/// Whether any ray of the cone may come through a sphere, in front of its origin or up to `behind` behind it.
bool passes(const Ray& ray, Vec centre, double radius, double behind) {
  const Vec to = centre - ray.origin;
  const double reach = radius + 2 * kRayNudge * (length(to) + radius);
  const double ahead = dot(to, ray.direction);
  const Vec aside = to - ray.direction * ahead;
  return dot(aside, aside) <= reach * reach && ahead >= -reach - behind;
}

double clamp01(double x) { return std::min(1.0, std::max(0.0, x)); }

}  // namespace

Vec vertex(const MeshView& mesh, std::uint32_t index) {
  const float* p = &mesh.positions[std::size_t{index} * 3];
  return {p[0], p[1], p[2]};
}

void Box::add(Vec p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

bool Box::meets(const Box& other, double margin) const {
  for (int axis = 0; axis < 3; ++axis)
    if (low[axis] - margin > other.high[axis] || other.low[axis] > high[axis] + margin) return false;
  return true;
}

Box boxOf(const MeshView& mesh) {
  Box box;
  for (std::uint32_t v = 0; v < mesh.positions.size() / 3; ++v) box.add(vertex(mesh, v));
  return box;
}

Surface usableTriangles(const MeshView& mesh, const std::vector<Vec>& positions) {
  std::vector<Triangle> triangles;
  for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
    Triangle triangle;
    triangle.index = t;
    for (std::uint32_t c = 0; c < 3; ++c) triangle.corners[c] = positions[mesh.indices[t * 3 + c]];
    const auto& [a, b, c] = triangle.corners;
    const Vec doubleArea = cross(b - a, c - a);
    if (doubleArea.x == 0 && doubleArea.y == 0 && doubleArea.z == 0) continue;
    triangle.normal = unit(doubleArea);
    triangle.area = length(doubleArea) / 2;
    triangle.centre = (a + b + c) * (1.0 / 3);
    for (const Vec& corner : triangle.corners)
      triangle.radius = std::max(triangle.radius, length(corner - triangle.centre) * kRoomy);
    triangles.push_back(triangle);
  }
  return Surface(std::move(triangles));
}

Surface::Surface(std::vector<Triangle> triangles) : triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

std::int32_t Surface::build(std::uint32_t first, std::uint32_t count) {
  constexpr std::uint32_t kLeaf = 4;
  const auto begin = order_.begin() + first, end = begin + count;
  Box box;
  std::for_each(begin, end, [&](std::uint32_t t) { box.add(triangles_[t].centre); });
  Node node{(box.low + box.high) * 0.5, 0, first, count, -1, -1};
  std::for_each(begin, end, [&](std::uint32_t t) {
    const Triangle& triangle = triangles_[t];
    node.radius = std::max(node.radius, (length(triangle.centre - node.centre) + triangle.radius) * kRoomy);
  });
  const auto place = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back(node);
  if (count <= kLeaf) return place;
  const Vec size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::nth_element(begin, begin + count / 2, end, [&](std::uint32_t s, std::uint32_t t) {
    return triangles_[s].centre[axis] < triangles_[t].centre[axis];
  });
  const std::int32_t left = build(first, count / 2), right = build(first + count / 2, count - count / 2);
  nodes_[static_cast<std::size_t>(place)].left = left;
  nodes_[static_cast<std::size_t>(place)].right = right;
  return place;
}

std::vector<const Triangle*> Surface::along(const Ray& ray, double behind) const {
  std::vector<const Triangle*> result;
  std::vector<std::int32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const Node& node = nodes_[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (!passes(ray, node.centre, node.radius, behind)) continue;
    if (node.left >= 0) {
      open.insert(open.end(), {node.left, node.right});
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Triangle& triangle = triangles_[order_[i]];
      if (passes(ray, triangle.centre, triangle.radius, behind)) result.push_back(&triangle);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<const Triangle*> Surface::near(Vec p, double slack) const {
  std::vector<const Triangle*> result;
  double least = kInfinity;  // No farther than this is the nearest triangle.
  std::vector<std::int32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  const auto distanceTo = [&](std::int32_t n) {
    const Node& node = nodes_[static_cast<std::size_t>(n)];
    return length(p - node.centre) - node.radius;
  };
  while (!open.empty()) {
    const std::int32_t n = open.back();
    open.pop_back();
    if (distanceTo(n) > least + slack) continue;
    const Node& node = nodes_[static_cast<std::size_t>(n)];
    if (node.left >= 0) {
      const bool leftFirst = distanceTo(node.left) < distanceTo(node.right);
      open.push_back(leftFirst ? node.right : node.left);
      open.push_back(leftFirst ? node.left : node.right);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Triangle& triangle = triangles_[order_[i]];
      if (length(p - triangle.centre) - triangle.radius > least + slack) continue;
      const double distance = nearestOn(triangle, p).distance;
      least = std::min(least, distance);
      if (distance <= least + slack) result.push_back(&triangle);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

Nearest nearestOn(const Triangle& triangle, Vec p) {
  const auto nearest = [&](const std::array<double, 3>& weights) {
    return Nearest{length(p - blend(triangle, weights)), weights};
  };
  // Inside, if the foot of p on the plane is inside; else on one of the edges.
  const auto& [a, b, c] = triangle.corners;
  const Vec n = cross(b - a, c - a);
  const double whole = dot(n, n);
  const std::array<double, 3> inside{dot(cross(c - b, p - b), n) / whole, dot(cross(a - c, p - c), n) / whole,
                                     dot(cross(b - a, p - a), n) / whole};
  if (inside[0] > 0 && inside[1] > 0 && inside[2] > 0) return nearest(inside);
  // The nearest to the foot: from p, the edges at a sharp corner are equally far but for rounding.
  const Vec foot = p - n * (dot(p - a, n) / whole);
  std::array<double, 3> best{};
  double least = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3;
    const Vec edge = triangle.corners[l] - triangle.corners[k];
    const double share = clamp01(dot(p - triangle.corners[k], edge) / dot(edge, edge));
    std::array<double, 3> weights{};
    weights[k] = 1 - share;
    weights[l] = share;
    const double distance = length(foot - blend(triangle, weights));
    if (distance < least) least = distance, best = weights;
  }
  return nearest(best);
}

Vec blend(const Triangle& triangle, const std::array<double, 3>& weights) {
  Vec q;
  for (std::size_t c = 0; c < 3; ++c) q = q + triangle.corners[c] * weights[c];
  return q;
}

double planeDistance(const Triangle& triangle, Vec p) { return dot(p - triangle.corners[0], triangle.normal); }

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

}  // namespace cagecast::reference
