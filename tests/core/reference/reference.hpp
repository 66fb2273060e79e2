#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/transfer.hpp"

/// The method once more, as plainly as it can be said: in double precision, sharing no code with the library. It is
/// what the library is measured against, so it prefers being readable to being fast.
namespace cagecast::reference {

/// The options of the library, without locks and masks, and what to find out besides.
struct Options : TransferOptions {
  /// Whether to find out where the answer is firm; without, everything is called stable.
  bool findsStability = true;

  Options(const TransferOptions& options, bool findsStability_ = true)  // NOLINT(google-explicit-constructor): the same
      : TransferOptions(options), findsStability(findsStability_) {}
};

/// The answer of the reference, with the same fields and meanings as `Projection` and `Zones`.
struct Result {
  std::vector<float> uvs;                       ///< 2 per target vertex.
  std::vector<Zone> zones;                      ///< 1 per target vertex, with the threshold applied.
  std::vector<std::uint32_t> triangles;         ///< 1 per target vertex.
  std::vector<float> distances;                 ///< 1 per target vertex.
  std::vector<std::uint32_t> segments;          ///< 1 per target vertex.
  std::vector<SegmentStats> segmentStats;       ///< 1 per segment; areas are sums over the samples.
  std::vector<std::uint8_t> firmAreas;          ///< 1 per segment: 0 where what a sample found depends on rounding.
  std::vector<std::uint8_t> cosmeticTriangles;  ///< 1 per target triangle.
  std::vector<float> cornerUvs;                 ///< 6 per target triangle, with `seams`; else empty.
  /// 1 per target vertex: 0 where the method itself has no firm answer, so that another may be right as well.
  ///
  /// Each ray that has a say is turned by `kRayNudge`, and moved by 1e-7 of the diagonal, to sixteen sides, and by a
  /// hundred-thousandth of both to four, and what may come of it is followed to the end: to the verdict over its
  /// segment, to the neighbours that a recheck brings in, to the hole that a failing segment explains. A vertex is
  /// unstable if it may then end up in more than one zone; or if that hangs on the last bits of the sums. Nothing else
  /// is unstable: the nearest triangle and its ties are decided by tolerances of their own.
  std::vector<std::uint8_t> stable;
  /// 1 per target triangle, with `seams`: 0 where which corner's patch serves it is decided by rounding.
  std::vector<std::uint8_t> stableCorners;
};

/// Carries the cage's UVs to the target and finds its zones; with `ProjectionMode::nearestVertex` the classical
/// baseline.
/// @pre The meshes are valid, and the cage has a triangle that is not degenerate.
Result transfer(const MeshView& cage, const MeshView& target, const Options& options = TransferOptions::paper());

/// How an answer of the library differs from the reference, counted over the vertices where the reference is stable.
struct Differences {
  std::size_t vertices = 0;   ///< All vertices compared.
  std::size_t unstable = 0;   ///< Those left out because the reference is not stable there.
  std::size_t zones = 0;      ///< Vertices with another zone.
  std::size_t triangles = 0;  ///< Vertices with another nearest cage triangle.
  std::size_t uvs = 0;        ///< Vertices with a UV more than 1e-5 off.
  std::size_t distances = 0;  ///< Vertices with a distance more than 1e-6 of the target's diagonal off.
  std::size_t segments = 0;   ///< Vertices (stable or not) with another segment.
  std::size_t painted = 0;    ///< Triangles, all their corners being stable, that are cosmetic for one of the two only.
  std::size_t corners =
      0;  ///< Triangles, stable where their patch is concerned, with a corner whose UV is more than 1e-5 off.
  std::size_t stats = 0;  ///< Segments with other counts, or, all their vertices and areas being firm, other areas.
  std::string details;    ///< A line for each of the first few.
  [[nodiscard]] std::size_t total() const noexcept {
    return zones + triangles + uvs + distances + segments + painted + corners + stats;
  }
};

/// Compares the library's answer with the reference's for the same meshes and options.
Differences compare(const Result& reference, const TransferResult& product, const MeshView& target);

}  // namespace cagecast::reference
