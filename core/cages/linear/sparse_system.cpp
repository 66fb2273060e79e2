#include "linear/sparse_system.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <tuple>

namespace cagecast::cages {

struct SparseSystem::Factors : Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {};

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

bool SparseSystem::factorize() {
  const auto size = static_cast<Eigen::Index>(starts_.size() - 1);
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(size, size, static_cast<Eigen::Index>(values_.size()),
                                                             starts_.data(), rows_.data(), values_.data());
  if (factors_->rows() != size) factors_->analyzePattern(matrix);
  factors_->factorize(matrix);
  return factors_->info() == Eigen::Success;
}

std::vector<double> SparseSystem::solve(std::span<const double> right) const {
  std::vector<double> out(right.size());
  const auto size = static_cast<Eigen::Index>(right.size());
  Eigen::Map<Eigen::VectorXd>(out.data(), size) =
      factors_->solve(Eigen::Map<const Eigen::VectorXd>(right.data(), size));
  return out;
}

}  // namespace cagecast::cages
