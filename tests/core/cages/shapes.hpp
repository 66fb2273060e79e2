#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
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
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = from; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2 * kPi * j / around;
      const double r = i == 0 || i == rings ? 0 : std::sin(theta);
      append(positions, centre + radius * Vec3{r * std::cos(phi), std::cos(theta), r * std::sin(phi)});
    }
  for (std::uint32_t i = 0; i < rings - from; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      if (i + from > 0) indices.insert(indices.end(), {a, b, b + around});
      if (i + from + 1 < rings) indices.insert(indices.end(), {a, b + around, a + around});
    }
  return weldExactly({positions, indices});
}

template <typename Map>
TriangleMesh mapped(TriangleMesh mesh, const Map& map) {
  for (Vec3& p : mesh.positions) p = map(p);
  return mesh;
}

inline TriangleMesh ellipsoid(const Vec3& centre, const Vec3& radii, std::uint32_t rings = 24) {
  return mapped(sphere({0, 0, 0}, 1, rings), [&](const Vec3& p) {
    return centre + Vec3{radii.x * p.x, radii.y * p.y, radii.z * p.z};
  });
}

/// @param half  Of its size.
inline TriangleMesh box(const Vec3& centre, const Vec3& half) {
  TriangleMesh out;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) out.positions.push_back(centre + Vec3{x * half.x, y * half.y, z * half.z});
  out.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 4, 5}, {0, 5, 1},
                   {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return out;
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle3& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

/// Checks that a call reports its progress, rising up to 1, and ends where it is told to.
/// @param call  Whether it succeeds with this progress.
/// @param shares  Between each two of these it reports, and gives up if that says so.
inline void checkProgress(const std::function<bool(const Progress&)>& call, const std::vector<float>& shares) {
  std::vector<float> found;
  CHECK(call([&](float share, const char*) {
    found.push_back(share);
    return true;
  }));
  REQUIRE_FALSE(found.empty());
  CHECK(std::is_sorted(found.begin(), found.end()));
  CHECK(found.front() >= 0);
  CHECK(found.back() == 1);
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    INFO("between " << shares[i] << " and " << shares[i + 1]);
    CHECK_FALSE(call([&](float share, const char*) { return !(share > shares[i] && share < shares[i + 1]); }));
  }
}

/// A model with the arrays that it refers to.
struct OwnedModel {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;
  std::vector<std::uint8_t> marks;
  std::vector<std::string> parts;

  void add(const std::string& name, const TriangleMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    for (const Vec3& p : mesh.positions) append(positions, p);
    for (const Triangle3& t : mesh.triangles)
      for (const std::uint32_t v : t) indices.push_back(first + v);
    groups.resize(positions.size() / 3, static_cast<std::uint32_t>(parts.size()));
    parts.push_back(name);
  }
  /// Adds a part that is rolled from the unit square, with UVs and a seam.
  /// @param place  The position for u and v.
  /// @param keep  Whether the triangles about a u and v are there.
  template <typename Place, typename Keep>
  void roll(std::uint32_t columns, std::uint32_t rows, const Place& place, const Keep& keep) {
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    for (std::uint32_t r = 0; r <= rows; ++r)
      for (std::uint32_t c = 0; c <= columns; ++c) {
        const double u = static_cast<double>(c) / columns, v = static_cast<double>(r) / rows;
        append(positions, place(c == columns ? 0 : u, v));  // Both sides of the seam are in the same place.
        uvs.insert(uvs.end(), {static_cast<float>(u), static_cast<float>(v)});
        groups.push_back(static_cast<std::uint32_t>(parts.size()));
      }
    for (std::uint32_t r = 0; r < rows; ++r)
      for (std::uint32_t c = 0; c < columns; ++c) {
        if (!keep((c + 0.5) / columns, (r + 0.5) / rows)) continue;
        const std::uint32_t a = first + r * (columns + 1) + c, b = a + columns + 1;
        indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
      }
    parts.push_back("rolled");
  }
  /// Makes it non-manifold: fins on some edges, each a third triangle there, and some triangles a second time.
  void addFins() {
    const std::size_t count = indices.size();
    for (std::size_t i = 0; i + 2 < count; i += 300) {  // A fin for every hundredth triangle.
      const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
      const auto top = static_cast<std::uint32_t>(positions.size() / 3);
      for (std::size_t k = 0; k < 3; ++k) positions.push_back(1.01f * positions[std::size_t{3} * c + k]);
      indices.insert(indices.end(), {a, b, top, a, b, c});
    }
    groups.resize(positions.size() / 3, 0);
    uvs.clear();
  }
  template <typename Map>
  [[nodiscard]] OwnedModel mapped(const Map& map) const {
    OwnedModel out = *this;
    out.positions.clear();
    for (std::size_t i = 0; i < positions.size(); i += 3) append(out.positions, map(Vec3::from(&positions[i])));
    return out;
  }
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups}; }
  [[nodiscard]] Model model() const {
    Model out{view(), parts};
    out.marks = marks;
    return out;
  }
};

}  // namespace cagecast::cages
