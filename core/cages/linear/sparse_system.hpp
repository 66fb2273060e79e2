#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace cagecast::cages {

/// A number of a sparse matrix.
struct SparseEntry {
  std::uint32_t row = 0, column = 0;
  double value = 0;
};

/// Adds up entries at the same place, in their order. The result is sorted by rows, then by columns.
std::vector<SparseEntry> collapsed(std::vector<SparseEntry> entries);

/// The entries of A' W A, with a diagonal matrix W.
/// @param matrix  Of A, collapsed.
/// @param weights  W: one per row of A.
std::vector<SparseEntry> squared(std::span<const SparseEntry> matrix, std::span<const double> weights);

/// Gets the share of some work that is done; returns false to cancel it.
using StepCallback = std::function<bool(double share)>;

/// A system of equations with a symmetric, positive definite matrix, whose pattern stays: sparse Cholesky (LDL'), by
/// Eigen. No other file includes Eigen, which takes seconds to compile.
class SparseSystem {
 public:
  /// @param size  How many unknowns there are.
  /// @param pattern  The places where the matrix is not 0, besides its diagonal; the values do not count.
  SparseSystem(std::size_t size, std::span<const SparseEntry> pattern);
  ~SparseSystem();
  SparseSystem(const SparseSystem&) = delete;
  SparseSystem& operator=(const SparseSystem&) = delete;

  /// Sets the matrix to 0.
  void clear();
  /// Adds to a place of the pattern. Those above the diagonal are left out: they are the same as below.
  void add(std::uint32_t row, std::uint32_t column, double value) {
    if (row >= column) valueAt(row, column) += value;
  }
  /// @param step  Called every few milliseconds with the share of the work that is done; false cancels.
  /// @return false if the matrix is not positive definite, or if it was cancelled.
  bool factorize(const StepCallback& step = {});
  /// @param right  The right side. @return The unknowns.
  [[nodiscard]] std::vector<double> solve(std::span<const double> right) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
  // The lower triangle, column by column.
  std::vector<int> starts_, rows_;
  std::vector<double> values_;

  double& valueAt(std::uint32_t row, std::uint32_t column);
};

}  // namespace cagecast::cages
