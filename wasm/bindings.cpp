/// The bridge from JavaScript: copies typed arrays in, calls the core, copies the answer out. Nothing is decided here;
/// names, defaults and messages for people are the package's (wasm/src).
///
/// No view into WebAssembly memory leaves: such a view is cut to length 0 when the memory grows.

#include <iterator>

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <cagecast/transfer.hpp>

namespace {

using cagecast::Array;
using cagecast::MeshView;
using emscripten::typed_memory_view;
using emscripten::val;

/// A mesh copied from JavaScript.
struct Mesh {
  Array<float> positions;
  Array<std::uint32_t> indices;
  Array<float> uvs;
  Array<std::uint32_t> groups;

  MeshView view() const noexcept { return {positions, indices, uvs, groups}; }
};

/// Copies a typed array in; elements of another type are converted as by `TypedArray.prototype.set`.
/// @return false if there is not enough memory.
template <typename T>
bool copyIn(const val& source, Array<T>& out) {
  if (!out.reset(source["length"].as<std::size_t>())) return false;
  if (!out.empty()) val(typed_memory_view(out.size(), out.data())).template call<void>("set", source);
  return true;
}

/// Copies a mesh `{ positions, indices, uvs, groups }`, all four of them typed arrays, maybe empty.
bool copyIn(const val& source, Mesh& out) {
  return copyIn(source["positions"], out.positions) && copyIn(source["indices"], out.indices) &&
         copyIn(source["uvs"], out.uvs) && copyIn(source["groups"], out.groups);
}

/// Copies an array out, into a new typed array of the class named `type` that JavaScript owns.
template <typename T>
val copyOut(const char* type, const T* data, std::size_t count) {
  return val::global(type).new_(val(typed_memory_view(count, data)));
}

val copyOut(const Array<float>& array) { return copyOut("Float32Array", array.data(), array.size()); }
val copyOut(const Array<std::uint32_t>& array) { return copyOut("Uint32Array", array.data(), array.size()); }
val copyOut(const Array<std::uint8_t>& array) { return copyOut("Uint8Array", array.data(), array.size()); }
val copyOut(const Array<cagecast::Zone>& array) {
  return copyOut("Uint8Array", reinterpret_cast<const std::uint8_t*>(array.data()), array.size());
}

/// `{ code, argument, at }`; `code` 0 is success, and then other fields may join.
val answer(const cagecast::Status& status) {
  val out = val::object();
  out.set("code", static_cast<unsigned>(status.code));
  out.set("argument", static_cast<unsigned>(status.argument));
  out.set("at", status.at);
  return out;
}

val outOfMemory() { return answer({cagecast::Code::outOfMemory, cagecast::Argument::none, 0}); }

constexpr std::size_t kStatsStride = 4;  ///< Numbers per segment on the way to and from JavaScript: points, A, E, C.

/// @return false if there is not enough memory.
bool addProjection(val& out, const cagecast::Projection& projection) {
  Array<double> numbers;
  if (!numbers.reset(projection.segmentStats.size() * kStatsStride)) return false;
  double* next = numbers.data();
  for (const cagecast::SegmentStats& segment : projection.segmentStats) {
    *next++ = segment.points;
    *next++ = segment.area;
    *next++ = segment.exposedArea;
    *next++ = segment.coveredArea;
  }
  const cagecast::Timings& t = projection.timings;
  const double timings[] = {t.weld, t.build, t.project, t.occluded, t.covered, t.segments, t.classify, t.total};

  out.set("uvs", copyOut(projection.uvs));
  out.set("triangles", copyOut(projection.triangles));
  out.set("distances", copyOut(projection.distances));
  out.set("segments", copyOut(projection.segments));
  out.set("segmentStats", copyOut("Float64Array", numbers.data(), numbers.size()));
  out.set("timings", copyOut("Float64Array", timings, std::size(timings)));
  out.set("peakBytes", static_cast<double>(projection.peakBytes));
  return true;
}

void addZones(val& out, const cagecast::Zones& zones) {
  out.set("zones", copyOut(zones.zones));
  out.set("cosmeticTriangles", copyOut(zones.cosmeticTriangles));
  out.set("culledSegments", copyOut(zones.culledSegments));
}

val project(const val& cage, const val& target, unsigned projection, float weldTolerance) {
  Mesh cageMesh, targetMesh;
  if (!copyIn(cage, cageMesh) || !copyIn(target, targetMesh)) return outOfMemory();
  cagecast::Projection result;
  const cagecast::ProjectOptions options{static_cast<cagecast::ProjectionMode>(projection), weldTolerance};
  const cagecast::Status status = cagecast::project(cageMesh.view(), targetMesh.view(), options, result);
  val out = answer(status);
  if (!status.ok()) return out;
  if (!addProjection(out, result)) return outOfMemory();
  out.set("zones", copyOut(result.zones));
  return out;
}

val transfer(const val& cage, const val& target, unsigned projection, float weldTolerance, float threshold) {
  Mesh cageMesh, targetMesh;
  if (!copyIn(cage, cageMesh) || !copyIn(target, targetMesh)) return outOfMemory();
  cagecast::TransferResult result;
  const cagecast::TransferOptions options{{static_cast<cagecast::ProjectionMode>(projection), weldTolerance},
                                          {threshold}};
  const cagecast::Status status = cagecast::transfer(cageMesh.view(), targetMesh.view(), options, result);
  val out = answer(status);
  if (!status.ok()) return out;
  if (!addProjection(out, result.projection)) return outOfMemory();
  addZones(out, result.zones);
  return out;
}

val classify(const val& zones, const val& segments, const val& segmentStats, const val& indices, float threshold) {
  Array<std::uint8_t> zoneNumbers;
  Array<std::uint32_t> segmentIds, corners;
  Array<double> numbers;
  if (!copyIn(zones, zoneNumbers) || !copyIn(segments, segmentIds) || !copyIn(segmentStats, numbers) ||
      !copyIn(indices, corners)) {
    return outOfMemory();
  }
  Array<cagecast::Zone> zoneValues;
  Array<cagecast::SegmentStats> stats;
  if (!zoneValues.reset(zoneNumbers.size()) || !stats.reset(numbers.size() / kStatsStride)) return outOfMemory();
  for (std::size_t v = 0; v < zoneNumbers.size(); ++v) zoneValues[v] = static_cast<cagecast::Zone>(zoneNumbers[v]);
  for (std::size_t s = 0; s < stats.size(); ++s) {
    const double* n = numbers.data() + s * kStatsStride;
    stats[s] = {static_cast<std::uint32_t>(n[0]), false, n[1], n[2], n[3]};
  }
  cagecast::Zones result;
  const cagecast::Status status = cagecast::classify({zoneValues, segmentIds, stats}, corners, {threshold}, result);
  val out = answer(status);
  if (status.ok()) addZones(out, result);
  return out;
}

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast) {
  emscripten::function("project", &project);
  emscripten::function("transfer", &transfer);
  emscripten::function("classify", &classify);
}
