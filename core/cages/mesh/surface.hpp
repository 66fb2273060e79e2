#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The point of a surface that is closest to some point.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  Vec3 position{};
  std::array<double, 3> weights{};  ///< Barycentric, of the triangle's corners.
  double distance = 0;
  double height = 0;  ///< Of the point above the triangle's plane; negative behind it.
};

struct SurfaceRay {
  Vec3 origin;
  Vec3 direction;  ///< Of unit length.
};

/// Where a ray first meets a surface.
struct RayHit {
  double distance = 0;  ///< Infinite if it does not.
  std::uint32_t triangle = 0;
};

/// A mesh that closest points and rays are searched on, with the trees of `core/src/search`. It keeps a copy of what it
/// needs. Points and origins may be up to four diagonals away from it; for a point that is farther, as over a cage that
/// has shrunk to nothing, the result is only about the closest.
class Surface {
 public:
  /// @param mesh  At least one triangle; positions at most 1e6 diagonals from the origin. If all triangles are as small
  /// as rounding, its centre is the closest point of all, and no ray meets it.
  explicit Surface(const TriangleMesh& mesh);
  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;
  ~Surface();

  /// Quicker if points in a row are close together. A point with a NaN or infinity is infinitely far from triangle 0.
  [[nodiscard]] std::vector<SurfacePoint> closest(std::span<const Vec3> points) const;
  [[nodiscard]] SurfacePoint closest(const Vec3& point) const;

  /// How far rays go until they meet the surface; infinite if they do not.
  /// @param from  Hits at smaller distances do not count.
  [[nodiscard]] std::vector<double> distances(std::span<const SurfaceRay> rays, double from = 0) const;
  [[nodiscard]] double distance(const SurfaceRay& ray) const;
  /// The same with the triangles, for about twice the time.
  [[nodiscard]] std::vector<RayHit> trace(std::span<const SurfaceRay> rays, double from = 0) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace cagecast::cages
