#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "cagecast/mesh.hpp"
#include "cagecast/options.hpp"
#include "cagecast/result.hpp"
#include "cagecast/status.hpp"

/// Cage-based texture transfer with geometric filtering.
///
/// Carries the UVs of a cage to the vertices of a target mesh and finds the target's Non-Cosmetic Zones (NCZ), the
/// vertices that must not be painted. The method is the one of *Cage-based Texture Transfer with Geometric Filtering*
/// (Zhou, Ng, Lim, Griffin, Baghernezhad; SIGGRAPH Posters '26, DOI 10.1145/3799825.3818741).
///
/// Single-threaded and deterministic: the same bits on every platform, at every optimisation level.
namespace cagecast {

class Arena;

/// The working memory of calls. It grows to the need of the largest call and is kept between calls, so reusing a
/// workspace saves allocations. It serves one call at a time: give each thread its own.
class Workspace {
 public:
  /// @param limit  Maximum size of the working memory in bytes; a call that needs more ends with outOfMemory. Gaps in
  ///   memory that is kept from other calls count, too. The call after such an end begins by freeing that memory, so
  ///   the same call may work when it is repeated. The results are not counted, nor what `cutBorders`, and calls with a
  ///   `weldTolerance` or `ProjectionMode::nearestVertex`, take besides in proportion to the meshes. `classify` and
  ///   `splitVertices` have no limit.
  explicit Workspace(std::size_t limit = SIZE_MAX) noexcept : limit_(limit) {}
  Workspace(Workspace&& other) noexcept;
  Workspace& operator=(Workspace&& other) noexcept;
  ~Workspace();

  /// Frees the memory it keeps. The workspace can be used again.
  void release() noexcept;

  /// For the library: the arena, emptied for a new call; null if there is not enough memory.
  [[nodiscard]] Arena* restart() noexcept;

 private:
  Arena* arena_ = nullptr;  ///< Made by the first call.
  std::size_t limit_;
};

/// Finds, for every vertex of the target, its UV and whether it is occluded or uncovered: steps 1 to 4, 6, 7, 9, 10,
/// 12 and 13. The result does not depend on threshold, floor or locks.
/// @return badOption, or any code about the meshes, or weldToleranceTooLarge, or outOfMemory.
/// Cost: O((V + N + M) log(N + M)) for V vertices and N triangles of the target and M triangles of the cage, and for
/// each pose of the target at most once more. Up to
/// their product for a target of very many small segments under a cage with very many holes, or where many cage
/// triangles are equally near to each vertex.
Status project(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
               Projection& out) noexcept;

/// Decides which segments are culled, and so the zone of every vertex: steps 5, 8 and 11, and which segments and holes
/// step 10 finds meant for each other.
/// Takes microseconds for small targets; call it again for another threshold or other locks.
/// @param projection  `Projection::view()` of a projection with any options.
/// @param indices     The indices of the target, 3 per triangle.
/// @return badOption; indicesNotTriples, indexOutOfRange or resultMismatch if the projection is not whole, or not of a
/// target with these indices; outOfMemory.
/// Cost: linear, and for each lock of a group once through all segments.
Status classify(const ProjectionView& projection, std::span<const std::uint32_t> indices,
                const TransferOptions& options, Zones& out) noexcept;

/// Carries the cage's UVs to the target and finds its Non-Cosmetic Zones: `project`, then `classify`.
Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
                TransferResult& out) noexcept;

}  // namespace cagecast
