#include "linear/dense.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cagecast::cages {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Turns the axes p and q of a matrix so that its entry there becomes 0; the directions turn along.
template <std::size_t n>
void rotate(SquareMatrix<n>& matrix, SquareMatrix<n>& directions, std::size_t p, std::size_t q) {
  const double ratio = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q]);
  const double tangent = std::copysign(1.0, ratio) / (std::abs(ratio) + std::sqrt(ratio * ratio + 1));
  const double cosine = 1 / std::sqrt(tangent * tangent + 1), sine = tangent * cosine;
  const auto turn = [&](double& x, double& y) {
    const double before = x;
    x = cosine * before - sine * y;
    y = sine * before + cosine * y;
  };
  for (std::size_t k = 0; k < n; ++k) turn(matrix[k][p], matrix[k][q]);
  for (std::size_t k = 0; k < n; ++k) turn(matrix[p][k], matrix[q][k]);
  for (std::size_t k = 0; k < n; ++k) turn(directions[p][k], directions[q][k]);
}

}  // namespace

template <std::size_t n>
std::array<Eigenpair<n>, n> eigenpairsOf(SquareMatrix<n> matrix) {
  constexpr int kMaxSweeps = 30;  // Six do for most.
  SquareMatrix<n> directions{};
  for (std::size_t k = 0; k < n; ++k) directions[k][k] = 1;
  bool isDiagonal = false;
  for (int sweep = 0; sweep < kMaxSweeps && !isDiagonal; ++sweep) {
    isDiagonal = true;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) {
        const double rounding = kEpsilon * std::sqrt(std::abs(matrix[p][p])) * std::sqrt(std::abs(matrix[q][q]));
        if (!(std::abs(matrix[p][q]) > rounding)) continue;
        isDiagonal = false;
        rotate(matrix, directions, p, q);
      }
  }
  std::array<Eigenpair<n>, n> pairs;
  for (std::size_t k = 0; k < n; ++k) pairs[k] = {matrix[k][k], directions[k]};
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Eigenpair<n>& a, const Eigenpair<n>& b) { return a.value < b.value; });
  return pairs;
}

template std::array<Eigenpair<2>, 2> eigenpairsOf(SquareMatrix<2>);
template std::array<Eigenpair<3>, 3> eigenpairsOf(SquareMatrix<3>);
template std::array<Eigenpair<4>, 4> eigenpairsOf(SquareMatrix<4>);

std::vector<double> solveDense(std::vector<double> matrix, std::vector<double> right, std::size_t n) {
  const std::size_t sides = right.size() / n;
  std::vector<std::size_t> unknowns(n);  // Where columns are swapped to.
  std::iota(unknowns.begin(), unknowns.end(), std::size_t{0});
  std::size_t rank = 0;
  for (double least = 0; rank < n; ++rank) {
    std::size_t row = rank, column = rank;
    for (std::size_t i = rank; i < n; ++i)
      for (std::size_t k = rank; k < n; ++k)
        if (std::abs(matrix[i * n + k]) > std::abs(matrix[row * n + column])) row = i, column = k;
    const double pivot = matrix[row * n + column];
    if (rank == 0) least = kEpsilon * static_cast<double>(n) * std::abs(pivot);
    if (!(std::abs(pivot) > least)) break;
    std::swap_ranges(&matrix[row * n], &matrix[row * n] + n, &matrix[rank * n]);
    std::swap_ranges(&right[row * sides], &right[row * sides] + sides, &right[rank * sides]);
    for (std::size_t i = 0; i < n; ++i) std::swap(matrix[i * n + column], matrix[i * n + rank]);
    std::swap(unknowns[column], unknowns[rank]);
    for (std::size_t i = rank + 1; i < n; ++i) {
      const double factor = matrix[i * n + rank] / pivot;
      for (std::size_t k = rank; k < n; ++k) matrix[i * n + k] -= factor * matrix[rank * n + k];
      for (std::size_t s = 0; s < sides; ++s) right[i * sides + s] -= factor * right[rank * sides + s];
    }
  }
  std::vector<double> out(right.size(), 0.0);
  for (std::size_t i = rank; i-- > 0;)
    for (std::size_t s = 0; s < sides; ++s) {
      double sum = right[i * sides + s];
      for (std::size_t k = i + 1; k < rank; ++k) sum -= matrix[i * n + k] * out[unknowns[k] * sides + s];
      out[unknowns[i] * sides + s] = sum / matrix[i * n + i];
    }
  return out;
}

}  // namespace cagecast::cages
