#include "linear/sparse_system.hpp"

// Under a name of its own, as nanoflann in the core.
#define Eigen cagecast_Eigen
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <tuple>
#include <utility>

namespace cagecast::cages {

namespace {

/// Multiply-adds between two calls of the callback: a few milliseconds.
constexpr std::size_t kWorkPerStep = 1 << 22;

}  // namespace

/// Eigen's order of elimination and its solver, with a factorisation that can be followed: the same, row by row (LDL,
/// Davis 2005), to the bit.
struct SparseSystem::Factors : Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
  using Matrix = Eigen::SparseMatrix<double>;

  bool factorizeInSteps(const Eigen::Map<const Matrix>& matrix, const StepCallback& step) {
    Matrix upper(matrix.rows(), matrix.cols());
    upper.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
    const auto size = static_cast<int>(matrix.rows());
    // Each number of a column costs one operation for each that came before it.
    double all = 0;
    for (int k = 0; k < size; ++k) {
      const double count = m_matrix.outerIndexPtr()[k + 1] - m_matrix.outerIndexPtr()[k];
      all += 0.5 * count * (count + 1);
    }
    m_diag.resize(size);
    m_nonZerosPerCol.setZero();
    m_info = Eigen::NumericalIssue;
    m_factorizationIsOk = true;
    row_.assign(static_cast<std::size_t>(size), 0);
    visited_.assign(static_cast<std::size_t>(size), -1);
    std::size_t done = 0, reported = 0;
    for (int k = 0; k < size; ++k) {
      findPattern(upper, k);
      done += eliminate(k);
      if (m_diag[k] == 0) return false;
      if (!step || done - reported < kWorkPerStep) continue;
      reported = done;
      if (!step(static_cast<double>(done) / all)) return false;
    }
    m_info = Eigen::Success;
    return true;
  }

 private:
  std::vector<double> row_;          ///< Of the matrix, being eliminated; zero between rows.
  std::vector<int> visited_;         ///< Per column: the last row that has a number in it.
  std::vector<int> pattern_, path_;  ///< The columns in which a row has a number, in reverse order of elimination.

  /// Reads a row of the matrix, and finds in which columns it will have numbers: the paths from those that it has up
  /// the elimination tree.
  void findPattern(const Matrix& upper, int k) {
    pattern_.clear();
    visited_[static_cast<std::size_t>(k)] = k;
    for (Matrix::InnerIterator entry(upper, k); entry; ++entry) {
      auto i = static_cast<int>(entry.index());
      if (i > k) continue;
      row_[static_cast<std::size_t>(i)] += entry.value();
      path_.clear();
      for (; visited_[static_cast<std::size_t>(i)] != k; i = m_parent[i]) {
        path_.push_back(i);
        visited_[static_cast<std::size_t>(i)] = k;
      }
      pattern_.insert(pattern_.end(), path_.rbegin(), path_.rend());
    }
  }

  /// Solves for a row of L, and for its number of D. @return the multiply-adds.
  std::size_t eliminate(int k) {
    int* rows = m_matrix.innerIndexPtr();
    double* values = m_matrix.valuePtr();
    double diagonal = std::exchange(row_[static_cast<std::size_t>(k)], 0.0);
    std::size_t work = 0;
    for (auto at = pattern_.rbegin(); at != pattern_.rend(); ++at) {
      const int i = *at, begin = m_matrix.outerIndexPtr()[i], end = begin + m_nonZerosPerCol[i]++;
      const double value = std::exchange(row_[static_cast<std::size_t>(i)], 0.0);
      const double share = value / m_diag[i];
      for (int p = begin; p < end; ++p) row_[static_cast<std::size_t>(rows[p])] -= values[p] * value;
      diagonal -= share * value;
      rows[end] = k;
      values[end] = share;
      work += static_cast<std::size_t>(end - begin) + 1;
    }
    m_diag[k] = diagonal;
    return work;
  }
};

std::vector<SparseEntry> collapsed(std::vector<SparseEntry> entries) {
  const auto placeOf = [](const SparseEntry& entry) { return std::tie(entry.row, entry.column); };
  std::stable_sort(entries.begin(), entries.end(),
                   [&](const SparseEntry& a, const SparseEntry& b) { return placeOf(a) < placeOf(b); });
  std::size_t count = 0;
  for (const SparseEntry& entry : entries) {
    if (count > 0 && placeOf(entries[count - 1]) == placeOf(entry))
      entries[count - 1].value += entry.value;
    else
      entries[count++] = entry;
  }
  entries.resize(count);
  return entries;
}

std::vector<SparseEntry> squared(std::span<const SparseEntry> matrix, std::span<const double> weights) {
  std::vector<SparseEntry> out;
  for (std::size_t begin = 0, end = 0; begin < matrix.size(); begin = end) {
    const std::uint32_t row = matrix[begin].row;
    while (end < matrix.size() && matrix[end].row == row) ++end;
    const std::span<const SparseEntry> entries = matrix.subspan(begin, end - begin);
    for (const SparseEntry& a : entries)
      for (const SparseEntry& b : entries) out.push_back({a.column, b.column, weights[row] * a.value * b.value});
  }
  return collapsed(std::move(out));
}

SparseSystem::SparseSystem(std::size_t size, std::span<const SparseEntry> pattern)
    : factors_(std::make_unique<Factors>()), starts_(size + 1, 0) {
  std::vector<SparseEntry> places;
  places.reserve(size + pattern.size());
  for (std::uint32_t i = 0; i < size; ++i) places.push_back({i, i});
  for (const SparseEntry& entry : pattern)
    if (entry.row > entry.column) places.push_back({entry.column, entry.row});  // Sorted by what will be columns.
  for (const SparseEntry& place : collapsed(std::move(places))) {
    rows_.push_back(static_cast<int>(place.column));
    ++starts_[place.row + 1];
  }
  for (std::size_t i = 0; i < size; ++i) starts_[i + 1] += starts_[i];
  values_.resize(rows_.size());
}

SparseSystem::~SparseSystem() = default;

void SparseSystem::clear() { std::fill(values_.begin(), values_.end(), 0.0); }

double& SparseSystem::valueAt(std::uint32_t row, std::uint32_t column) {
  const auto first = rows_.begin() + starts_[column], last = rows_.begin() + starts_[column + 1];
  return values_[static_cast<std::size_t>(std::lower_bound(first, last, static_cast<int>(row)) - rows_.begin())];
}

bool SparseSystem::factorize(const StepCallback& step) {
  const auto size = static_cast<Eigen::Index>(starts_.size() - 1);
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(size, size, static_cast<Eigen::Index>(values_.size()),
                                                             starts_.data(), rows_.data(), values_.data());
  if (factors_->rows() != size) factors_->analyzePattern(matrix);
  if (step && !step(0)) return false;
  return factors_->factorizeInSteps(matrix, step);
}

std::vector<double> SparseSystem::solve(std::span<const double> right) const {
  std::vector<double> out(right.size());
  const auto size = static_cast<Eigen::Index>(right.size());
  Eigen::Map<Eigen::VectorXd>(out.data(), size) =
      factors_->solve(Eigen::Map<const Eigen::VectorXd>(right.data(), size));
  return out;
}

}  // namespace cagecast::cages
