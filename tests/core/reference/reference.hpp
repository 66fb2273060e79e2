#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/transfer.hpp"

/// The method once more, as plainly as it can be said: in double precision, sharing no code with the library. It is
/// what the library is measured against, so it prefers being readable to being fast.
namespace cagecast::reference {

/// Which steps are taken, and their constants. Lengths are shares of the diagonal of the target's bounding box.
struct Options {
  ProjectionMode projection = ProjectionMode::nearestPoint;
  double threshold = 0.5;
  double weldTolerance = 0;
  bool groups = true;         ///< Weld within a group only; else all vertices count as one group.
  bool endOfSelfRay = false;  ///< Step 2': a self hit counts only up to `occlusionReach` beyond the cage.
  double occlusionReach = 0.03;
  bool pokes = false;  ///< Step 3': a point without a cage hit, up to `pokeThrough` outside, is covered.
  double pokeThrough = 0.0025;
  bool interiorSamples = false;  ///< Step 4': big triangles of small segments at a hole have samples inside.
  bool farLoops = false;         ///< Step 4': a loop is near a segment up to where the cage is; else within 0.01.
  Floor floor = Floor::none;     ///< Step 5: what a segment needs besides its coverage, and C > 0.
  double minCovered = 0.2;
  double minOfAll = 0.005;
  double maxUncovered = 0.25;
  bool depthWeighting = false;  ///< Step 5': covered area counts less where it lies deep; finds the twins, too.
  bool twins = false;           ///< Step 5": copies of one part that are in doubt are judged together.
  bool holeContents = false;    ///< Step 5‴: small parts that a hole bares which nothing explains fail; with `holes`.
  bool recheck = false;         ///< Step 6: occluded points that are seen from elsewhere are recovered.
  bool bothSides = false;       ///< Step 6: where normals cancel out, look to both sides; else such points stay.
  bool exposedSide = false;     ///< Step 6: the side a segment looks to is that of its points that are not occluded.
  bool holes = false;           ///< Step 7: uncovered points whose hole is not meant for them are recovered.
  bool partialTriangles = false;  ///< Step 8: triangles with some corners occluded are painted.
  bool seams = false;             ///< Step 9: UVs per corner, where a triangle lies across a seam.
  bool stability = true;          ///< Find out where the answer is firm; without, everything is called stable.

  static Options paper();     ///< The literal method: none of the steps that can be switched.
  static Options standard();  ///< The preset `default`: all of them.
  static Options earlier();   ///< The same with step 4', the floor and the recheck as they were first written down.
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
Result transfer(const MeshView& cage, const MeshView& target, const Options& options);

/// The same for the options of the library, without its locks.
Result transfer(const MeshView& cage, const MeshView& target,
                const TransferOptions& options = TransferOptions::paper());

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
