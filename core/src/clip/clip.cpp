#include "cagecast/clip.hpp"

#include <algorithm>
#include <utility>

#include "clip/clip_target.hpp"
#include "input/validate.hpp"

namespace cagecast {
namespace {

constexpr Status kOutOfMemory{Code::outOfMemory};

/// Which vertices can be on a triangle that is painted, or on an edge of one.
bool findParts(const DecidedTarget& decided, const Points& points, Arena& arena, std::uint8_t* takesPart) {
  auto* isSeen = arena.allocate<bool>(points.count);
  if (arena.failed()) return false;
  std::fill(isSeen, isSeen + points.count, false);
  for (std::size_t i = 0; i < decided.mesh.indices.size(); i += 3) {
    const auto isOccluded = [&](std::uint32_t v) { return decided.zones[v] == Zone::occluded; };
    const auto corners = decided.mesh.indices.subspan(i, 3);
    if (std::all_of(corners.begin(), corners.end(), isOccluded)) continue;
    for (const std::uint32_t v : corners) isSeen[points.ofVertex[v]] = true;
  }
  for (std::size_t v = 0; v < decided.mesh.positions.size() / 3; ++v) {
    const bool passes = decided.culledBy[decided.segments[v]] == CulledBy::none;
    takesPart[v] = passes && isSeen[points.ofVertex[v]];
  }
  return true;
}

/// Finds what is needed to cut the target, and cuts it.
Status cutAlone(const MeshView& cageMesh, const DecidedTarget& decided, const TransferOptions& options, Arena& arena,
                ClippedMesh& out) {
  const MeshView& target = decided.mesh;
  Units units;
  if (const Status status = checkMeshes(cageMesh, target, units); !status.ok()) return status;
  Cage cage;
  CageTree cageTree;
  HalfEdges edges;
  BoundaryLoops loops;
  UvCharts charts;
  Points points;
  auto* takesPart = arena.allocate<std::uint8_t>(target.positions.size() / 3);
  if (arena.failed() || !gatherCage(cageMesh, units, arena, cage)) return kOutOfMemory;
  if (cage.count == 0) return {Code::noUsableCageTriangle, Argument::cage};
  if (!weld(target, units, options.weldTolerance, arena, points) || !findParts(decided, points, arena, takesPart))
    return kOutOfMemory;
  // A target in one place has nothing to cut, nor a length to search by.
  if (options.steps.projection != ProjectionMode::nearestPoint || !(units.diagonal > 0))
    std::fill(takesPart, takesPart + target.positions.size() / 3, std::uint8_t{0});
  const bool isDone =
      buildCageTree(cage, units, arena, cageTree) && findHalfEdges(cageMesh, cage, arena, edges) &&
      findBoundaryLoops(cage, edges, arena, loops) && findUvCharts(cage, edges, arena, charts) &&
      clipTarget({cageMesh, cage, cageTree, loops, options.seams == Seams::corner ? &charts : nullptr, units}, target,
                 takesPart, arena, out);
  return isDone ? Status{} : kOutOfMemory;
}

}  // namespace

Status cutBorders(const MeshView& cage, const DecidedTarget& decided, const TransferOptions& options,
                  Workspace& workspace, CutTarget& out) noexcept {
  const MeshView& target = decided.mesh;
  const std::size_t ownCount = target.positions.size() / 3;
  const std::size_t segmentCount = decided.culledBy.size();
  const auto isStray = [=](std::uint32_t segment) { return segment >= segmentCount; };
  if (decided.zones.size() != ownCount || decided.segments.size() != ownCount ||
      std::any_of(decided.segments.begin(), decided.segments.end(), isStray)) {
    return {Code::resultMismatch, Argument::target, static_cast<std::uint32_t>(decided.zones.size())};
  }
  if (const Status status = checkOptions(options); !status.ok()) return status;
  Arena* const arena = workspace.restart();
  if (arena == nullptr) return kOutOfMemory;
  ClippedMesh cut;
  if (const Status status = cutAlone(cage, decided, options, *arena, cut); !status.ok()) return status;
  const std::size_t count = cut.loopSides.size();
  Array<std::uint32_t> groups, segments;
  Array<LockEntry> locks;
  Array<SegmentStats> stats;
  if (!groups.reset(target.groups.empty() ? 0 : count) || !segments.reset(count) || !locks.reset(segmentCount) ||
      !stats.reset(segmentCount)) {
    return kOutOfMemory;
  }
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t source = v < ownCount ? v : cut.sources[3 * (v - ownCount)];
    if (!groups.empty()) groups[v] = target.groups[source];
    segments[v] = decided.segments[source];
  }
  std::fill(stats.begin(), stats.end(), SegmentStats{});  // Locks have the last word.
  for (std::uint32_t s = 0; s < segmentCount; ++s)
    locks[s] = {s, decided.culledBy[s] != CulledBy::none ? Lock::exclude : Lock::keep};

  Projection again;
  if (const Status status = project(cage, {cut.positions, cut.indices, {}, groups}, options, workspace, again);
      !status.ok())
    return status;
  TransferOptions locked = options;
  locked.steps.twins = false;
  locked.locks = {locks, {}};
  Zones zones;
  const ProjectionView view{again.zones, segments, stats, again.recovery, {}};
  if (const Status status = classify(view, cut.indices, locked, zones); !status.ok()) return status;
  // What lies beyond a loop is uncovered, however the hole is explained; what lies on the border is not.
  for (std::size_t v = 0; v < count; ++v) {
    Zone& zone = zones.zones[v];
    if (cut.loopSides[v] == LoopSide::beyond && zone == Zone::cosmetic) zone = Zone::uncovered;
    if (cut.loopSides[v] == LoopSide::onBorder && zone == Zone::uncovered) zone = Zone::cosmetic;
  }
  markCosmetic(zones.zones, cut.indices, options, zones.cosmeticTriangles);
  for (std::size_t t = 0; t < cut.areBeyond.size(); ++t) zones.cosmeticTriangles[t] &= cut.areBeyond[t] == 0;

  out = {
      std::move(cut.sources), std::move(cut.weights),     std::move(cut.indices), std::move(cut.origins),
      std::move(again.uvs),   std::move(again.cornerUvs), std::move(zones.zones), std::move(zones.cosmeticTriangles)};
  return {};
}

}  // namespace cagecast
