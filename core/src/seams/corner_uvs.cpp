#include "seams/corner_uvs.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "cage/uv_charts.hpp"
#include "geometry/triangle.hpp"
#include "seams/seam_resolver.hpp"
#include "simd/simd.hpp"

namespace cagecast {
namespace {

/// Tells in float which target triangles surely lie across no seam: most of them.
class SeamFilter {
 public:
  /// Allocates its working memory; check `scene.arena.failed()` afterwards.
  SeamFilter(const Scene& scene, const UvCharts& charts, const PointData& data) noexcept
      : positions_(data.points.positions), samples_(scene.arena.allocate<Sample>(data.points.count)) {
    const std::uint32_t cageCount = scene.cage.count;
    auto* explained = scene.arena.allocate<float>(cageCount);
    if (scene.arena.failed()) return;
    const bool isUsable = charts.maxUv <= kMaxUv && cageCount <= kMaxCharts;
    for (std::uint32_t t = 0; t < cageCount; ++t) {
      // Finite, so that its product with 0 is a number. Without any explained length no triangle passes.
      const double ofTriangle = std::min(kSmearShare * charts.stretch[t] * charts.stretch[t], 1e30);
      explained[t] = isUsable ? static_cast<float>(ofTriangle) : -std::numeric_limits<float>::infinity();
    }
    for (std::uint32_t i = 0; i < data.points.count; ++i) {
      const std::uint32_t t = data.cageTriangles[i];
      samples_[i] = {data.uvs[2 * i], data.uvs[2 * i + 1], explained[t], static_cast<float>(charts.charts[t])};
    }
  }

  /// Whether a triangle surely lies across no seam.
  /// @param triangle  3 points.
  [[nodiscard]] bool isWhole(const std::uint32_t* triangle) const noexcept {
    const simd::f32x4 zero = simd::splat(0);
    const simd::mask4 isThird = zero < simd::of(0.0f, 0.0f, 1.0f, 0.0f);  // Not a difference, but the greater one.
    simd::f32x4 edges[4], inUv[4];                                        // Per edge, then, transposed, per field.
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
      edges[k] = simd::load(positions_ + Points::kStride * to) - simd::load(positions_ + Points::kStride * from);
      const simd::f32x4 a = simd::load(&samples_[from].u), b = simd::load(&samples_[to].u);
      inUv[k] = simd::select(isThird, simd::max(a, b), b - a);
    }
    edges[3] = inUv[3] = zero;
    auto& [x, y, z, unused] = edges;
    auto& [u, v, explained, chart] = inUv;
    simd::transpose(x, y, z, unused);
    simd::transpose(u, v, explained, chart);
    const simd::f32x4 squared = simd::multiplyAdd(z, z, simd::multiplyAdd(y, y, x * x));
    const simd::f32x4 limit = simd::multiplyAdd(explained, squared, simd::splat(static_cast<float>(kSlackShare)));
    const simd::f32x4 squaredInUv = simd::multiplyAdd(v, v, u * u);
    return simd::bits((squaredInUv <= limit) & (chart * chart <= zero)) == 0xF;
  }

 private:
  /// UVs up to here are exact enough in float: off by at most a hundredth of the slack.
  static constexpr float kMaxUv = 256;
  /// Numbers up to here are exact in float.
  static constexpr std::uint32_t kMaxCharts = 1u << 24;
  /// The filter allows the sum of the squares of explained length and slack, which is less than the square of their
  /// sum; these factors leave room for rounding besides.
  static constexpr double kSmearShare = 0.99 * kSmear * kSmear;
  static constexpr double kSlackShare = 0.9 * kSmearSlack * kSmearSlack;

  /// The closest point of a point of the target: one SIMD load.
  struct alignas(16) Sample {
    float u, v;
    float explained;  ///< Squared UV length that the cage explains, per squared length.
    float chart;
  };

  const float* positions_;
  Sample* samples_;
};

/// The points of all target triangles; those without an area are not in `Points::triangles`.
/// @return Null if memory ran out.
const std::uint32_t* pointsOfTriangles(std::span<const std::uint32_t> indices, const Points& points, Arena& arena) {
  if (std::size_t{3} * points.triangleCount == indices.size()) return points.triangles;
  auto* all = arena.allocate<std::uint32_t>(indices.size());
  if (arena.failed()) return nullptr;
  for (std::size_t i = 0; i < indices.size(); ++i) all[i] = points.ofVertex[indices[i]];
  return all;
}

}  // namespace

void projectCorners(const Scene& scene, const PointData& data, Array<float>& cornerUvs) noexcept {
  const std::span<const std::uint32_t> indices = scene.targetMesh.indices;
  if (scene.arena.failed()) return;
  if (!cornerUvs.reset(2 * indices.size())) return scene.arena.fail();
  const Points& points = data.points;
  const Arena::Scope scope(scene.arena);
  UvCharts charts;
  if (!findUvCharts(scene.cage, scene.halfEdges, scene.arena, charts)) return;
  SeamResolver resolver(scene, charts);
  const SeamFilter filter(scene, charts, data);
  const std::uint32_t* corners = pointsOfTriangles(indices, points, scene.arena);
  if (scene.arena.failed()) return;

  for (std::size_t first = 0; first < indices.size(); first += 3) {
    const std::uint32_t* triangle = corners + first;
    float* uvs = cornerUvs.data() + 2 * first;
    for (std::size_t c = 0; c < 3; ++c)
      std::memcpy(uvs + 2 * c, data.uvs + std::size_t{2} * triangle[c], 2 * sizeof(float));
    if (filter.isWhole(triangle)) continue;
    const Vec3 normal = areaNormal(points.at(triangle[0]), points.at(triangle[1]), points.at(triangle[2]));
    if (dot(normal, normal) > 0) resolver.add(data, triangle, uvs);
  }
  resolver.finish();
}

}  // namespace cagecast
