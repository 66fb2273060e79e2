#pragma once

#include <array>
#include <cstdint>

namespace cagecast {

/// Positions along a three-dimensional Hilbert curve, so that neighbours in space are neighbours in memory.
/// After Hamilton and Rau-Chaplin, "Compact Hilbert indices" (2008), by table, two levels at a time.
/// Unlike Morton order it has no jumps.
class HilbertCurve {
 public:
  /// The place of a cell on the curve.
  /// @param x,y,z   The cell, 0 .. 2^levels − 1 on each axis.
  /// @param levels  Even, at most 10.
  static std::uint32_t key(std::uint32_t x, std::uint32_t y, std::uint32_t z, int levels) noexcept {
    const std::uint32_t octants = spread(x) | spread(y) << 1 | spread(z) << 2;
    std::uint32_t result = 0;
    std::uint32_t state = 0;
    for (int shift = 3 * levels - 6; shift >= 0; shift -= 6) {
      const std::uint32_t step = kDoubleSteps[state | (octants >> shift & 63)];
      result = result << 6 | (step & 63);
      state = step & ~63u;
    }
    return result;
  }

 private:
  /// Puts two zeros between the bits of a number of up to ten bits.
  static std::uint32_t spread(std::uint32_t x) noexcept { return kSpread[x & 255] | kSpread[x >> 8] << 24; }

  static constexpr auto kSpread = [] {
    std::array<std::uint32_t, 256> spread{};
    for (std::uint32_t x = 0; x < 256; ++x) {
      for (std::uint32_t bit = 0; bit < 8; ++bit) spread[x] |= (x >> bit & 1) << 3 * bit;
    }
    return spread;
  }();

  /// state (entry corner and direction, times 64) | two octants → next state | their place along the curve.
  static constexpr auto kDoubleSteps = [] {
    struct Step {
      unsigned entry, direction, place;
    };
    const auto rotateRight = [](unsigned bits, unsigned by) { return (bits >> by | bits << (3 - by)) & 7; };
    const auto rotateLeft = [](unsigned bits, unsigned by) { return (bits << by | bits >> (3 - by)) & 7; };
    const auto trailingOnes = [](unsigned i) {
      unsigned count = 0;
      for (; i & 1; i >>= 1) ++count;
      return count;
    };
    const auto step = [&](unsigned entry, unsigned direction, unsigned octant) {
      const unsigned turn = (direction + 1) % 3;
      const unsigned gray = rotateRight(octant ^ entry, turn);
      const unsigned place = gray ^ gray >> 1 ^ gray >> 2;
      const unsigned even = place == 0 ? 0 : (place - 1) / 2 * 2;
      const unsigned entered = place == 0 ? 0 : even ^ even >> 1;
      const unsigned along = place == 0 ? 0 : trailingOnes(place % 2 == 0 ? place - 1 : place) % 3;
      return Step{entry ^ rotateLeft(entered, turn), (direction + along + 1) % 3, place};
    };
    std::array<std::uint16_t, 24 * 64> steps{};
    for (unsigned state = 0; state < 24; ++state) {
      for (unsigned octants = 0; octants < 64; ++octants) {
        const Step first = step(state % 8, state / 8, octants >> 3);
        const Step second = step(first.entry, first.direction, octants & 7);
        steps[state * 64 + octants] =
            static_cast<std::uint16_t>((second.direction * 8 + second.entry) * 64 + first.place * 8 + second.place);
      }
    }
    return steps;
  }();
};

}  // namespace cagecast
