#pragma once

#include <array>
#include <span>
#include <vector>

#include "linear/sparse_system.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// Wants a point of a surface to lie in a plane.
struct PlaneTerm {
  Triangle3 corners;              ///< Of a triangle of the surface.
  std::array<double, 3> weights;  ///< Barycentric: where the point is.
  Vec3 point, normal;             ///< Of the plane.
  double strength = 1;
};

/// Finds the positions of a surface that is smoothly moved from a rest state into given planes: the minimum of
///
///   bending |L d|^2 + sliding |d - n (n d)|^2 + hold |d|^2 + damping |x - before|^2
///     + sum of strength (normal (x - point))^2,   d = x - rest,
///
/// with L a Laplacian, n the normals of the rest state.
class ThinPlate {
 public:
  struct Weights {
    double bending = 1;
    double sliding = 0;
    double hold = 0;  ///< Above 0, so that there is one minimum, whatever the planes.
    double damping = 0;
  };
  /// @param mesh  Its triangles are kept by reference; the positions do not count.
  /// @param bending  L'L, for one coordinate.
  ThinPlate(const TriangleMesh& mesh, std::vector<SparseEntry> bending);

  /// @param before  Is needed for damping.
  /// @param step  As of `SparseSystem::factorize`, which takes most of the time.
  /// @return The positions; empty if rounding lets there be none, or if it was cancelled.
  std::vector<Vec3> solve(const std::vector<Vec3>& rest, std::span<const PlaneTerm> planes, const Weights& weights,
                          std::span<const Vec3> before = {}, const StepCallback& step = {});

 private:
  const std::vector<Triangle3>& triangles_;
  std::vector<SparseEntry> bending_;
  SparseSystem system_;  ///< Of three coordinates per vertex.
};

}  // namespace cagecast::cages
