/// The bridge from JavaScript: copies typed arrays in, calls the core, copies the answer out. Nothing is decided here;
/// names, defaults and messages for people are the package's (wasm/src).
///
/// No view into WebAssembly memory leaves: such a view is cut to length 0 when the memory grows.

#include <iterator>
#include <type_traits>

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <cagecast/seams.hpp>
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

/// Calls `visit` with each option. They go to and from JavaScript as numbers in this order, which is that of
/// wasm/src/options.ts as well; so names stay out of here.
template <typename Visit>
void eachOption(cagecast::TransferOptions& o, const Visit& visit) {
  visit(o.projection), visit(o.weldTolerance), visit(o.seams), visit(o.occlusionReach), visit(o.pokeThrough);
  visit(o.votes), visit(o.depths), visit(o.secondLook), visit(o.bothSides), visit(o.holes);
  visit(o.threshold), visit(o.floor), visit(o.minCovered), visit(o.minOfAll), visit(o.maxUncovered), visit(o.copies), visit(o.partialTriangles);
}
constexpr std::size_t kOptions = 17;

/// @param numbers  kOptions numbers.
cagecast::TransferOptions optionsFrom(const val& numbers) {
  double values[kOptions];
  val(typed_memory_view(kOptions, values)).call<void>("set", numbers);
  cagecast::TransferOptions options;
  const double* next = values;
  eachOption(options, [&]<typename T>(T& option) {
    if constexpr (std::is_enum_v<T>) {
      option = static_cast<T>(static_cast<unsigned>(*next++));
    } else {
      option = static_cast<T>(*next++);
    }
  });
  return options;
}

/// The options of a preset: 0 `paper`, 1 `default`.
val presetOptions(unsigned preset) {
  auto options = preset == 0 ? cagecast::TransferOptions::paper() : cagecast::TransferOptions::standard();
  double values[kOptions];
  double* next = values;
  eachOption(options, [&](const auto& option) { *next++ = static_cast<double>(option); });
  return copyOut("Float64Array", values, kOptions);
}

/// Numbers per segment on the way to and from JavaScript: points, A, E, C, D, group, the first of its copies.
constexpr std::size_t kStatsStride = 7;
/// Numbers per share of a hole: hole, segment, exposed area, uncovered area.
constexpr std::size_t kShareStride = 4;

/// @return false if there is not enough memory.
bool addProjection(val& out, const cagecast::Projection& projection) {
  Array<double> stats, shares;
  if (!stats.reset(projection.segmentStats.size() * kStatsStride) || !shares.reset(projection.holeShares.size() * kShareStride)) {
    return false;
  }
  double* next = stats.data();
  for (const cagecast::SegmentStats& s : projection.segmentStats) {
    for (const double number : {double(s.points), s.area, s.exposedArea, s.coveredArea, s.sunkArea, double(s.group), double(s.copyOf)}) {
      *next++ = number;
    }
  }
  next = shares.data();
  for (const cagecast::HoleShare& s : projection.holeShares) {
    for (const double number : {double(s.hole), double(s.segment), s.exposedArea, s.uncoveredArea}) *next++ = number;
  }
  const cagecast::Timings& t = projection.timings;
  const double timings[] = {t.weld,     t.build,      t.project, t.occluded, t.covered, t.segments,
                            t.secondLook, t.holes, t.seams,   t.classify, t.total};

  out.set("uvs", copyOut(projection.uvs));
  out.set("cornerUvs", copyOut(projection.cornerUvs));
  out.set("triangles", copyOut(projection.triangles));
  out.set("distances", copyOut(projection.distances));
  out.set("segments", copyOut(projection.segments));
  out.set("segmentStats", copyOut("Float64Array", stats.data(), stats.size()));
  out.set("restores", copyOut(projection.restores));
  out.set("holeShares", copyOut("Float64Array", shares.data(), shares.size()));
  out.set("timings", copyOut("Float64Array", timings, std::size(timings)));
  out.set("peakBytes", static_cast<double>(projection.peakBytes));
  return true;
}

void addZones(val& out, const cagecast::Zones& zones) {
  out.set("zones", copyOut(zones.zones));
  out.set("cosmeticTriangles", copyOut(zones.cosmeticTriangles));
  out.set("culledSegments", copyOut(zones.culledSegments));
}

val project(const val& cage, const val& target, const val& options) {
  Mesh cageMesh, targetMesh;
  if (!copyIn(cage, cageMesh) || !copyIn(target, targetMesh)) return outOfMemory();
  cagecast::Projection result;
  const cagecast::Status status =
      cagecast::project(cageMesh.view(), targetMesh.view(), optionsFrom(options), result);
  val out = answer(status);
  if (!status.ok()) return out;
  if (!addProjection(out, result)) return outOfMemory();
  out.set("zones", copyOut(result.zones));
  return out;
}

val transfer(const val& cage, const val& target, const val& options) {
  Mesh cageMesh, targetMesh;
  if (!copyIn(cage, cageMesh) || !copyIn(target, targetMesh)) return outOfMemory();
  cagecast::TransferResult result;
  const cagecast::Status status = cagecast::transfer(cageMesh.view(), targetMesh.view(), optionsFrom(options), result);
  val out = answer(status);
  if (!status.ok()) return out;
  if (!addProjection(out, result.projection)) return outOfMemory();
  addZones(out, result.zones);
  return out;
}

/// Classifies `{ zones, segments, segmentStats, restores, holeShares, indices }`, the latter three in numbers as
/// `addProjection` gives them. `locks` has a number per segment, or none.
val classify(const val& projection, const val& options, const val& locks) {
  Array<std::uint8_t> zoneNumbers, lockNumbers;
  Array<std::uint32_t> segments, restores, indices;
  Array<double> statNumbers, shareNumbers;
  if (!copyIn(projection["zones"], zoneNumbers) || !copyIn(projection["segments"], segments) ||
      !copyIn(projection["segmentStats"], statNumbers) || !copyIn(projection["restores"], restores) ||
      !copyIn(projection["holeShares"], shareNumbers) || !copyIn(projection["indices"], indices) ||
      !copyIn(locks, lockNumbers)) {
    return outOfMemory();
  }
  Array<cagecast::Zone> zones;
  Array<cagecast::Lock> lockValues;
  Array<cagecast::SegmentStats> stats;
  Array<cagecast::HoleShare> shares;
  if (!zones.reset(zoneNumbers.size()) || !lockValues.reset(lockNumbers.size()) ||
      !stats.reset(statNumbers.size() / kStatsStride) || !shares.reset(shareNumbers.size() / kShareStride)) {
    return outOfMemory();
  }
  for (std::size_t v = 0; v < zones.size(); ++v) zones[v] = static_cast<cagecast::Zone>(zoneNumbers[v]);
  for (std::size_t s = 0; s < lockValues.size(); ++s) lockValues[s] = static_cast<cagecast::Lock>(lockNumbers[s]);
  for (std::size_t s = 0; s < stats.size(); ++s) {
    const double* n = statNumbers.data() + s * kStatsStride;
    stats[s] = {.points = static_cast<std::uint32_t>(n[0]),
                .area = n[1],
                .exposedArea = n[2],
                .coveredArea = n[3],
                .group = static_cast<std::uint32_t>(n[5]),
                .copyOf = static_cast<std::uint32_t>(n[6]),
                .sunkArea = n[4]};
  }
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double* n = shareNumbers.data() + i * kShareStride;
    shares[i] = {static_cast<std::uint32_t>(n[0]), static_cast<std::uint32_t>(n[1]), n[2], n[3]};
  }
  cagecast::ClassifyOptions classifyOptions = optionsFrom(options);
  classifyOptions.locks = lockValues;
  cagecast::Zones result;
  const cagecast::Status status = cagecast::classify({zones, segments, stats, restores, shares}, indices, classifyOptions, result);
  val out = answer(status);
  if (status.ok()) addZones(out, result);
  return out;
}

val splitVertices(const val& indices, const val& cornerUvs, unsigned vertexCount) {
  Array<std::uint32_t> corners;
  Array<float> uvs;
  if (!copyIn(indices, corners) || !copyIn(cornerUvs, uvs)) return outOfMemory();
  cagecast::SplitVertices result;
  const cagecast::Status status = cagecast::splitVertices(corners, uvs, vertexCount, result);
  val out = answer(status);
  if (!status.ok()) return out;
  out.set("sources", copyOut(result.sources));
  out.set("indices", copyOut(result.indices));
  out.set("uvs", copyOut(result.uvs));
  return out;
}

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast) {
  emscripten::function("presetOptions", &presetOptions);
  emscripten::function("project", &project);
  emscripten::function("transfer", &transfer);
  emscripten::function("classify", &classify);
  emscripten::function("splitVertices", &splitVertices);
}
