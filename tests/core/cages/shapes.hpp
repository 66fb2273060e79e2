#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/triangle_mesh.hpp"

/// Small models for the tests of cages.
namespace cagecast::cages {

constexpr double kPi = std::numbers::pi;

/// A sphere of rings from pole to pole; `from` > 0 leaves out the rings about the upper pole.
inline TriangleMesh sphere(Vec3 centre, double radius, std::uint32_t rings = 24, std::uint32_t from = 0) {
  TriangleMesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = from; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2 * kPi * j / around;
      const double r = i == 0 || i == rings ? 0 : std::sin(theta);
      mesh.positions.push_back(centre + radius * Vec3{r * std::cos(phi), std::cos(theta), r * std::sin(phi)});
    }
  for (std::uint32_t i = 0; i < rings - from; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      if (i + from > 0) mesh.triangles.push_back({a, b, b + around});
      if (i + from + 1 < rings) mesh.triangles.push_back({a, b + around, a + around});
    }
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (const Vec3& p : mesh.positions)
    for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
  for (const Triangle3& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  return weldExactly({positions, indices});
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle3& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

/// Makes a mesh non-manifold: fins on some edges, each a third triangle there, and some triangles a second time.
inline void addFins(std::vector<float>& positions, std::vector<std::uint32_t>& indices) {
  const std::size_t count = indices.size();
  constexpr std::size_t kStep = 300;  // A fin for every hundredth triangle.
  for (std::size_t i = 0; i + 2 < count; i += kStep) {
    const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
    const auto top = static_cast<std::uint32_t>(positions.size() / 3);
    for (std::size_t k = 0; k < 3; ++k) positions.push_back(1.01f * positions[std::size_t{3} * c + k]);
    indices.insert(indices.end(), {a, b, top, a, b, c});
  }
}

/// A model with the arrays that it refers to.
struct OwnedModel {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices, groups;
  std::vector<std::uint8_t> marks;
  std::vector<std::string> parts;

  void add(const std::string& name, const TriangleMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    for (const Vec3& p : mesh.positions)
      for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
    for (const Triangle3& t : mesh.triangles)
      for (const std::uint32_t v : t) indices.push_back(first + v);
    groups.resize(positions.size() / 3, static_cast<std::uint32_t>(parts.size()));
    parts.push_back(name);
  }
  [[nodiscard]] Model model() const {
    Model out;
    out.mesh = {positions, indices, {}, groups};
    out.parts = parts;
    out.marks = marks;
    return out;
  }
};

}  // namespace cagecast::cages
