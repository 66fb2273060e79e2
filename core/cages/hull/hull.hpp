#pragma once

#include <cstdint>
#include <optional>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Lengths are in the space of the model.
struct HullOptions {
  double closing = 0;          ///< Gaps narrower than twice this are bridged.
  double offset = 0;           ///< Distance of the hull from the model, at least.
  std::uint32_t voxels = 0;    ///< Along the longest side of the grid: 8 to 512.
  std::optional<Vec3> near{};  ///< Of several components, the one nearest to this point; by default the largest.
};

/// An open border of a mesh that is too wide for `HullOptions::closing` to bridge: the neck of a head without a body,
/// the bottom of a car.
struct Opening {
  std::vector<std::uint32_t> loop;  ///< Vertices of the border, with the mesh on its left.
  double width = 0;                 ///< The diagonal of the loop's bounding box.
};

/// The openings of a mesh that are wider than `width`, the widest first.
std::vector<Opening> findOpenings(const TriangleMesh& mesh, double width);

/// A copy of a mesh without openings that are wider than `width`: each is closed by a fan of triangles about a new
/// vertex in its middle, which come after the mesh's own. Without them a hull would line the inside of the mesh, too.
TriangleMesh closeOpenings(const TriangleMesh& mesh, double width);

/// A closed surface around a mesh, at a distance, that bridges gaps and mouths: one component, a manifold
/// with its normals outwards and no triangle without an area. Openings wider than twice `closing` are closed, as by
/// `closeOpenings`.
/// Cost: a head at 140 voxels takes half a second and 30 MB.
/// @param mesh  At least one triangle; positions finite.
/// @param[out] share  If not null: the volume of the hull, as a share of that of all components. Much less than 1 means
///   that the mesh is in several pieces, too far apart to be bridged.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool makeHull(const TriangleMesh& mesh, const HullOptions& options, const Progress& progress, TriangleMesh& out,
              double* share = nullptr);

}  // namespace cagecast::cages
