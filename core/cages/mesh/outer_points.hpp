#pragma once

#include <array>
#include <limits>
#include <vector>

#include "mesh/surface.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The open edges of a mesh, to ask whether the closest point of something is on them: then it is beyond the mesh.
class OpenBorder {
 public:
  explicit OpenBorder(const TriangleMesh& mesh);

  [[nodiscard]] bool has(const Triangle3& corners, const SurfacePoint& point) const;

 private:
  std::vector<std::array<bool, 3>> isOpen_;  ///< Per triangle: edge i runs from corner i.
  std::vector<bool> isBorder_;               ///< Per vertex: it is an end of an open edge.
};

/// Points that a cage must not fall behind.
struct OuterPoints {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< About those of the cage where it belongs to the points; of unit length, or 0.
};

/// Which of them count.
struct OuterRules {
  double minCosine = 0;                                    ///< Of the angle between a point's normal and the cage's.
  double clearance = 0;                                    ///< How far points should be behind the cage.
  double reach = std::numeric_limits<double>::infinity();  ///< Points farther away do not count.
};

/// How far each vertex of a cage has to move along its normal so that points are behind it; empty if all of them are.
/// @param border  Of the cage. Points beyond it are let out.
std::vector<double> missingMoves(const TriangleMesh& cage, const OpenBorder& border, const OuterPoints& points,
                                 const OuterRules& rules);

}  // namespace cagecast::cages
