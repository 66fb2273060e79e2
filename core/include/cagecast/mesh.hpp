#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace cagecast {

/// A triangle mesh, seen but not owned. All arrays stay the caller's and are only read.
struct MeshView {
  std::span<const float> positions;        ///< 3 per vertex (x, y, z), finite; cage and target share space and unit.
  std::span<const std::uint32_t> indices;  ///< 3 per triangle, counter-clockwise seen from outside.
  std::span<const float> uvs = {};         ///< 2 per vertex, finite. A cage must have them, a target need not.
  std::span<const std::uint32_t> groups = {};  ///< 1 per vertex or none: vertices of different groups are never welded.
};

/// What went wrong; `ok` if nothing did.
enum class Code : std::uint8_t {
  ok,
  emptyMesh,              ///< A mesh without vertices or without triangles.
  positionsNotTriples,    ///< The number of position floats is not a multiple of three.
  indicesNotTriples,      ///< The number of indices is not a multiple of three.
  missingUvs,             ///< The cage has no UVs.
  uvCountMismatch,        ///< UVs are not two per vertex.
  groupCountMismatch,     ///< Groups are not one per vertex.
  cornerUvCountMismatch,  ///< UVs per corner are not two per index.
  indexOutOfRange,        ///< `at` is the place in `indices`.
  nonFinitePosition,      ///< `at` is the place in `positions`.
  nonFiniteUv,            ///< `at` is the place in `uvs`.
  noUsableCageTriangle,   ///< Every triangle of the cage has zero area.
  tooLarge,               ///< More than `kMaxVertices` or `kMaxTriangles` (`at` says how many), or coordinates out of
                          ///< all proportion to the target (`at` is the place in `positions`).
  badThreshold,           ///< The threshold is not within 0..1.
  badWeldTolerance,       ///< The weld tolerance is not within 0..0.01.
  badOcclusionReach,      ///< The occlusion reach is less than 0, or not a number.
  badPokeThrough,         ///< The poke-through distance is not within 0..1.
  badMinCovered,          ///< The least covered share of a segment is not within 0..1.
  badMinOfAll,            ///< The least share of all covered area is not within 0..1.
  badMaxUncovered,        ///< The most that may be uncovered is not within 0..1.
  badLocks,               ///< Locks are given, but not one per segment; `at` says how many there are.
  resultMismatch,         ///< What a transfer decided is not of this target; `at` says of how many vertices it is.
  outOfMemory,            ///< The work or its result does not fit into memory; nothing was computed.
};

/// The argument that a `Status` speaks of.
enum class Argument : std::uint8_t { none, cage, target, options };

/// How a call ended: an error as a value. Nothing of the output is valid unless `ok()`.
struct [[nodiscard]] Status {
  Code code = Code::ok;
  Argument argument = Argument::none;  ///< Which argument is at fault.
  std::uint32_t at = 0;                ///< The element at fault; see `Code` for what it counts.
  [[nodiscard]] constexpr bool ok() const noexcept { return code == Code::ok; }
};

inline constexpr std::uint32_t kMaxVertices = 1u << 28;   ///< Most vertices of a mesh: arrays stay within 32-bit sizes.
inline constexpr std::uint32_t kMaxTriangles = 1u << 28;  ///< Most triangles of a mesh.

/// The name of a code as it is spelled here ("indexOutOfRange"): stable, for programs.
const char* codeName(Code code) noexcept;

/// One sentence that names the argument, the element, its value and the limit, for people:
/// `target.indices[17] = 912 is out of range (900 vertices)`.
/// @param cage,target  The meshes of the call that returned `status`.
std::string describe(const Status& status, const MeshView& cage, const MeshView& target);

}  // namespace cagecast
