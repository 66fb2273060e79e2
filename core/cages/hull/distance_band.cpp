#include "hull/steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

/// Nodes or triangles between two calls of the callback. So many nodes take a few milliseconds; so many triangles take
/// longer the larger they are, half a second where the grid is finest.
constexpr std::size_t kPerReport = 1 << 14;

double clamp01(double x) { return std::min(1.0, std::max(0.0, x)); }

/// What distances to a triangle need of it.
struct BandTriangle {
  Vec3 a{}, ab{}, ac{};
  double abab = 0, abac = 0, acac = 0, inverse = 0;  ///< Dot products, and one over their determinant.

  BandTriangle(const Vec3& p, const Vec3& q, const Vec3& r) : a(p), ab(q - p), ac(r - p) {
    abab = dot(ab, ab);
    abac = dot(ab, ac);
    acac = dot(ac, ac);
    const double determinant = abab * acac - abac * abac;
    inverse = determinant > 0 ? 1 / determinant : 0;
  }

  [[nodiscard]] double distanceSquared(const Vec3& point) const {
    const Vec3 p = point - a;
    const double d1 = dot(p, ab);
    const double d2 = dot(p, ac);
    double v = inverse * (acac * d1 - abac * d2);
    double w = inverse * (abab * d2 - abac * d1);
    if (inverse == 0 || v < 0 || w < 0 || v + w > 1) {
      // On one of the edges: the closest of the three.
      const double onAb = abab > 0 ? clamp01(d1 / abab) : 0;
      const double onAc = acac > 0 ? clamp01(d2 / acac) : 0;
      const double bcbc = abab - 2 * abac + acac;
      const double onBc = bcbc > 0 ? clamp01((d2 - abac - d1 + abab) / bcbc) : 0;
      const double pp = dot(p, p);
      const auto squared = [&](double s, double t) {
        return pp - 2 * (s * d1 + t * d2) + s * s * abab + 2 * s * t * abac + t * t * acac;
      };
      const double least = std::min({squared(onAb, 0), squared(0, onAc), squared(1 - onBc, onBc)});
      return std::max(0.0, least);
    }
    const Vec3 off = p - v * ab - w * ac;
    return dot(off, off);
  }
};

struct BandPoint {
  Vec3 at{};
  [[nodiscard]] double distanceSquared(const Vec3& point) const {
    const Vec3 off = point - at;
    return dot(off, off);
  }
};

/// Passes features from node to node, outwards, as long as they are closer than what a node knows.
template <class Feature>
class Propagation {
 public:
  Propagation(const std::vector<Feature>& features, const VoxelGrid& grid, double reach, DistanceBand& out)
      : features_(features), grid_(grid), out_(out), nearest_(grid.size(), kNone), queued_(grid.size(), 0) {
    out.reach = reach;
    out.distance.assign(grid.size(), static_cast<float>(reach));
  }

  void offer(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t feature) {
    const std::size_t node = grid_.index(x, y, z);
    if (nearest_[node] == feature) return;
    const double squared = features_[feature].distanceSquared(grid_.position(x, y, z));
    const auto known = static_cast<double>(out_.distance[node]);
    if (!(squared < known * known)) return;
    const auto distance = static_cast<float>(std::sqrt(squared));
    if (!(distance < out_.distance[node])) return;
    out_.distance[node] = distance;
    nearest_[node] = feature;
    if (queued_[node] != 0) return;
    queued_[node] = 1;
    next_.push_back({x, y, z});
  }

  bool run(const Progress& progress, double from) {
    std::size_t visited = 0;
    const double rounds = out_.reach / grid_.spacing + 2;
    for (int round = 0; !next_.empty(); ++round) {
      front_.swap(next_);
      next_.clear();
      for (const Node& n : front_) queued_[grid_.index(n.x, n.y, n.z)] = 0;
      for (const Node& n : front_) {
        const std::uint32_t feature = nearest_[grid_.index(n.x, n.y, n.z)];
        if (n.x > 0) offer(n.x - 1, n.y, n.z, feature);
        if (n.x + 1 < grid_.nx) offer(n.x + 1, n.y, n.z, feature);
        if (n.y > 0) offer(n.x, n.y - 1, n.z, feature);
        if (n.y + 1 < grid_.ny) offer(n.x, n.y + 1, n.z, feature);
        if (n.z > 0) offer(n.x, n.y, n.z - 1, feature);
        if (n.z + 1 < grid_.nz) offer(n.x, n.y, n.z + 1, feature);
        if (++visited % kPerReport != 0) continue;
        if (!report(progress, from + (1 - from) * std::min(1.0, round / rounds), "hull")) return false;
      }
    }
    return true;
  }

 private:
  struct Node {
    std::uint32_t x, y, z;
  };
  const std::vector<Feature>& features_;
  const VoxelGrid& grid_;
  DistanceBand& out_;
  std::vector<std::uint32_t> nearest_;
  std::vector<std::uint8_t> queued_;
  std::vector<Node> front_, next_;
};

/// Offers a triangle to the nodes about it. Large ones are cut up first: their boxes are mostly empty.
class Splatter {
 public:
  Splatter(Propagation<BandTriangle>& nodes, const VoxelGrid& grid) : nodes_(nodes), grid_(grid) {}

  void splat(const std::array<Vec3, 3>& corners, std::uint32_t feature, int depth = 0) {
    constexpr double kLargest = 6;  // In spacings: a compromise between boxes and pieces.
    constexpr int kDeepest = 16;
    int longest = 0;
    double size = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 edge = corners[static_cast<std::size_t>((i + 1) % 3)] - corners[static_cast<std::size_t>(i)];
      if (dot(edge, edge) <= size) continue;
      size = dot(edge, edge);
      longest = i;
    }
    const double limit = kLargest * grid_.spacing;
    if (size > limit * limit && depth < kDeepest) {
      const auto i = static_cast<std::size_t>(longest);
      const Vec3 middle = 0.5 * (corners[i] + corners[(i + 1) % 3]);
      splat({corners[i], middle, corners[(i + 2) % 3]}, feature, depth + 1);
      splat({middle, corners[(i + 1) % 3], corners[(i + 2) % 3]}, feature, depth + 1);
      return;
    }
    const auto [x0, x1] = range(corners[0].x, corners[1].x, corners[2].x, grid_.origin.x, grid_.nx);
    const auto [y0, y1] = range(corners[0].y, corners[1].y, corners[2].y, grid_.origin.y, grid_.ny);
    const auto [z0, z1] = range(corners[0].z, corners[1].z, corners[2].z, grid_.origin.z, grid_.nz);
    for (std::uint32_t z = z0; z <= z1; ++z)
      for (std::uint32_t y = y0; y <= y1; ++y)
        for (std::uint32_t x = x0; x <= x1; ++x) nodes_.offer(x, y, z, feature);
  }

 private:
  /// The nodes along an axis from the last one before the triangle to the first one after it.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> range(double a, double b, double c, double origin,
                                                              std::uint32_t count) const {
    const double low = std::floor((std::min({a, b, c}) - origin) / grid_.spacing);
    const double high = std::ceil((std::max({a, b, c}) - origin) / grid_.spacing);
    const double last = count - 1;
    return {static_cast<std::uint32_t>(std::min(last, std::max(0.0, low))),
            static_cast<std::uint32_t>(std::min(last, std::max(0.0, high)))};
  }

  Propagation<BandTriangle>& nodes_;
  const VoxelGrid& grid_;
};

}  // namespace

bool distanceToMesh(const TriangleMesh& mesh, const VoxelGrid& grid, double reach, const Progress& progress,
                    DistanceBand& out) {
  std::vector<BandTriangle> features;
  features.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles)
    features.emplace_back(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  Propagation<BandTriangle> nodes(features, grid, reach, out);
  Splatter splatter(nodes, grid);
  constexpr double kSplatShare = 0.4;  // Of the time.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle3& v = mesh.triangles[t];
    splatter.splat({mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]}, static_cast<std::uint32_t>(t));
    const double done = static_cast<double>(t) / static_cast<double>(mesh.triangles.size());
    if (t % kPerReport == 0 && !report(progress, kSplatShare * done, "hull")) return false;
  }
  return nodes.run(progress, kSplatShare);
}

bool distanceToPoints(const std::vector<GridPoint>& points, const VoxelGrid& grid, double reach,
                      const Progress& progress, DistanceBand& out) {
  std::vector<BandPoint> features;
  features.reserve(points.size());
  for (const GridPoint& p : points) features.push_back({p.position});
  Propagation<BandPoint> nodes(features, grid, reach, out);
  for (std::size_t i = 0; i < points.size(); ++i)
    nodes.offer(points[i].x, points[i].y, points[i].z, static_cast<std::uint32_t>(i));
  return nodes.run(progress, 0);
}

}  // namespace cagecast::cages
