#pragma once

#include "base/arena.hpp"
#include "base/units.hpp"
#include "cage/boundary_loops.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/options.hpp"
#include "cagecast/status.hpp"
#include "input/cage.hpp"
#include "input/half_edges.hpp"
#include "input/weld.hpp"
#include "search/cage_tree.hpp"
#include "search/ray_tree.hpp"

namespace cagecast {

/// What all steps read: cage and target in scaled units, and what finds things in them quickly.
struct Scene {
  Scene(const MeshView& cageMesh_, const MeshView& targetMesh_, const TransferOptions& options_, Arena& arena_) noexcept
      : cageMesh(cageMesh_), targetMesh(targetMesh_), options(options_), arena(arena_) {}

  /// Checks the meshes, leaves out ignored parts, scales the cage and welds the target.
  Status load() noexcept;
  /// Builds the trees, and as far as the options need them the half-edges and the boundary loops.
  void buildTrees() noexcept;

  /// A length that is given as a share of the target's diagonal, scaled.
  [[nodiscard]] double length(double share) const noexcept { return share * units.diagonal; }

  const MeshView& cageMesh;
  MeshView targetMesh;  ///< Without ignored parts, once it is loaded.
  const TransferOptions& options;
  Arena& arena;

  Units units;
  Cage cage;
  Points points;  ///< The welded target.
  CageTree cageTree;
  RayTree targetTree;
  HalfEdges halfEdges;
  BoundaryLoops loops;
};

}  // namespace cagecast
