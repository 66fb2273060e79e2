#pragma once

#include <vector>

#include "geometry/vec3.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The vertical plane that mirrors a head or a figure: the points p with `dot(left, p) == offset`.
struct MirrorPlane {
  Vec3 left{1, 0, 0};  ///< Unit length, horizontal.
  double offset = 0;
  double residual = 0;  ///< Typical distance from a mirrored point to the surface, as a share of the diagonal.

  [[nodiscard]] Vec3 mirrored(const Vec3& p) const { return p - 2 * (dot(left, p) - offset) * left; }
};

/// The vertical mirror planes that a mesh may have, with any heading, most likely first: a few, for an egg's front is
/// like its back.
std::vector<MirrorPlane> findMirrorPlanes(const TriangleMesh& mesh);

/// The mirror plane close to a guess.
MirrorPlane refineMirrorPlane(const TriangleMesh& mesh, const MirrorPlane& guess);

/// A head's own space: the origin is in the middle between the eyes; x to its left, y up, z to its front; and a length
/// of 1 is about the diagonal of the box around head and neck.
struct HeadFrame {
  Vec3 origin{};
  Vec3 left{1, 0, 0};
  Vec3 up{0, 1, 0};
  Vec3 front{0, 0, 1};
  double unit = 1;

  [[nodiscard]] Vec3 toLocal(const Vec3& p) const {
    const Vec3 d = 1 / unit * (p - origin);
    return {dot(d, left), dot(d, up), dot(d, front)};
  }
  [[nodiscard]] Vec3 toModel(const Vec3& p) const { return origin + unit * (p.x * left + p.y * up + p.z * front); }
  [[nodiscard]] TriangleMesh toLocal(TriangleMesh mesh) const {
    for (Vec3& p : mesh.positions) p = toLocal(p);
    return mesh;
  }
};

/// The triangles with a corner within a distance of a point.
TriangleMesh within(const TriangleMesh& mesh, const Vec3& centre, double radius);

}  // namespace cagecast::cages
