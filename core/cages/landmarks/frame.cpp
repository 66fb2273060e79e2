#include "landmarks/frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "mesh/bounds.hpp"
#include "mesh/samples.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

constexpr std::size_t kSymmetrySamples = 600;
constexpr int kHeadings = 24;           ///< Steps of 7.5 degrees: the refinement converges from twice that.
constexpr int kRefined = 3;             ///< How many planes are refined.
constexpr double kSameHeading = 0.985;  ///< Cosine of 10 degrees.
constexpr int kIterations = 40;
/// Planes that are so much worse than the best one, and off by more than a share of the diagonal, are none.
constexpr double kFarOff = 1.6, kPlaneRounding = 0.002;
constexpr double kOverstep = 0.7;
constexpr double kFirstTurn = 0.07, kLastTurn = 0.004;  ///< Radians.
constexpr double kNoProgress = 0.998;  ///< Iterations end when the residual is this share of the last one or more.
/// Of the mirrored points, the share closest to the surface that counts: a parting or a broken ear may be one-sided.
constexpr double kTrusted = 0.8;
/// A heading off the file's own axes must be this much better: a round head has a mirror plane anywhere.
constexpr double kAxisPreference = 0.7;

/// A mesh with few triangles close to another one: vertices of one cell of a grid are one. Trees are built and searched
/// in a fraction of the time.
TriangleMesh coarse(const TriangleMesh& mesh) {
  constexpr std::size_t kEnough = 12000;
  constexpr double kCells = 70;  ///< Along the diagonal.
  if (mesh.triangles.size() <= kEnough) return mesh;
  const double size = diagonalOf(mesh) / kCells;
  Vec3 low = mesh.positions[0];
  for (const Vec3& p : mesh.positions) low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  std::unordered_map<std::uint32_t, std::uint32_t> cells;
  std::vector<std::uint32_t> newVertex;
  std::vector<double> counts;
  TriangleMesh out;
  for (const Vec3& p : mesh.positions) {
    const Vec3 d = 1 / size * (p - low);
    const std::uint32_t cell = (static_cast<std::uint32_t>(d.x) << 20) + (static_cast<std::uint32_t>(d.y) << 10) +
                               static_cast<std::uint32_t>(d.z);
    const auto [found, isNew] = cells.try_emplace(cell, static_cast<std::uint32_t>(out.positions.size()));
    if (isNew) {
      out.positions.push_back({0, 0, 0});
      counts.push_back(0);
    }
    newVertex.push_back(found->second);
    out.positions[found->second] = out.positions[found->second] + p;
    ++counts[found->second];
  }
  for (std::size_t v = 0; v < counts.size(); ++v) out.positions[v] = 1 / counts[v] * out.positions[v];
  for (const Triangle3& t : mesh.triangles) {
    const Triangle3 triangle = {newVertex[t[0]], newVertex[t[1]], newVertex[t[2]]};
    if (length(areaNormal(out, triangle)) > 0) out.triangles.push_back(triangle);
  }
  return out.empty() ? mesh : out;
}

/// Mirrors samples, and finds the points of the surface that are closest to them.
class Mirror {
 public:
  Mirror(const TriangleMesh& mesh, const Surface& surface)
      : surface_(surface),
        points_(spreadPoints(mesh, kSymmetrySamples)),
        diagonal_(diagonalOf(mesh)),
        middle_(meanOf(points_)) {}

  [[nodiscard]] const Vec3& middle() const { return middle_; }

  /// Sets the plane's residual, and moves it closer to what mirrors the trusted samples onto the surface.
  [[nodiscard]] MirrorPlane improved(MirrorPlane& plane) const {
    std::vector<Vec3> images;
    for (const Vec3& p : points_) images.push_back(plane.mirrored(p));
    const std::vector<SurfacePoint> found = surface_.closest(images);
    std::vector<std::size_t> order(found.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto trusted = static_cast<std::size_t>(kTrusted * static_cast<double>(order.size()));
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(trusted), order.end(),
                     [&](std::size_t a, std::size_t b) { return found[a].distance < found[b].distance; });
    double sum = 0;
    Vec3 across{0, 0, 0};
    for (std::size_t k = 0; k < trusted; ++k) {
      const Vec3 step = points_[order[k]] - found[order[k]].position;
      sum += found[order[k]].distance;
      // The plane's normal is along the steps from images to originals.
      const double side = dot(step, plane.left) < 0 ? -1 : 1;
      across = across + side * std::abs(dot(step, plane.left)) * step;
    }
    plane.residual = sum / static_cast<double>(trusted) / diagonal_;
    MirrorPlane next = plane;
    across.y = 0;
    if (length(across) > 0) next.left = 1 / length(across) * across;
    double offset = 0;
    for (std::size_t k = 0; k < trusted; ++k)
      offset += dot(next.left, 0.5 * (points_[order[k]] + found[order[k]].position));
    next.offset = offset / static_cast<double>(trusted);
    return next;
  }

 private:
  const Surface& surface_;
  std::vector<Vec3> points_;
  double diagonal_;
  Vec3 middle_;
};

/// The plane of a heading through the middle of the box, as seen along it.
MirrorPlane planeOf(const TriangleMesh& mesh, double angle) {
  MirrorPlane plane;
  plane.left = {std::cos(angle), 0, std::sin(angle)};
  const auto [low, high] = rangeOf(mesh.positions, plane.left);
  plane.offset = 0.5 * (low + high);
  return plane;
}

MirrorPlane refined(const Mirror& mirror, MirrorPlane plane) {
  MirrorPlane best = plane;
  best.residual = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kIterations; ++i) {
    const MirrorPlane next = mirror.improved(plane);
    const bool settled = plane.residual > kNoProgress * best.residual;
    if (plane.residual < best.residual) best = plane;
    if (settled) break;
    // Closest points on round surfaces pull by less than what is wanted: go further.
    const Vec3 left = next.left + kOverstep * (next.left - plane.left);
    plane = next;
    plane.left = 1 / length(left) * left;
  }
  // Round surfaces hardly pull at the heading: try it in smaller and smaller steps.
  for (double step = kFirstTurn; step > kLastTurn; step *= 0.5)
    for (const double turn : {-step, step}) {
      MirrorPlane turned = best;
      turned.left = {std::cos(turn) * best.left.x - std::sin(turn) * best.left.z, 0,
                     std::sin(turn) * best.left.x + std::cos(turn) * best.left.z};
      // Turned about the middle of the mesh, not about the origin.
      turned.offset = best.offset + dot(turned.left - best.left, mirror.middle());
      for (int round = 0; round < 2; ++round) {
        const MirrorPlane next = mirror.improved(turned);
        if (turned.residual < best.residual) best = turned;
        turned.offset +=
            next.offset - dot(next.left, mirror.middle()) - (turned.offset - dot(turned.left, mirror.middle()));
      }
    }
  return best;
}

}  // namespace

MirrorPlane refineMirrorPlane(const TriangleMesh& fine, const MirrorPlane& guess) {
  const TriangleMesh mesh = coarse(fine);
  const Surface surface(mesh);
  return refined(Mirror(mesh, surface), guess);
}

std::vector<MirrorPlane> findMirrorPlanes(const TriangleMesh& fine) {
  const TriangleMesh mesh = coarse(fine);
  const Surface surface(mesh);
  const Mirror mirror(mesh, surface);
  std::vector<MirrorPlane> planes;
  for (int i = 0; i < kHeadings; ++i) {
    planes.push_back(planeOf(mesh, std::numbers::pi * i / kHeadings));
    (void)mirror.improved(planes.back());
  }
  const MirrorPlane axis = planes[0];
  const auto better = [](const MirrorPlane& a, const MirrorPlane& b) { return a.residual < b.residual; };
  std::sort(planes.begin(), planes.end(), better);
  planes.insert(planes.begin(), axis);
  std::vector<MirrorPlane> out;
  for (std::size_t i = 0; i < planes.size() && i <= kRefined; ++i) {
    const MirrorPlane plane = refined(mirror, planes[i]);
    const auto same = std::find_if(out.begin(), out.end(), [&](const MirrorPlane& other) {
      return std::abs(dot(other.left, plane.left)) > kSameHeading;
    });
    if (same == out.end())
      out.push_back(plane);
    else if (better(plane, *same))
      *same = plane;
  }
  const double least = std::min_element(out.begin(), out.end(), better)->residual;
  std::erase_if(out, [&](const MirrorPlane& plane) { return plane.residual > kFarOff * least + kPlaneRounding; });
  // A round head has a mirror plane anywhere: then the file's own axes count.
  const auto rank = [&](const MirrorPlane& plane) {
    return plane.residual * (std::abs(plane.left.x) > kSameHeading ? kAxisPreference : 1);
  };
  std::sort(out.begin(), out.end(), [&](const MirrorPlane& a, const MirrorPlane& b) { return rank(a) < rank(b); });
  return out;
}

TriangleMesh within(const TriangleMesh& mesh, const Vec3& centre, double radius) {
  std::vector<bool> near(mesh.positions.size());
  for (std::size_t v = 0; v < near.size(); ++v) near[v] = length(mesh.positions[v] - centre) <= radius;
  std::vector<bool> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const Triangle3& triangle = mesh.triangles[t];
    keep[t] = near[triangle[0]] || near[triangle[1]] || near[triangle[2]];
  }
  return subset(mesh, keep);
}

}  // namespace cagecast::cages
