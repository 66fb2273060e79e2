#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace cagecast::cages {

/// A square matrix, row by row.
template <std::size_t n>
using SquareMatrix = std::array<std::array<double, n>, n>;

/// A direction that a matrix only stretches.
template <std::size_t n>
struct Eigenpair {
  double value = 0;
  std::array<double, n> vector{};  ///< Of unit length.
};

/// The eigenvectors of a symmetric matrix, by rising eigenvalues (Jacobi 1846). There are versions for n of 2, 3 and 4.
template <std::size_t n>
std::array<Eigenpair<n>, n> eigenpairsOf(SquareMatrix<n> matrix);

/// Solves a system of equations, by elimination with complete pivoting. Of what the matrix says nothing about, which
/// are rows or columns of zeros as far as rounding lets them be, the unknowns are 0.
/// @param matrix  n by n, row by row.
/// @param right  n rows of one or several right sides.
/// @return The unknowns, in the shape of `right`.
std::vector<double> solveDense(std::vector<double> matrix, std::vector<double> right, std::size_t n);

}  // namespace cagecast::cages
