#pragma once

#include <cstdint>
#include <span>

#include "base/units.hpp"
#include "cagecast/mesh.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"
#include "cagecast/status.hpp"

namespace cagecast {

/// Checks a mesh by itself: its sizes, that numbers are finite, and indices.
/// @param argument  What to blame. A cage must have UVs.
Status checkArrays(const MeshView& mesh, Argument argument) noexcept;

/// Checks the meshes of a call. (What is found only later: a cage without any area, a `weldTolerance` that is too large
/// for the target.)
/// @param[out] units  Valid if the status is ok.
Status checkMeshes(const MeshView& cage, const MeshView& target, Units& units) noexcept;

/// Checks that a projection is whole, and of a target with these indices.
Status checkProjection(const ProjectionView& projection, std::span<const std::uint32_t> indices) noexcept;

/// The stages of the method that read options.
enum class Stage : std::uint8_t { project, classify };

/// Checks the options of a stage, except `parts` and `locks`.
Status checkOptions(const TransferOptions& options, Stage stage) noexcept;
/// Checks the options of both stages, except `parts` and `locks`.
Status checkOptions(const TransferOptions& options) noexcept;

/// Finds the lock of every segment, by itself or by its group.
/// @param[out] out  1 per segment; empty if there are no locks at all.
/// @return badOption for a segment or group that does not exist, or a lock that is none of the three.
/// Cost: the number of segments for every group.
Status resolveLocks(const TransferOptions& options, std::span<const SegmentStats> stats, Array<Lock>& out) noexcept;

}  // namespace cagecast
