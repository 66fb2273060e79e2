#pragma once

#include <tiny_gltf.h>

#include <array>
#include <cstddef>
#include <string>

namespace cagecast::gltf {

/// A 3×4 affine transform, row by row.
struct Transform {
  std::array<double, 12> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  Transform operator*(const Transform& other) const {
    Transform product;
    for (std::size_t row = 0; row < 12; row += 4)
      for (std::size_t column = 0; column < 4; ++column)
        product.m[row + column] = m[row] * other.m[column] + m[row + 1] * other.m[4 + column] +
                                  m[row + 2] * other.m[8 + column] + (column == 3 ? m[row + 3] : 0);
    return product;
  }
  bool operator==(const Transform&) const = default;

  /// The factor of volume; negative if it mirrors.
  double determinant() const {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
  }

  /// The determinant must not be 0.
  Transform inverse() const {
    const double whole = determinant();
    const auto minor = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
      return (m[a] * m[d] - m[b] * m[c]) / whole;
    };
    Transform out;
    out.m = {minor(5, 6, 9, 10), minor(2, 1, 10, 9), minor(1, 2, 5, 6), 0,
             minor(6, 4, 10, 8), minor(0, 2, 8, 10), minor(2, 0, 6, 4), 0,
             minor(4, 5, 8, 9),  minor(1, 0, 9, 8),  minor(0, 1, 4, 5), 0};
    for (std::size_t row = 0; row < 12; row += 4)
      out.m[row + 3] = -(out.m[row] * m[3] + out.m[row + 1] * m[7] + out.m[row + 2] * m[11]);
    return out;
  }
};

/// The transform that 16 numbers of glTF are, column by column.
inline Transform transformOf(const double* matrix) {
  Transform transform;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) transform.m[row * 4 + column] = matrix[column * 4 + row];
  return transform;
}

/// A primitive in its place in the scene.
struct Instance {
  const tinygltf::Mesh& mesh;
  const tinygltf::Primitive& primitive;
  std::string where, name;  ///< In the file, and for people.
  Transform world;
  int node;
  int skin;                            ///< −1: none.
  const std::vector<double>& weights;  ///< Of its morph targets; others are 0.
};

}  // namespace cagecast::gltf
