#pragma once

#include <array>
#include <memory>
#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

/// Wants a point of the cage to lie in a plane.
struct PlaneTerm {
  Triangle3 corners;
  std::array<double, 3> weights;  ///< Barycentric.
  Vec3 point, normal;             ///< Of the plane.
  double strength = 1;
};

/// Finds the positions of a cage that are smoothly moved from a rest state and lie in given planes: the minimum of
///
///   bending |L d|^2 + sliding |d - n (n d)|^2 + sum of strength (normal (x - point))^2,   d = x - rest,
///
/// with L the mean of the neighbours minus the vertex, n the normals of the rest state. Sparse Cholesky.
class Solver {
 public:
  explicit Solver(const TemplateCage& cage);
  ~Solver();

  struct Weights {
    double bending = 1;
    double sliding = 0;
  };
  /// @return The positions; `rest` if the system could not be solved.
  std::vector<Vec3> solve(const std::vector<Vec3>& rest, const std::vector<PlaneTerm>& planes, const Weights& weights);

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace cagecast::cages
