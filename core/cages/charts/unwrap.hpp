#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

using Uv = std::array<double, 2>;

struct UnwrapOptions {
  Kind kind = Kind::automatic;  ///< What the mesh is the cage of, which decides where the seams are.
  Vec3 up{0, 1, 0};             ///< Of unit length.
  Vec3 front{0, 0, 1};          ///< Of unit length, square to `up`.
  double gutter = 4.0 / 1024;   ///< Least distance between charts, and half of it to the border of the unit square.
};

/// A mesh with UVs: a vertex of the input has a copy for each chart, and for each side of a seam, that it is in.
struct Layout {
  std::vector<Vec3> positions;
  std::vector<Uv> uvs;                  ///< Per vertex, 0..1, v downwards as in glTF; exact as 32-bit floats.
  std::vector<Triangle3> triangles;     ///< In the order of the input.
  std::vector<std::uint32_t> vertexOf;  ///< The vertex of the input for each vertex.
  std::vector<std::uint32_t> chartOf;   ///< The chart of each triangle.
  std::uint32_t charts = 0;
};

/// Lays out a mesh in the unit square, in few charts that do not overlap, all at about the same texel density.
///
/// Heads get one chart, with a seam from the crown down the back; bodies are cut at neck, shoulders and hips, limbs
/// along their inside; props are cut where they turn from one side of their box to another. Charts stand upright and
/// seen from outside are not mirrored. Whatever the mesh is (open or closed, non-manifold, of any genus, in pieces),
/// the layout is valid; the worse the mesh, the more charts. Deterministic. About 0.2 s for 1500 triangles.
/// @param mesh  Finite positions; vertices shared where the surface goes on.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool unwrap(const TriangleMesh& mesh, const UnwrapOptions& options, const Progress& progress, Layout& out);

/// What is wrong with a layout, and how much it stretches. Stretch is that of triangles with an area, weighted by it.
struct LayoutFaults {
  std::uint32_t charts = 0;             ///< Pieces connected by shared vertices with the same UV.
  std::uint32_t overlaps = 0;           ///< Pairs of triangles whose insides meet; tested exactly.
  std::uint32_t flips = 0;              ///< Triangles turned the other way round than most, or without an area.
  std::uint32_t outside = 0;            ///< Vertices outside the unit square.
  double coverage = 0;                  ///< Share of the unit square that triangles take.
  double angleMedian = 1, angle95 = 1;  ///< Longest by shortest axis of the circle that becomes an ellipse: 1 is best.
  double areaMedian = 1, area95 = 1;    ///< Texel density against the mean, or its inverse if that is larger.
};

LayoutFaults layoutFaults(const std::vector<Vec3>& positions, const std::vector<Uv>& uvs,
                          const std::vector<Triangle3>& triangles);

}  // namespace cagecast::cages
