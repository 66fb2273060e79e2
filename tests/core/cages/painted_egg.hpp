#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "shapes.hpp"

/// Heads whose faces are only painted.
namespace cagecast::cages {

using Bytes = std::array<std::uint8_t, 3>;

inline constexpr std::uint32_t kSide = 256;
inline constexpr Vec3 kEye{0.27, 0.05, 0}, kMouth{0, -0.45, 0};

/// What is painted on an egg.
struct Look {
  Bytes skin{224, 172, 140}, hair{70, 45, 30}, white{240, 240, 240}, iris{60, 90, 140}, lips{180, 90, 90};
  double eye = 0.13;       ///< Half the width of an eye.
  double hairline = 0.45;  ///< Its height above the eyes.
  double beard = -2;       ///< The height that it begins at.
  bool hasFace = true;
};

/// The colour at a place of the front, whose corners are -1 and 1.
inline Bytes colorAt(const Look& look, double x, double y) {
  const auto isWithin = [](double across, double up) { return across * across + up * up < 1; };
  if (look.hasFace) {
    const double across = std::abs(x) - kEye.x, up = y - kEye.y;
    if (isWithin(across / (0.4 * look.eye), up / (0.4 * look.eye))) return look.iris;
    if (isWithin(across / look.eye, up / (0.6 * look.eye))) return look.white;
    if (std::abs(across) < 1.2 * look.eye && std::abs(up - 0.22) < 0.025) return look.hair;  // A brow.
    if (isWithin(x / 0.2, (y - kMouth.y) / 0.06)) return look.lips;
  }
  return y > kEye.y + look.hairline || std::abs(x) > 0.6 || y < look.beard ? look.hair : look.skin;
}

/// An egg that faces +z, with a face that is painted on.
struct PaintedEgg {
  OwnedModel owned;
  std::vector<std::uint8_t> pixels;

  explicit PaintedEgg(const Look& look) {
    owned.add("egg", ellipsoid({0, 0, 0}, {0.7, 1, 0.85}, 40));
    for (std::size_t i = 0; i < owned.positions.size(); i += 3) {
      const bool isFront = owned.positions[i + 2] > 0;
      owned.uvs.push_back(isFront ? 0.5f + 0.5f * owned.positions[i] : 0.001f);
      owned.uvs.push_back(isFront ? 0.5f - 0.5f * owned.positions[i + 1] : 0.001f);
    }
    for (std::uint32_t row = 0; row < kSide; ++row)
      for (std::uint32_t column = 0; column < kSide; ++column) {
        const Bytes color = colorAt(look, 2 * (column + 0.5) / kSide - 1, 1 - 2 * (row + 0.5) / kSide);
        pixels.insert(pixels.end(), {color[0], color[1], color[2], 255});
      }
  }
  [[nodiscard]] Model model() const {
    Model out = owned.model();
    out.baseColors = {{.image = {kSide, kSide, pixels}}};
    return out;
  }
  [[nodiscard]] std::vector<Landmark> landmarks(const std::function<void(Model&)>& change = {}) const {
    Model model = this->model();
    if (change) change(model);
    FoundLandmarks out;
    const Status status = findLandmarks(model, nullptr, out);
    INFO(describe(status, model));
    REQUIRE(status.ok());
    return out.landmarks;
  }
};

}  // namespace cagecast::cages
