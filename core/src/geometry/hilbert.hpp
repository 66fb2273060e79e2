#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace cagecast {

/// Positions along a three-dimensional Hilbert curve. Sorting points by them makes neighbours in space neighbours in
/// memory; unlike Morton order, the curve has no jumps. After Hamilton and Rau-Chaplin, "Compact Hilbert indices"
/// (2008), with a table for two levels at a time.
class HilbertCurve {
 public:
  /// Computes the tables, which takes a microsecond. As constants they would be a tenth of the WebAssembly.
  /// @param levels  6, 8 or 10: the grid has 2^levels cells on each axis.
  explicit HilbertCurve(int levels) noexcept : unused_(kBits - 3 * levels) {
    // The octant of the first level is in the highest three bits.
    spread_[1] = 1u << unused_;
    for (std::size_t x = 1; x < std::size_t{1} << (levels - 1); ++x) {
      spread_[2 * x] = spread_[x] << 3;
      spread_[2 * x + 1] = spread_[x] << 3 | spread_[1];
    }
    // The second step begins in the state that the first one leads to. Four 16-bit entries are written at a time.
    for (std::size_t step = 0; step < kSteps.size(); ++step) {
      std::uint64_t row[2];
      std::memcpy(row, &kSteps[kSteps[step] / 64 * std::size_t{8}], sizeof row);
      for (std::uint64_t& four : row) four |= (kSteps[step] & 7) * std::uint64_t{0x0008'0008'0008'0008};
      std::memcpy(&doubleSteps_[8 * step], row, sizeof row);
    }
  }

  /// The position of a cell along the curve, less than 8^levels.
  /// @param x,y,z  The cell, 0 .. 2^levels − 1 on each axis.
  [[nodiscard]] std::uint32_t key(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
    const std::uint32_t octants = spread_[x] | spread_[y] << 1 | spread_[z] << 2;
    std::uint32_t result = 0;
    std::size_t state = 0;
    const auto takeTwoLevels = [&](int shift) {
      const std::size_t step = doubleSteps_[state | (octants >> shift & 63)];
      result = result << 6 | (step & 63);
      state = step & ~std::size_t{63};
    };
    takeTwoLevels(24);
    takeTwoLevels(18);
    takeTwoLevels(12);
    if (unused_ <= 6) {
      takeTwoLevels(6);
      if (unused_ == 0) takeTwoLevels(0);
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kStates = 24;  ///< Entry corners times directions.
  static constexpr int kBits = 30;              ///< Three times ten.

  /// [state · 8 | octant] is the next state · 64 | the octant's position along the curve.
  static constexpr auto kSteps = [] {
    const auto rotateRight = [](unsigned bits, unsigned by) { return (bits >> by | bits << (3 - by)) & 7; };
    const auto rotateLeft = [](unsigned bits, unsigned by) { return (bits << by | bits >> (3 - by)) & 7; };
    const auto trailingOnes = [](unsigned i) {
      unsigned count = 0;
      for (; i & 1; i >>= 1) ++count;
      return count;
    };
    std::array<std::uint16_t, kStates * 8> steps{};
    for (unsigned i = 0; i < kStates * 8; ++i) {
      const unsigned direction = i / 64;
      const unsigned entry = i / 8 % 8;
      const unsigned turn = (direction + 1) % 3;
      const unsigned gray = rotateRight(i % 8 ^ entry, turn);
      const unsigned place = gray ^ gray >> 1 ^ gray >> 2;
      const unsigned even = place == 0 ? 0 : (place - 1) / 2 * 2;
      const unsigned entered = place == 0 ? 0 : even ^ even >> 1;
      const unsigned along = place == 0 ? 0 : trailingOnes(place % 2 == 0 ? place - 1 : place) % 3;
      const unsigned next = (direction + along + 1) % 3 * 8 + (entry ^ rotateLeft(entered, turn));
      steps[i] = static_cast<std::uint16_t>(next * 64 + place);
    }
    return steps;
  }();

  /// The same for two levels: [state · 64 | two octants].
  std::array<std::uint16_t, kStates * 64> doubleSteps_;
  /// Numbers with two zeros between their bits.
  std::array<std::uint32_t, 1024> spread_{0};
  int unused_;  ///< Bits below the last octant.
};

}  // namespace cagecast
