#pragma once

#include <array>
#include <vector>

#include "charts/unwrap.hpp"
#include "linear/sparse_system.hpp"

namespace cagecast::cages {

/// A triangle mesh that is flattened: the shapes that its triangles should keep, with weights.
struct RestShapes {
  /// Gradients of the three hat functions in the triangle's plane: J = sum of uv times gradient.
  using Gradients = std::array<std::array<double, 2>, 3>;
  std::vector<Gradients> gradients;
  std::vector<double> weights;  ///< Areas, times what the triangle counts.
};

RestShapes restShapesOf(const TriangleMesh& mesh);

/// Derivatives of a flattened triangle by its place in the plane: [[u by x, u by y], [v by x, v by y]].
struct Jacobian {
  double a = 0, b = 0, c = 0, d = 0;

  [[nodiscard]] double determinant() const { return a * d - b * c; }
  /// Of symmetric Dirichlet: 4 at best, infinite where the triangle is flipped.
  [[nodiscard]] double energy() const;
  /// The larger first.
  [[nodiscard]] std::array<double, 2> singularValues() const;
};

Jacobian jacobianOf(const RestShapes::Gradients& gradients, const Triangle3& triangle, const std::vector<Uv>& uvs);

/// Minimises symmetric Dirichlet energy by scalable locally injective mappings (Rabinovich et al. 2017): no triangle
/// that is not flipped ever flips.
class Slim {
 public:
  /// @param mesh  Connected; kept by reference.
  Slim(const TriangleMesh& mesh, RestShapes rest);

  /// One step from `uvs`, without a flipped triangle, to better ones.
  /// @return the share by which the energy fell; 0 if no step was found.
  double step(std::vector<Uv>& uvs);
  /// Weighted mean of the triangles'.
  [[nodiscard]] double energy(const std::vector<Uv>& uvs) const;

 private:
  const TriangleMesh& mesh_;
  RestShapes rest_;
  double weight_ = 0;
  SparseSystem system_;  ///< Of a step: a quadratic proxy of the energy.
  std::vector<double> right_;

  /// Sets up the system of a step.
  /// @return the energy.
  double assemble(const std::vector<Uv>& uvs);
  [[nodiscard]] double longestStep(const std::vector<Uv>& uvs, const std::vector<Uv>& direction) const;
};

}  // namespace cagecast::cages
