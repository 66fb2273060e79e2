#pragma once

#include <array>
#include <cstdint>

namespace cagecast {

/// Positions along a three-dimensional Hilbert curve, so that neighbours in space are neighbours in memory.
/// After Hamilton and Rau-Chaplin, "Compact Hilbert indices" (2008), by table, two levels at a time.
/// Unlike Morton order it has no jumps.
class HilbertCurve {
 public:
  /// Makes its tables, in a microsecond: as constants they would be a tenth of the WebAssembly.
  HilbertCurve() noexcept {
    for (std::uint32_t x = 1; x < kSpreadable / 2; ++x) {
      spread_[2 * x] = spread_[x] << 3;
      spread_[2 * x + 1] = spread_[x] << 3 | 1;
    }
    for (std::uint32_t step = 0; step < kStates * 8; ++step) {
      const std::uint32_t first = kSteps[step];
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        doubleSteps_[8 * step + octant] = static_cast<std::uint16_t>(kSteps[first / 64 * 8 + octant] | (first & 7) << 3);
      }
    }
  }

  /// The place of a cell on the curve.
  /// @param x,y,z   The cell, 0 .. 2^levels − 1 on each axis.
  /// @param levels  Even, at most 10.
  [[nodiscard]] std::uint32_t key(std::uint32_t x, std::uint32_t y, std::uint32_t z, int levels) const noexcept {
    const std::uint32_t octants = spread_[x] | spread_[y] << 1 | spread_[z] << 2;
    std::uint32_t result = 0;
    std::uint32_t state = 0;
    for (int shift = 3 * levels - 6; shift >= 0; shift -= 6) {
      const std::uint32_t step = doubleSteps_[state | (octants >> shift & 63)];
      result = result << 6 | (step & 63);
      state = step & ~63u;
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kStates = 24;         ///< Entry corners times directions.
  static constexpr std::uint32_t kSpreadable = 1024;  ///< Numbers of ten bits.

  /// state times 8 | octant → next state times 64 | its place along the curve.
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

  /// The same for two octants, 64 times.
  std::array<std::uint16_t, kStates * 64> doubleSteps_;
  /// Two zeros between the bits of a number.
  std::array<std::uint32_t, kSpreadable> spread_{0, 1};
};

}  // namespace cagecast
