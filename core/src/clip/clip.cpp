#include "cagecast/clip.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "clip/clip_target.hpp"
#include "input/validate.hpp"
#include "steps/classify.hpp"
#include "steps/masks.hpp"
#include "steps/project_part.hpp"
#include "steps/scene.hpp"

namespace cagecast {
namespace {

/// Finds the vertices that may be on a painted triangle: their segment is not culled, and one of their triangles is not
/// occluded at all three corners.
/// @param[out] takesPart  1 per vertex.
/// @return false if memory ran out.
bool findPaintable(const DecidedTarget& decided, const Points& points, Arena& arena, std::uint8_t* takesPart) {
  auto* isVisible = arena.allocate<bool>(points.count);
  if (arena.failed()) return false;
  std::fill_n(isVisible, points.count, false);
  for (std::size_t i = 0; i < decided.mesh.indices.size(); i += 3) {
    const auto isOccluded = [&](std::uint32_t v) { return decided.zones[v] == Zone::occluded; };
    const auto corners = decided.mesh.indices.subspan(i, 3);
    if (std::all_of(corners.begin(), corners.end(), isOccluded)) continue;
    for (const std::uint32_t v : corners) isVisible[points.ofVertex[v]] = true;
  }
  for (std::size_t v = 0; v < decided.mesh.positions.size() / 3; ++v) {
    const bool isKept = decided.culledBy[decided.segments[v]] == CulledBy::none;
    takesPart[v] = isKept && isVisible[points.ofVertex[v]];
  }
  return true;
}

/// Cuts the triangles of the target, without a transfer.
Status clip(const MeshView& cage, const DecidedTarget& decided, const TransferOptions& options, Arena& arena,
            ClippedMesh& out) {
  const std::size_t vertexCount = decided.mesh.positions.size() / 3;
  Scene scene(cage, decided.mesh, options, arena);
  if (const Status status = scene.load(); !status.ok()) return status;
  auto* takesPart = arena.allocate<std::uint8_t>(vertexCount);
  if (arena.failed() || !findPaintable(decided, scene.points, arena, takesPart)) return kOutOfMemory;
  // A target whose vertices are all at one position has nothing to cut, and no diagonal to search by.
  if (options.steps.projection != ProjectionMode::nearestPoint || !(scene.units.diagonal > 0))
    std::fill_n(takesPart, vertexCount, std::uint8_t{0});
  UvCharts charts;
  const bool hasSeams = options.seams == Seams::corner;
  const bool isReady = buildCageTree(scene.cage, scene.units, arena, scene.cageTree) &&
                       findHalfEdges(cage, scene.cage, arena, scene.halfEdges) &&
                       findBoundaryLoops(scene.cage, scene.halfEdges, arena, scene.loops) &&
                       findUvCharts(scene.cage, scene.halfEdges, arena, charts);
  if (!isReady) return kOutOfMemory;
  return clipTarget({cage, scene.cage, scene.cageTree, scene.loops, hasSeams ? &charts : nullptr, scene.units},
                    decided.mesh, takesPart, arena, out);
}

/// Sets the zones along the cuts, where rounding would decide otherwise: what lies beyond a boundary loop is uncovered,
/// whatever step 10 says, and what lies on the border is not.
void applyCuts(const ClippedMesh& cut, const TransferOptions& options, Zones& zones) {
  for (std::size_t v = 0; v < cut.loopSides.size(); ++v) {
    Zone& zone = zones.zones[v];
    if (cut.loopSides[v] == LoopSide::beyond && zone == Zone::cosmetic) zone = Zone::uncovered;
    if (cut.loopSides[v] == LoopSide::onBorder && zone == Zone::uncovered) zone = Zone::cosmetic;
  }
  markCosmetic(zones.zones, cut.indices, options, zones.cosmeticTriangles);
  for (std::size_t t = 0; t < cut.areBeyond.size(); ++t) zones.cosmeticTriangles[t] &= cut.areBeyond[t] == 0;
}

/// Gives the segments in `Projection::hiders` other numbers.
/// @param segments  1 per vertex: the other number of its segment.
/// @return false if memory ran out.
bool renumberHiders(Projection& projection, std::span<const std::uint32_t> segments) {
  Array<std::uint32_t> numbers;  // 1 per segment.
  if (!numbers.reset(projection.segmentStats.size())) return false;
  for (std::size_t v = 0; v < segments.size(); ++v) numbers[projection.segments[v]] = segments[v];
  Array<std::uint32_t>& records = projection.hiders;
  for (std::size_t at = 1; at < records.size();) {
    std::uint32_t rays = records[at + 2];
    for (at += 3; rays > 0; --rays) {
      for (std::uint32_t left = records[at++]; left > 0; --left, ++at) records[at] = numbers[records[at]];
    }
  }
  return true;
}

/// The source of a new vertex with the greatest weight.
std::uint32_t heaviestSource(const ClippedMesh& cut, std::size_t newVertex) {
  const float* const weights = &cut.weights[3 * newVertex];
  return cut.sources[3 * newVertex + static_cast<std::size_t>(std::max_element(weights, weights + 3) - weights)];
}

/// The poses of a cut target: its new vertices blend those of their sources.
/// @return false if memory ran out.
bool blendPoses(const DecidedTarget& decided, const ClippedMesh& cut, Array<float>& out) {
  const MeshView& target = decided.mesh;
  const std::size_t size = target.positions.size();
  const std::size_t newCount = cut.sources.size() / 3;
  const std::size_t poseCount = target.poses.size() / size;
  if (!out.reset(poseCount * (size + 3 * newCount))) return false;
  float* to = out.data();
  for (std::size_t n = 0; n < poseCount; ++n) {
    const float* const pose = &target.poses[n * size];
    to = std::copy_n(pose, size, to);
    for (std::size_t i = 0; i < cut.sources.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (std::size_t s = 0; s < 3; ++s)
          sum += static_cast<double>(cut.weights[i + s]) *
                 static_cast<double>(pose[std::size_t{3} * cut.sources[i + s] + k]);
        *to++ = static_cast<float>(sum);
      }
    }
  }
  return true;
}

/// What lies beyond an outer border of the cage, on no loop, and so was left uncovered, still does.
void keepBeyond(const DecidedTarget& decided, const ClippedMesh& cut, std::span<const Visibility> visibility,
                Zones& zones) {
  const std::size_t vertexCount = decided.zones.size();
  for (std::size_t v = 0; v < zones.zones.size(); ++v) {
    if (zones.zones[v] != Zone::cosmetic || visibility[v] != Visibility::uncovered) continue;
    if (cut.loopSides[v] != LoopSide::covered) continue;
    const std::size_t source = v < vertexCount ? v : heaviestSource(cut, v - vertexCount);
    if (decided.zones[source] == Zone::uncovered) zones.zones[v] = Zone::uncovered;
  }
}

/// Decides the pieces of masked triangles, and their vertices, as the whole triangles were.
/// @return false if memory ran out.
bool applyMasks(const DecidedTarget& decided, const TransferOptions& options, const ClippedMesh& cut, Zones& zones) {
  const Masks& masks = options.masks;
  if (masks.vertices.empty() && masks.triangles.empty()) return true;
  const std::span<const std::uint32_t> indices = decided.mesh.indices;
  const std::size_t vertexCount = decided.zones.size();
  Array<std::uint8_t> isDecided;  // 1 per vertex of the target: whether its zone is that of the whole.
  if (!isDecided.reset(vertexCount)) return false;
  for (std::size_t v = 0; v < vertexCount; ++v)
    isDecided[v] = !masks.vertices.empty() && masks.vertices[v] != Mask::automatic;
  for (std::size_t v = vertexCount; v < zones.zones.size(); ++v) {
    const std::uint32_t source = heaviestSource(cut, v - vertexCount);
    if (isDecided[source] != 0) zones.zones[v] = decided.zones[source];
  }
  for (std::size_t i = 0; i < indices.size() && !masks.triangles.empty(); ++i) {
    if (masks.triangles[i / 3] != Mask::automatic) isDecided[indices[i]] = 1;
  }
  for (std::size_t v = 0; v < vertexCount; ++v) {
    if (isDecided[v] != 0) zones.zones[v] = decided.zones[v];
  }
  for (std::size_t piece = 0; piece < cut.origins.size(); ++piece) {
    const std::optional<bool> verdict = maskedVerdict(options, indices, decided.zones, cut.origins[piece]);
    if (verdict) zones.cosmeticTriangles[piece] = *verdict;
  }
  return true;
}

}  // namespace

Status cutBorders(const MeshView& cage, const DecidedTarget& decided, const TransferOptions& options,
                  Workspace& workspace, CutTarget& out) noexcept {
  const MeshView& target = decided.mesh;
  const std::size_t targetVertexCount = target.positions.size() / 3;
  const std::size_t segmentCount = decided.culledBy.size();
  const auto isStray = [=](std::uint32_t segment) { return segment >= segmentCount; };
  if (decided.zones.size() != targetVertexCount || decided.segments.size() != targetVertexCount ||
      std::any_of(decided.segments.begin(), decided.segments.end(), isStray)) {
    return {Code::resultMismatch, Argument::target, static_cast<std::uint32_t>(decided.zones.size())};
  }
  if (const Status status = checkOptions(options); !status.ok()) return status;
  if (const Status status = checkMasks(options.masks, targetVertexCount, target.indices.size() / 3); !status.ok())
    return status;
  Arena* const arena = workspace.restart();
  if (arena == nullptr) return kOutOfMemory;
  ClippedMesh cut;
  if (const Status status = clip(cage, decided, options, *arena, cut); !status.ok()) return status;
  const std::size_t count = cut.loopSides.size();
  Array<std::uint32_t> groups, segments;
  Array<LockEntry> locks;
  Array<SegmentStats> stats;
  if (!groups.reset(target.groups.empty() ? 0 : count) || !segments.reset(count) || !locks.reset(segmentCount) ||
      !stats.reset(segmentCount)) {
    return kOutOfMemory;
  }
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t source = v < targetVertexCount ? v : cut.sources[3 * (v - targetVertexCount)];
    if (!groups.empty()) groups[v] = target.groups[source];
    segments[v] = decided.segments[source];
  }
  // Every segment gets a lock, so the statistics do not matter.
  std::fill(stats.begin(), stats.end(), SegmentStats{});
  for (std::uint32_t s = 0; s < segmentCount; ++s)
    locks[s] = {s, decided.culledBy[s] != CulledBy::none ? Lock::exclude : Lock::keep};

  TransferOptions locked = options;
  // New vertices are as close as 1e-7 to each other, also across a border: those are not one.
  locked.weldTolerance = 0;
  locked.masks = {};
  locked.parts = {options.parts.ignore, {}, {}};
  Array<float> poses;
  if (options.motion && !blendPoses(decided, cut, poses)) return kOutOfMemory;
  Projection again;
  if (const Status status =
          projectPart(cage, {cut.positions, cut.indices, {}, groups, poses}, locked, workspace, again);
      !status.ok())
    return status;
  locked.locks = locks;
  Zones zones;
  if (!renumberHiders(again, segments)) return kOutOfMemory;
  const ProjectionView view{again.visibility, segments, stats, again.recovery, {}, {again.hiddenBy, again.hiders}};
  if (const Status status = classify(view, cut.indices, locked, zones); !status.ok()) return status;
  keepBeyond(decided, cut, again.visibility, zones);
  applyCuts(cut, options, zones);
  if (!applyMasks(decided, options, cut, zones)) return kOutOfMemory;
  out = {
      std::move(cut.sources), std::move(cut.weights),     std::move(cut.indices), std::move(cut.origins),
      std::move(again.uvs),   std::move(again.cornerUvs), std::move(zones.zones), std::move(zones.cosmeticTriangles)};
  return {};
}

}  // namespace cagecast
