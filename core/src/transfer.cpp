#include "cagecast/transfer.hpp"

#include <algorithm>

#include "check.hpp"
#include "cpu_clock.hpp"
#include "seams.hpp"
#include "steps.hpp"

namespace cagecast {
namespace {

thread_local Scratch scratch;

constexpr Status kOutOfMemory{Code::outOfMemory};

bool takeResults(std::uint32_t count, PointResults& results) {
  results.uvs = scratch.take<float>(std::size_t{2} * count);
  results.distances = scratch.take<float>(count);
  results.triangles = scratch.take<std::uint32_t>(count);
  results.zones = scratch.take<Zone>(count);
  results.meetsCage = scratch.take<bool>(count);
  results.segments = scratch.take<std::uint32_t>(count);
  return !scratch.failed();
}

/// Hands the results of the points to their vertices, in the caller's units and numbering.
bool writeOut(const Points& points, const Cage& cage, const Units& units, const PointResults& results,
              std::uint32_t vertexCount, Projection& out) {
  if (!out.uvs.reset(std::size_t{2} * vertexCount) || !out.zones.reset(vertexCount) || !out.triangles.reset(vertexCount) ||
      !out.distances.reset(vertexCount) || !out.segments.reset(vertexCount)) {
    return false;
  }
  const float toInput = 1 / units.scale;  // A power of two, like the scale.
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t i = points.ofVertex[v];
    out.uvs[std::size_t{2} * v] = results.uvs[std::size_t{2} * i];
    out.uvs[std::size_t{2} * v + 1] = results.uvs[std::size_t{2} * i + 1];
    out.zones[v] = results.zones[i];
    out.triangles[v] = cage.triangles[results.triangles[i]].index;
    out.distances[v] = results.distances[i] * toInput;
    out.segments[v] = results.segments[i];
  }
  return true;
}

}  // namespace

Status project(const MeshView& cageMesh, const MeshView& targetMesh, const ProjectOptions& options, Projection& out) noexcept {
  StopWatch watch;
  scratch.begin();
  out.timings = {};
  const auto vertexCount = static_cast<std::uint32_t>(targetMesh.positions.size() / 3);

  Units units;
  if (const Status status = checkInput(cageMesh, targetMesh, options, units); !status.ok()) return status;
  Cage cage;
  if (!gatherCage(cageMesh, units, scratch, cage)) return kOutOfMemory;
  if (cage.count == 0) return {Code::noUsableCageTriangle, Argument::cage};
  Points points;
  if (!weld(targetMesh, units, options.weldTolerance, scratch, points)) return kOutOfMemory;
  PointResults results;
  if (!takeResults(points.count, results)) return kOutOfMemory;
  out.timings.weld = watch.lap();

  if (options.projection == ProjectionMode::nearestVertex) {
    if (!projectToVertices(cageMesh, points, cage, units, scratch, results)) return kOutOfMemory;
    out.timings.project = watch.lap();
  } else {
    CageTree cageTree;
    RayTree targetTree;
    if (!buildCageTree(cage, units, scratch, cageTree) || !buildTargetTree(points, units, scratch, targetTree)) return kOutOfMemory;
    out.timings.build = watch.lap();
    if (!projectPoints(points, cage, cageTree, units, scratch, results)) return kOutOfMemory;
    out.timings.project = watch.lap();
    if (!markOccluded(points, cage, targetTree, units, scratch, results)) return kOutOfMemory;
    out.timings.occluded = watch.lap();
    if (!markUncovered(points, cage, cageTree, units, scratch, results)) return kOutOfMemory;
    out.timings.covered = watch.lap();
  }

  if (!findSegments(points, vertexCount, units, scratch, results, out.segmentStats)) return kOutOfMemory;
  if (!writeOut(points, cage, units, results, vertexCount, out)) return kOutOfMemory;
  out.timings.segments = watch.lap();

  const bool atCorners = options.seams == Seams::corner && options.projection == ProjectionMode::nearestPoint;
  if (!out.cornerUvs.reset(atCorners ? 2 * targetMesh.indices.size() : 0)) return kOutOfMemory;
  if (atCorners && !findCornerUvs(cageMesh, targetMesh, points, cage, units, results, scratch, out.cornerUvs.data())) return kOutOfMemory;
  out.timings.seams = watch.lap();
  const Timings& t = out.timings;
  out.timings.total = t.weld + t.build + t.project + t.occluded + t.covered + t.segments + t.seams;
  out.peakBytes = scratch.peak() + vertexCount * (2 * sizeof(float) + sizeof(Zone) + 2 * sizeof(std::uint32_t) + sizeof(float)) +
                  out.segmentStats.size() * sizeof(SegmentStats) + out.cornerUvs.size() * sizeof(float);
  return {};
}

Status transfer(const MeshView& cage, const MeshView& target, const TransferOptions& options, TransferResult& out) noexcept {
  if (const Status status = checkClassifyOptions(options); !status.ok()) return status;
  Projection& projection = out.projection;
  if (const Status status = project(cage, target, options, projection); !status.ok()) return status;
  StopWatch watch;
  if (const Status status = classify(projection.zones, projection.segments, projection.segmentStats, target.indices, options, out.zones);
      !status.ok()) {
    return status;
  }
  for (std::size_t s = 0; s < projection.segmentStats.size(); ++s) projection.segmentStats[s].culled = out.zones.culledSegments[s] != 0;
  projection.timings.classify = watch.lap();
  projection.timings.total += projection.timings.classify;
  projection.peakBytes += out.zones.zones.size() + out.zones.cosmeticTriangles.size() + out.zones.culledSegments.size();
  return {};
}

void releaseScratch() noexcept { scratch.release(); }

}  // namespace cagecast
