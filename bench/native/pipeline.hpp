#pragma once

#include <cstdint>
#include <vector>

#include "cagecast/transfer.hpp"

/// The steps that every peer shares and no search library does: welding, segments, the threshold. Written the way one
/// writes them when they are not to be the bottleneck; nothing here is the product's own.
namespace cagecast::bench {

struct Vec3f {
  float x, y, z;
  friend Vec3f operator+(Vec3f a, Vec3f b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3f operator-(Vec3f a, Vec3f b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3f operator*(float s, Vec3f a) { return {s * a.x, s * a.y, s * a.z}; }
};
inline float dot(Vec3f a, Vec3f b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3f cross(Vec3f a, Vec3f b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Vec3f at(std::span<const float> positions, std::size_t vertex) {
  return {positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]};
}

/// The target's vertices, welded by equal position and group. The arrays keep their memory from run to run.
struct Welded {
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> ofVertex;  ///< The point of each vertex.
  float diagonal = 0;                   ///< Of the box around the points.

  /// Welds with a hash table, in the order of the vertices.
  void weld(const MeshView& target);
  /// The points in the order of a Morton curve, for searches that like neighbours to come together.
  const std::vector<std::uint32_t>& alongCurve();

 private:
  std::vector<std::uint32_t> table_;
  std::vector<std::uint64_t> keys_, spareKeys_;
  std::vector<std::uint32_t> order_;
  Vec3f low_{}, high_{};
};

/// Steps 4 and 5, and handing the results of the points out to the vertices.
class Decision {
 public:
  /// @param zones  1 per point, decided but for the threshold.
  /// @param uvs,distances,triangles  1 (UVs: 2) per point.
  void decide(const MeshView& target, const Welded& welded, const std::vector<Zone>& zones,
              const std::vector<float>& uvs, const std::vector<float>& distances,
              const std::vector<std::uint32_t>& triangles);

  std::vector<Zone> zones;  ///< 1 per vertex.
  std::vector<float> uvs, distances;
  std::vector<std::uint32_t> triangles, segments;
  std::vector<std::uint8_t> cosmeticTriangles;

 private:
  struct Sums {
    double exposed, covered;
  };
  std::vector<std::uint32_t> parents_;
  std::vector<Sums> sums_;
};

}  // namespace cagecast::bench
