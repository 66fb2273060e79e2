#include "cagecast/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/timer.hpp"
#include "input/validate.hpp"
#include "seams/corner_uvs.hpp"
#include "steps/steps.hpp"

namespace cagecast {
namespace {

constexpr Status kOutOfMemory{Code::outOfMemory};

/// What the steps look at.
struct Scene {
  Units units;
  Cage cage;
  CageTree cageTree;
  RayTree targetTree;
  HalfEdges halfEdges;
  BoundaryLoops loops;
};

bool takeResults(std::uint32_t count, const TransferOptions& options, Arena& arena, PointResults& results) {
  if (std::isfinite(options.occlusionReach)) results.cageDistances = arena.allocate<double>(count);
  results.uvs = arena.allocate<float>(std::size_t{2} * count);
  results.distances = arena.allocate<float>(count);
  results.triangles = arena.allocate<std::uint32_t>(count);
  results.zones = arena.allocate<Zone>(count);
  results.meetsCage = arena.allocate<bool>(count);
  results.segments = arena.allocate<std::uint32_t>(count);
  return !arena.failed();
}

/// Steps 1 to 3: where points lie on the cage, and what lies over them.
bool judge(const Points& points, const Scene& scene, const TransferOptions& options, Arena& arena,
           PointResults& results, Timings& timings, StopWatch& watch) {
  const auto& [units, cage, cageTree, targetTree, halfEdges, loops] = scene;
  if (!projectPoints(points, cage, cageTree, units, arena, results)) return false;
  timings.project += watch.lap();
  if (results.cageDistances != nullptr && !findCageDistances(points, cage, cageTree, units, arena, results))
    return false;
  timings.covered += watch.lap();
  const double reach = static_cast<double>(options.occlusionReach) * units.diagonal;
  if (!markOccluded(points, cage, targetTree, units, reach, arena, results)) return false;
  timings.occluded += watch.lap();
  const double pokeThrough = static_cast<double>(options.pokeThrough) * units.diagonal;
  if (!markUncovered(points, cage, cageTree, loops, units, pokeThrough, arena, results)) return false;
  timings.covered += watch.lap();
  return true;
}

/// Hands the results of the points to their vertices, in the caller's units and numbering.
bool writeOut(const Points& points, const Cage& cage, const Units& units, const PointResults& results,
              std::uint32_t vertexCount, Projection& out) {
  if (!out.uvs.reset(std::size_t{2} * vertexCount) || !out.zones.reset(vertexCount) ||
      !out.triangles.reset(vertexCount) || !out.distances.reset(vertexCount) || !out.segments.reset(vertexCount)) {
    return false;
  }
  const float toInput = 1 / units.scale;  // A power of two, like the scale.
  // Where all is, in variables of this function: what else knows of them is asked for each vertex.
  const auto [uvs, distances, triangles, zones, meetsCage, cageDistances, segments] = results;
  const std::uint32_t* ofVertex = points.ofVertex;
  const CageTriangle* ofCage = cage.triangles;
  float* uvsOut = out.uvs.data();
  Zone* zonesOut = out.zones.data();
  std::uint32_t* trianglesOut = out.triangles.data();
  float* distancesOut = out.distances.data();
  std::uint32_t* segmentsOut = out.segments.data();
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t i = ofVertex[v];
    std::memcpy(uvsOut + std::size_t{2} * v, uvs + std::size_t{2} * i, 2 * sizeof(float));
    zonesOut[v] = zones[i];
    trianglesOut[v] = ofCage[triangles[i]].index;
    distancesOut[v] = distances[i] * toInput;
    segmentsOut[v] = segments[i];
  }
  return true;
}

/// Steps 6 and 7: what brings each point back if its segment passes, handed to its vertices.
bool findRecovery(const Points& points, const Scene& scene, const TransferOptions& options, const PointResults& results,
                  const PointAreas& areas, std::uint32_t vertexCount, Arena& arena, Projection& out, StopWatch& watch) {
  const auto& [units, cage, cageTree, targetTree, halfEdges, loops] = scene;
  auto* recovery = arena.allocate<std::uint32_t>(points.count);
  if (arena.failed() || !out.recovery.reset(vertexCount)) return false;
  std::fill(recovery, recovery + points.count, Recovery::never);
  if (options.steps.secondLook && !recheckOccluded(points, cage, cageTree, targetTree, units, results, areas,
                                                   out.segmentStats, options, arena, recovery)) {
    return false;
  }
  out.timings.secondLook = watch.lap();
  if (options.steps.holes &&
      !assignHoles(points, cage, loops, units, results, areas, out.segmentStats, arena, recovery, out.holeShares)) {
    return false;
  }
  for (std::uint32_t v = 0; v < vertexCount; ++v) out.recovery[v] = recovery[points.ofVertex[v]];
  out.timings.holes = watch.lap();
  return true;
}

}  // namespace

Status project(const MeshView& cageMesh, const MeshView& targetMesh, const TransferOptions& options,
               Workspace& workspace, Projection& out) noexcept {
  StopWatch watch;
  Arena* const memory = workspace.restart();
  if (memory == nullptr) return kOutOfMemory;
  Arena& arena = *memory;
  out.timings = {};
  const auto vertexCount = static_cast<std::uint32_t>(targetMesh.positions.size() / 3);

  Scene scene;
  Units& units = scene.units;
  Cage& cage = scene.cage;
  if (const Status status = checkOptions(options, Stage::project); !status.ok()) return status;
  if (const Status status = checkMeshes(cageMesh, targetMesh, units); !status.ok()) return status;
  if (!gatherCage(cageMesh, units, arena, cage)) return kOutOfMemory;
  if (cage.count == 0) return {Code::noUsableCageTriangle, Argument::cage};
  Points points;
  if (!weld(targetMesh, units, options.weldTolerance, arena, points)) return kOutOfMemory;
  PointResults results;
  if (!takeResults(points.count, options, arena, results)) return kOutOfMemory;
  out.timings.weld = watch.lap();

  const bool isFiltered = options.steps.projection == ProjectionMode::nearestPoint;
  if (!isFiltered) {
    if (!projectToVertices(cageMesh, points, cage, units, arena, results)) return kOutOfMemory;
    out.timings.project = watch.lap();
  } else {
    const bool needsLoops =
        options.pokeThrough > 0 || options.steps.interiorSamples || options.steps.depthWeighting || options.steps.holes;
    const bool asksForEdges = needsLoops || options.seams == Seams::corner;
    if (!buildCageTree(cage, units, arena, scene.cageTree) ||
        !buildTargetTree(points, units, arena, scene.targetTree) ||
        (asksForEdges && !findHalfEdges(cageMesh, cage, arena, scene.halfEdges)) ||
        (needsLoops && !findBoundaryLoops(cage, scene.halfEdges, arena, scene.loops))) {
      return kOutOfMemory;
    }
    out.timings.build = watch.lap();
    if (!judge(points, scene, options, arena, results, out.timings, watch)) return kOutOfMemory;
  }

  if (!findSegments(points, vertexCount, targetMesh.groups, arena, results, out.segmentStats)) return kOutOfMemory;
  InteriorSamples samples;
  if (isFiltered && options.steps.interiorSamples) {
    if (!findInteriorSamples(points, scene.loops, units, results, out.segmentStats, options, arena, samples) ||
        !takeResults(samples.points.count, options, arena, samples.results)) {
      return kOutOfMemory;
    }
    Timings ofVoters;
    StopWatch voterWatch;
    if (samples.count > 0 && !judge(samples.points, scene, options, arena, samples.results, ofVoters, voterWatch))
      return kOutOfMemory;
  }
  PointAreas areas;
  if (!addUpAreas(points, samples, units, results, arena, areas, out.segmentStats)) return kOutOfMemory;
  if (isFiltered && options.steps.depthWeighting &&
      (!findDepthWeightedAreas(points, cage, scene.halfEdges, samples, areas, units, results, arena,
                               out.segmentStats) ||
       !findTwins(points, results, arena, out.segmentStats))) {
    return kOutOfMemory;
  }
  if (!writeOut(points, cage, units, results, vertexCount, out)) return kOutOfMemory;
  out.timings.segments = watch.lap();

  if (!out.recovery.reset(0) || !out.holeShares.reset(0)) return kOutOfMemory;
  if (isFiltered && (options.steps.secondLook || options.steps.holes) &&
      !findRecovery(points, scene, options, results, areas, vertexCount, arena, out, watch)) {
    return kOutOfMemory;
  }

  const bool atCorners = options.seams == Seams::corner && options.steps.projection == ProjectionMode::nearestPoint;
  if (!out.cornerUvs.reset(atCorners ? 2 * targetMesh.indices.size() : 0)) return kOutOfMemory;
  if (atCorners && !findCornerUvs(targetMesh, points, cage, scene.halfEdges, scene.cageTree, units, results, arena,
                                  out.cornerUvs.data()))
    return kOutOfMemory;
  out.timings.seams = watch.lap();
  const Timings& t = out.timings;
  out.timings.total =
      t.weld + t.build + t.project + t.occluded + t.covered + t.segments + t.secondLook + t.holes + t.seams;
  out.peakBytes = arena.peak() +
                  vertexCount * (2 * sizeof(float) + sizeof(Zone) + 2 * sizeof(std::uint32_t) + sizeof(float)) +
                  out.segmentStats.size() * sizeof(SegmentStats) + out.cornerUvs.size() * sizeof(float) +
                  out.recovery.size() * sizeof(std::uint32_t) + out.holeShares.size() * sizeof(HoleShare);
  return {};
}

Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
                TransferResult& out) noexcept {
  if (const Status status = checkOptions(options); !status.ok()) return status;
  Projection& projection = out.projection;
  if (const Status status = project(cage, target, options, workspace, projection); !status.ok()) return status;
  StopWatch watch;
  if (const Status status = classify(projection.view(), target.indices, options, out.zones); !status.ok()) {
    return status;
  }
  for (std::size_t s = 0; s < projection.segmentStats.size(); ++s) {
    projection.segmentStats[s].culledBy = out.zones.culledBy[s];
    projection.segmentStats[s].score = out.zones.scores[s];
  }
  projection.timings.classify = watch.lap();
  projection.timings.total += projection.timings.classify;
  projection.peakBytes += out.zones.zones.size() + out.zones.cosmeticTriangles.size() + out.zones.culledBy.size() +
                          out.zones.scores.size() * sizeof(double);
  return {};
}

}  // namespace cagecast
