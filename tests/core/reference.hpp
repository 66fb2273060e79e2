#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/transfer.hpp"

/// The method once more, as plainly as it can be said: brute force in double precision, sharing no code with the
/// library. It is what the library is measured against, so it prefers being readable to being fast; the only concession
/// is a bounding sphere per triangle, without which ten thousand points against ten thousand triangles would take
/// minutes.
namespace cagecast::reference {

/// The answer of the reference, with the same fields and meanings as `Projection` and `Zones`.
struct Result {
  std::vector<float> uvs;                        ///< 2 per target vertex.
  std::vector<Zone> zones;                       ///< 1 per target vertex, with the threshold applied.
  std::vector<std::uint32_t> triangles;          ///< 1 per target vertex.
  std::vector<float> distances;                  ///< 1 per target vertex.
  std::vector<std::uint32_t> segments;           ///< 1 per target vertex.
  std::vector<SegmentStats> segmentStats;        ///< 1 per segment.
  std::vector<std::uint8_t> cosmeticTriangles;   ///< 1 per target triangle.
  /// 1 per target vertex: 0 where the method itself has no firm answer, so that another may be right as well.
  ///
  /// A vertex is unstable if its zone before the threshold changes when its ray is turned by `kRayNudge` to any of sixteen
  /// sides; or if it is cosmetic or culled and its segment's verdict hangs on vertices that are unstable, or on the last
  /// bits of the sums. Nothing else is unstable: the nearest triangle and its ties are decided by tolerances of their
  /// own.
  std::vector<std::uint8_t> stable;
};

/// How far a ray is turned to see whether its answer is firm, in radians.
inline constexpr double kRayNudge = 1e-4;

/// Carries the cage's UVs to the target and finds its zones: the preset `paper`, or with
/// `ProjectionMode::nearestVertex` the classical baseline.
/// @pre The meshes are valid, and the cage has a triangle that is not degenerate.
/// Cost: O(V (N + M)) for V points and N triangles of the target, and M triangles of the cage.
Result transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options = {});

/// How an answer of the library differs from the reference, counted over the vertices where the reference is stable.
struct Differences {
  std::size_t vertices = 0;   ///< All vertices compared.
  std::size_t unstable = 0;   ///< Those left out because the reference is not stable there.
  std::size_t zones = 0;      ///< Vertices with another zone.
  std::size_t triangles = 0;  ///< Vertices with another nearest cage triangle.
  std::size_t uvs = 0;        ///< Vertices with a UV more than 1e-5 off.
  std::size_t distances = 0;  ///< Vertices with a distance more than 1e-6 of the target's diagonal off.
  std::size_t segments = 0;   ///< Vertices (stable or not) with another segment.
  std::size_t stats = 0;      ///< Segments with other counts, or, all their vertices being stable, other areas.
  std::string details;        ///< A line for each of the first few.
  [[nodiscard]] std::size_t total() const noexcept {
    return zones + triangles + uvs + distances + segments + stats;
  }
};

/// Compares the library's answer with the reference's for the same meshes and options.
Differences compare(const Result& reference, const TransferResult& product, const MeshView& target);

}  // namespace cagecast::reference
