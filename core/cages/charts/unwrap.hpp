#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"
#include "views/face_frame.hpp"

namespace cagecast::cages {

using Uv = std::array<double, 2>;

struct UnwrapOptions {
  Kind kind = Kind::automatic;         ///< What the mesh is the cage of, which decides where the seams are.
  Vec3 up{0, 1, 0};                    ///< Of unit length.
  Vec3 front{0, 0, 1};                 ///< Of unit length, square to `up`.
  std::optional<FaceFrame> face = {};  ///< Where seams would show most; nothing if that is not known.
  double gutter = 4.0 / 1024;  ///< Least distance between charts, and half of it to the border of the unit square.
};

/// A mesh with UVs: a vertex of the input has a copy for each chart, and for each side of a seam, that it is in.
struct Layout {
  TriangleMesh mesh;    ///< Triangles are in the order of the input.
  std::vector<Uv> uvs;  ///< Per vertex, 0..1, v downwards as in glTF; exact as 32-bit floats.
};

/// Lays out a mesh in the unit square, in few charts that do not overlap, all at about the same texel density.
///
/// Heads get one chart, with a seam from the crown down the back; bodies are cut at neck, shoulders and hips, limbs
/// along their inside; props are cut where they turn from one side of their box to another. A face that seams would run
/// over is a chart of its own, cut where it turns from the front. Charts stand upright and seen from outside are not
/// mirrored. Whatever the mesh is (open or closed, non-manifold, of any genus, in pieces), the layout is valid; the
/// worse the mesh, the more charts. Deterministic. About 0.2 s for 1500 triangles.
/// @param mesh  Finite positions; vertices shared where the surface goes on.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool unwrap(const TriangleMesh& mesh, const UnwrapOptions& options, const Progress& progress, Layout& out);

}  // namespace cagecast::cages
