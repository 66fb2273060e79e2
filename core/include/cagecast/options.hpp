#pragma once

#include <cstdint>
#include <limits>
#include <span>

/// The options of all functions. options.def lists them, with their ranges and what each does.
namespace cagecast {

/// How a target vertex finds its place on the cage.
enum class ProjectionMode : std::uint8_t {
  nearestPoint,   ///< The nearest point of the cage's surface: the method.
  nearestVertex,  ///< The nearest vertex of the cage, nothing filtered: the classical baseline, for comparison.
};

/// Where UVs are kept.
enum class Seams : std::uint8_t {
  vertex,  ///< Per vertex only: a triangle across a seam of the cage's texture stretches over the charts.
  corner,  ///< Also per triangle corner, in `Projection::cornerUvs`: no triangle stretches.
};

/// What a segment needs besides the threshold, so that light leaking into a hidden part is not taken for skin: step 5′.
/// A, C and D are the whole, the covered and the depth-weighted area of the segment; F is its coverage.
enum class Floor : std::uint8_t {
  none,   ///< Nothing.
  area,   ///< C > 0, and C ≥ `minCovered` · A.
  depth,  ///< C > 0, and D · F ≥ `minCovered` · A, or as `minOfAll` and `maxUncovered` say.
};

/// What the user says about a segment.
enum class Lock : std::uint8_t {
  automatic,  ///< Nothing: its areas decide.
  keep,       ///< It is not culled, whatever its areas. Its occluded and uncovered points stay so.
  exclude,    ///< It is culled, whatever its areas, and like any culled segment it explains the holes over it.
};

/// A lock and what it applies to.
struct LockEntry {
  std::uint32_t id = 0;  ///< The number of a segment, or of a group.
  Lock lock = Lock::automatic;
};

/// The last word about single segments. A lock by segment takes precedence over one by group; of several for the same
/// segment or group the last one counts.
struct Locks {
  std::span<const LockEntry> segments = {};  ///< By number, as in `Projection::segments`.
  std::span<const LockEntry> groups = {};    ///< By `SegmentStats::group`: the group of the segment's first vertex.
};

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The C++ types of the kinds in options.def.
#define CAGECAST_TYPE_share float
#define CAGECAST_TYPE_length float
#define CAGECAST_TYPE_toggle bool
#define CAGECAST_TYPE_choice(type) type

/// Switches of single steps of the method. They exist for measuring what each step is worth, and are not part of the
/// stable interface.
struct Steps {
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) CAGECAST_TYPE_##kind name = standard;
#include "cagecast/options.def"
};

/// The options of `project`, `classify`, `transfer` and `cutBorders`. Each function reads its share: options.def names
/// the stage of every option. As constructed, it is the preset `default`.
struct TransferOptions {
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) CAGECAST_TYPE_##kind name = standard;
#include "cagecast/options.def"
  Steps steps;
  Locks locks;  ///< Read by `classify` and `transfer`.

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
  segmentLocks,
  groupLocks,
};

}  // namespace cagecast
