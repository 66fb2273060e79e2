#pragma once

#include <array>
#include <vector>

#include "mesh/surface.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The open edges of a mesh, to ask whether the closest point of something is on them: then it is beyond the mesh.
class OpenBorder {
 public:
  explicit OpenBorder(const TriangleMesh& mesh);

  [[nodiscard]] bool has(const SurfacePoint& point) const;

 private:
  std::vector<Triangle3> triangles_;
  std::vector<std::array<bool, 3>> isOpen_;  ///< Per triangle: edge i runs from corner i.
  std::vector<bool> isBorder_;               ///< Per vertex: it is an end of an open edge.
};

}  // namespace cagecast::cages
