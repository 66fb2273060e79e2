#pragma once

#include <cstdint>
#include <limits>
#include <span>

/// The options of all functions. options.def lists them, with their ranges and what each does.
namespace cagecast {

/// Where a target vertex takes its UV from.
enum class ProjectionMode : std::uint8_t {
  nearestPoint,   ///< The nearest point on the surface of the cage: the method.
  nearestVertex,  ///< The nearest vertex of the cage, without any filtering: a baseline for comparison.
};

/// Where UVs are given.
enum class Seams : std::uint8_t {
  vertex,  ///< Per vertex only: a triangle across a seam of the cage's texture stretches over the charts.
  corner,  ///< Also per triangle corner, in `Projection::cornerUvs`: no triangle stretches.
};

/// An override by the user: whether a segment is culled.
enum class Lock : std::uint8_t {
  automatic,  ///< No override: its score decides.
  keep,       ///< Never culled, whatever its score. Its points may still be occluded or uncovered.
  exclude,    ///< Always culled, whatever its score. Like any culled segment, it explains the holes over it.
};

/// A lock and its segment.
struct LockEntry {
  std::uint32_t segment = 0;  ///< As in `Projection::segments`.
  Lock lock = Lock::automatic;
};

/// Parts of a target, by the numbers of its groups; a segment has the group of its first vertex. The first list with a
/// group counts.
struct Parts {
  /// Parts that are not there: not painted, not in the way, not counted. A triangle is ignored with any of its corners.
  /// The vertices of such a group are one segment without points or area.
  std::span<const std::uint32_t> ignore = {};
  std::span<const std::uint32_t> keep = {};     ///< Parts whose segments are as with `Lock::keep`.
  std::span<const std::uint32_t> exclude = {};  ///< Parts whose segments are as with `Lock::exclude`.
};

/// An override by the user for a vertex or a triangle.
enum class Mask : std::int8_t {
  never = -1,     ///< Never painted. It overrides `always`.
  automatic = 0,  ///< No override: the method decides.
  always = 1,     ///< Painted, whatever the method says.
};

/// Overrides for what no lock can name, such as the eyes of a scan in one piece. Segments, their ratios and holes are
/// not affected.
///
/// A vertex of `never` gets `Zone::culled`, and no triangle at it is painted. A vertex of `always` gets
/// `Zone::cosmetic`, and a triangle is painted if its vertices say so then. Triangles are decided after vertices: the
/// vertices of a painted triangle of `always` become cosmetic, and those all of whose triangles are `never` become
/// culled. Where the cage has no place for what is painted, as over a hole, it shows the nearest of the cage,
/// stretched.
struct Masks {
  std::span<const Mask> vertices = {};   ///< 1 per target vertex, or none. Vertices at the same place may differ.
  std::span<const Mask> triangles = {};  ///< 1 per target triangle, or none.
};

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The C++ types of the kinds in options.def.
#define CAGECAST_TYPE_share float
#define CAGECAST_TYPE_length float
#define CAGECAST_TYPE_toggle bool
#define CAGECAST_TYPE_choice(type) type

/// Switches for single steps of the method. They only exist to measure what each step contributes, and are not part of
/// the stable interface.
struct Steps {
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) CAGECAST_TYPE_##kind name = standard;
#include "cagecast/options.def"
};

/// The options of `project`, `classify`, `transfer` and `cutBorders`. Each function reads the options of its stages,
/// which options.def names. A default-constructed object is the preset `default`.
struct TransferOptions {
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) CAGECAST_TYPE_##kind name = standard;
#include "cagecast/options.def"
  Steps steps;
  Parts parts;  ///< `ignore` is read by `project`, `transfer` and `cutBorders`; the rest as `locks`.
  /// Overrides for single segments, which count more than those for parts; the last one for a segment counts. Read by
  /// `classify` and `transfer`.
  std::span<const LockEntry> locks = {};
  Masks masks;  ///< Read by `classify`, `transfer` and `cutBorders`.

  /// The preset `paper`: the method as published.
  static constexpr TransferOptions paper() noexcept {
    TransferOptions options;
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) options.name = paper;
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) options.steps.name = paper;
#include "cagecast/options.def"
    return options;
  }
};

/// Which option a `Status` is about.
enum class Option : std::uint8_t {
  none,
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) name,
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) name,
#include "cagecast/options.def"
  locks,
  ignoredParts,
  keptParts,
  excludedParts,
  // Of cages.hpp:
  kind,
  triangles,
  closing,
  offset,
  voxels,
  reach,
  vertexMasks,
  triangleMasks,
};

}  // namespace cagecast
