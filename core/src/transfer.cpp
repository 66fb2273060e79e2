#include "cagecast/transfer.hpp"

#include <algorithm>
#include <cstring>

#include "base/timer.hpp"
#include "input/validate.hpp"
#include "seams/corner_uvs.hpp"
#include "steps/holes/holes.hpp"
#include "steps/holes/region.hpp"
#include "steps/interior_samples.hpp"
#include "steps/masks.hpp"
#include "steps/motion/motion.hpp"
#include "steps/occluded.hpp"
#include "steps/point_data.hpp"
#include "steps/project.hpp"
#include "steps/project_part.hpp"
#include "steps/recheck/recheck_occluded.hpp"
#include "steps/scene.hpp"
#include "steps/segments.hpp"
#include "steps/uncovered.hpp"

namespace cagecast {
namespace {

/// The work that a call may do, in tests of a few triangles: so much, and so much for each point and triangle of the
/// target and each of its poses. Real models take 10 to 90 for each; in copies that lie in each other by the thousand,
/// a ray meets them all.
constexpr std::uint64_t kFreeWork = std::uint64_t{1} << 28, kWorkForEach = 1 << 11;

std::uint64_t mostWork(const Scene& scene) {
  const MeshView& target = scene.targetMesh;
  const std::size_t poses = target.poses.size() / target.positions.size();
  return kFreeWork + kWorkForEach * (1 + poses) * (scene.points.count + target.indices.size() / 3);
}

/// Steps 1 to 3: where points lie on the cage, and whether it covers them.
void projectAndMark(const Scene& scene, PointData& data, Timings& times) {
  timed(times.project, [&] { projectPoints(scene, data); });
  timed(times.covered, [&] { findCageDistances(scene, data); });
  timed(times.occluded, [&] { markOccluded(scene, data); });
  timed(times.covered, [&] { markUncovered(scene, data); });
}

/// Steps 4 and 7: the segments and their areas.
/// @param isOuter  1 per boundary loop, with step 10; else null.
void measureSegments(const Scene& scene, PointData& data, const bool* isOuter, Array<SegmentStats>& stats) {
  const Steps& steps = scene.options.steps;
  const bool isFiltered = steps.projection == ProjectionMode::nearestPoint;
  findSegments(scene, data, stats);
  InteriorSamples samples;
  if (isFiltered && steps.interiorSamples) placeInteriorSamples(scene, data, stats, samples);
  Timings ofSamples;  // Counted as a part of step 4.
  if (samples.triangleCount > 0) projectAndMark(scene, samples.data, ofSamples);
  if (samples.triangleCount > 0 && isOuter != nullptr) markSamplesBeyond(scene, samples.data, isOuter);
  sumAreas(scene, samples, data, stats);
}

/// Steps 9, 10 and 13: which points are recovered if their segment is not culled.
void findRecovery(const Scene& scene, PointData& data, HiderRecords& hiders, Projection& out) {
  const Steps& steps = scene.options.steps;
  if (steps.projection != ProjectionMode::nearestPoint || !(steps.recheck || steps.holes)) return;
  data.recovery = scene.arena.allocate<std::uint32_t>(data.points.count);
  if (scene.arena.failed()) return;
  std::fill(data.recovery, data.recovery + data.points.count, Recovery::never);
  if (steps.recheck) {
    timed(out.timings.recheck, [&] {
      findHiders(scene, data, out.segmentStats, hiders);
      if (!scene.arena.failed()) recheckOccluded(scene, data, out.segmentStats, hiders);
    });
    if (scene.options.motion && !scene.arena.failed())
      timed(out.timings.motion, [&] { findMotion(scene, data, out.segmentStats, hiders); });
  }
  if (steps.holes) timed(out.timings.holes, [&] { assignHoles(scene, data, out.segmentStats, out.holeShares); });
}

/// Hands the results of the points to their vertices, in the caller's units and numbering.
void writeProjection(const Scene& scene, const PointData& data, const HiderRecords& hiders, Projection& out) {
  const std::size_t vertexCount = scene.targetMesh.positions.size() / 3;
  if (scene.arena.failed() || !out.uvs.reset(2 * vertexCount) || !out.visibility.reset(vertexCount) ||
      !out.triangles.reset(vertexCount) || !out.distances.reset(vertexCount) || !out.segments.reset(vertexCount) ||
      !out.recovery.reset(data.recovery == nullptr ? 0 : vertexCount) ||
      !out.hiddenBy.reset(hiders.empty() ? 0 : vertexCount) ||
      !(hiders.empty() ? out.hiders.reset(0) : hiders.copyTo(out.hiders))) {
    return scene.arena.fail();
  }
  const float toInput = 1 / scene.units.scale;  // A power of two, like the scale.
  // Copies on the stack: their pointers need no reload after each store to `out`.
  const PointData from = data;
  const CageTriangle* const cage = scene.cage.triangles;
  float* const uvs = out.uvs.data();
  Visibility* const visibility = out.visibility.data();
  std::uint32_t* const triangles = out.triangles.data();
  float* const distances = out.distances.data();
  std::uint32_t* const segments = out.segments.data();
  for (std::size_t v = 0; v < vertexCount; ++v) {
    const std::size_t i = from.points.ofVertex[v];
    std::memcpy(uvs + 2 * v, from.uvs + 2 * i, 2 * sizeof(float));
    visibility[v] = from.visibility[i];
    triangles[v] = cage[from.cageTriangles[i]].index;
    distances[v] = from.distances[i] * toInput;
    segments[v] = from.segments[i];
  }
  for (std::size_t v = 0; v < out.recovery.size(); ++v) out.recovery[v] = from.recovery[from.points.ofVertex[v]];
  for (std::size_t v = 0; v < out.hiddenBy.size(); ++v) out.hiddenBy[v] = from.hiddenBy[from.points.ofVertex[v]];
}

template <typename... T>
std::uint64_t bytesOf(const Array<T>&... arrays) {
  return ((arrays.size() * sizeof(T)) + ...);
}

struct Meshes {
  const MeshView& cage;
  const MeshView& target;
  bool isPart;  ///< Whether the target is a part of another: outer borders of the cage are not looked for.
};

Status project(const Meshes& meshes, const TransferOptions& options, Workspace& workspace, Projection& out) noexcept {
  Timings& times = out.timings = {};
  const Timer timer(times.total);
  if (const Status status = checkOptions(options, Stage::project); !status.ok()) return status;
  Arena* const arena = workspace.restart();
  if (arena == nullptr || !out.holeShares.reset(0)) return {Code::outOfMemory};

  Scene scene(meshes.cage, meshes.target, options, *arena);
  if (const Status status = timed(times.weld, [&] { return scene.load(); }); !status.ok()) return status;
  arena->limitWork(mostWork(scene));
  PointData points(scene.points, options, *arena);
  bool* isOuter = nullptr;
  if (options.steps.projection == ProjectionMode::nearestPoint) {
    timed(times.build, [&] { scene.buildTrees(); });
    projectAndMark(scene, points, times);
    if (options.steps.holes && !meshes.isPart) {
      isOuter = arena->allocate<bool>(scene.loops.count);
      if (!arena->failed()) timed(times.holes, [&] { markBeyond(scene, points, isOuter); });
    }
  } else {
    timed(times.project, [&] { projectToVertices(scene, points); });
  }
  timed(times.segments, [&] { measureSegments(scene, points, isOuter, out.segmentStats); });
  HiderRecords hiders(*arena);
  findRecovery(scene, points, hiders, out);
  timed(times.segments, [&] { writeProjection(scene, points, hiders, out); });
  const bool hasCornerUvs = options.seams == Seams::corner && options.steps.projection == ProjectionMode::nearestPoint;
  if (hasCornerUvs) {
    timed(times.seams, [&] { projectCorners(scene, points, out.cornerUvs); });
  } else if (!out.cornerUvs.reset(0)) {
    arena->fail();
  }

  out.peakBytes =
      arena->peak() + bytesOf(out.uvs, out.cornerUvs, out.visibility, out.triangles, out.distances, out.segments,
                              out.segmentStats, out.recovery, out.hiddenBy, out.hiders, out.holeShares);
  if (arena->isExhausted()) return {Code::tooComplex, Argument::target};
  return arena->failed() ? Status{Code::outOfMemory} : Status{};
}

}  // namespace

Status project(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
               Projection& out) noexcept {
  return project({cage, target, false}, options, workspace, out);
}

Status projectPart(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
                   Projection& out) noexcept {
  return project({cage, target, true}, options, workspace, out);
}

Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
                TransferResult& out) noexcept {
  if (const Status status = checkOptions(options); !status.ok()) return status;
  if (const Status status = checkMasks(options.masks, target.positions.size() / 3, target.indices.size() / 3);
      !status.ok())
    return status;
  Projection& projection = out.projection;
  Zones& zones = out.zones;
  if (const Status status = project(cage, target, options, workspace, projection); !status.ok()) return status;
  Timings& times = projection.timings;
  const Status status =
      timed(times.classify, [&] { return classify(projection.view(), target.indices, options, zones); });
  if (!status.ok()) return status;
  out.setVerdicts();
  times.total += times.classify;
  projection.peakBytes +=
      bytesOf(zones.zones, zones.cosmeticTriangles, zones.culledBy, zones.ratios, zones.explainedHoles);
  return {};
}

}  // namespace cagecast
