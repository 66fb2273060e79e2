#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace cagecast {

/// Areas are added up as whole numbers of a tiny unit, so that the sums do not depend on the order of the triangles.
/// A triangle inside the box of a target of diagonal < 2 has an area < 2; the sum of all stays within 63 bits.
class AreaUnit {
 public:
  /// @param diagonal  Of the target, scaled: up to 14 where no float is small enough to scale it to less than 2.
  AreaUnit(std::uint32_t triangleCount, double diagonal)
      : perArea_(
            std::ldexp(1.0, 60 - static_cast<int>(std::bit_width(triangleCount)) - (diagonal < 2 ? 0 : kHugeBits))) {}
  /// What a triangle gives to each of its corners.
  [[nodiscard]] std::int64_t third(double doubleArea) const {
    return static_cast<std::int64_t>(doubleArea / 6 * perArea_);
  }
  /// What it gives to each of its four quarters.
  [[nodiscard]] std::int64_t quarter(double doubleArea) const {
    return static_cast<std::int64_t>(doubleArea / 8 * perArea_);
  }
  [[nodiscard]] double area(std::int64_t units) const { return static_cast<double>(units) * size_; }
  /// Cut to so few bits that doubles add such areas up exactly.
  [[nodiscard]] double summableArea(std::int64_t units) const { return area(units >> kCutBits << kCutBits); }

 private:
  static constexpr int kCutBits = 10;
  static constexpr int kHugeBits = 6;  // (14 / 2)² is less than 2⁶
  double perArea_;
  double size_ = 1 / perArea_;  ///< Exactly, as it is a power of two.
};

}  // namespace cagecast
