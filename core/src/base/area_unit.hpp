#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace cagecast {

/// Areas are added up as whole multiples of a tiny unit, so that sums do not depend on the order of the triangles.
/// A triangle in the bounding box of a target whose diagonal is less than 2 has an area less than 2; the sum of all
/// triangles stays within 63 bits.
class AreaUnit {
 public:
  /// @param sizeBits  If the box is larger: its diagonal is less than 2^(1 + sizeBits).
  explicit AreaUnit(std::uint32_t triangleCount, int sizeBits = 0)
      : perArea_(std::ldexp(1.0, 60 - static_cast<int>(std::bit_width(triangleCount)) - 2 * sizeBits)) {}
  /// What a triangle gives to each of its corners.
  [[nodiscard]] std::int64_t third(double doubleArea) const { return rounded(doubleArea / 6); }
  /// What a triangle gives to each of its four interior samples.
  [[nodiscard]] std::int64_t quarter(double doubleArea) const { return rounded(doubleArea / 8); }
  [[nodiscard]] double area(std::int64_t units) const { return static_cast<double>(units) * size_; }
  /// The area cut to so few bits that sums of such areas in doubles are exact.
  [[nodiscard]] double summableArea(std::int64_t units) const { return area(units >> kCutBits << kCutBits); }

 private:
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): areas are not negative, and `lround` is a call.
  [[nodiscard]] std::int64_t rounded(double area) const { return static_cast<std::int64_t>(area * perArea_ + 0.5); }

  static constexpr int kCutBits = 10;
  double perArea_;
  double size_ = 1 / perArea_;  ///< Exact: a power of two.
};

}  // namespace cagecast
