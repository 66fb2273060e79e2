#include "views/base_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cagecast::cages {

namespace {

/// Linear light, 0..1, of a byte of sRGB.
double linearOf(std::uint8_t byte) {
  static const std::array<double, 256> kTable = [] {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double share = static_cast<double>(i) / 255;
      table[i] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    }
    return table;
  }();
  return kTable[byte];
}

/// CIELAB of linear light, with the white of sRGB.
Vec3 labOf(const Vec3& light) {
  const auto curve = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = curve(dot({0.4124 / 0.9505, 0.3576 / 0.9505, 0.1805 / 0.9505}, light));
  const double y = curve(dot({0.2126, 0.7152, 0.0722}, light));
  const double z = curve(dot({0.0193 / 1.089, 0.1192 / 1.089, 0.9505 / 1.089}, light));
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

/// The barycentric weights of a point of a triangle.
std::array<double, 3> weightsAt(const std::array<Vec3, 3>& corners, const Vec3& point) {
  const auto [a, b, c] = corners;
  const Vec3 normal = cross(b - a, c - a);
  const double area = std::max(dot(normal, normal), 1e-300);
  const double second = dot(cross(point - a, c - a), normal) / area,
               third = dot(cross(b - a, point - a), normal) / area;
  return {1 - second - third, second, third};
}

/// A place on a line of pixels, for a coordinate that is repeated beyond 0..1.
std::size_t pixelAt(double coordinate, std::uint32_t count) {
  const double place = (coordinate - std::floor(coordinate)) * count;
  return std::min<std::size_t>(static_cast<std::size_t>(place), count - 1);
}

}  // namespace

std::optional<Vec3> baseColorAt(const Model& model, std::uint32_t triangle, const Vec3& point) {
  const std::uint32_t* corner = &model.mesh.indices[3 * std::size_t{triangle}];
  const std::size_t part = model.mesh.groups.empty() ? 0 : model.mesh.groups[corner[0]];
  const Image& image = model.baseColors[part].image;
  Vec3 light = Vec3::from(model.baseColors[part].factor.data());
  if (!image.pixels.empty()) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = Vec3::from(&model.mesh.positions[3 * std::size_t{corner[k]}]);
    const std::array<double, 3> weights = weightsAt(corners, point);
    double u = 0, v = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      u += weights[k] * static_cast<double>(model.mesh.uvs[2 * std::size_t{corner[k]}]);
      v += weights[k] * static_cast<double>(model.mesh.uvs[2 * std::size_t{corner[k]} + 1]);
    }
    if (!std::isfinite(u + v)) return std::nullopt;
    const std::uint8_t* pixel = &image.pixels[4 * (pixelAt(v, image.height) * image.width + pixelAt(u, image.width))];
    if (pixel[3] < 128) return std::nullopt;
    light = {light.x * linearOf(pixel[0]), light.y * linearOf(pixel[1]), light.z * linearOf(pixel[2])};
  }
  return labOf(light);
}

}  // namespace cagecast::cages
