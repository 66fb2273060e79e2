/// The bridge from JavaScript. Only numbers go through embind: JavaScript writes its arrays where `room` says, and copies
/// those of an answer from where its table says, until `release` (wasm/src/bindings.ts). Nothing is decided here; names,
/// defaults and messages for people are the package's.

#include <memory>
#include <span>
#include <type_traits>

#include <emscripten/bind.h>

#include <cagecast/seams.hpp>
#include <cagecast/transfer.hpp>

namespace {

using cagecast::Array;
using cagecast::MeshView;
using cagecast::Status;

using Bytes = std::span<const std::byte>;

/// Most arrays of an answer.
constexpr std::size_t kMostArrays = 13;

/// What a call reads and what it leaves for JavaScript.
struct Call {
  Array<std::byte> inputs[9];
  cagecast::TransferResult result;
  cagecast::SplitVertices split;
  Array<double> options, stats, shares, numbers;
  /// Code, argument and place of the status; then for each array of the answer its address and its size in bytes.
  std::uintptr_t answer[3 + 2 * kMostArrays];
};

[[clang::no_destroy]] Call call;

/// Makes room for an array from JavaScript, in bytes.
/// @return Where it belongs; 0 if there is not enough memory.
std::uintptr_t room(std::size_t place, std::size_t bytes) {
  return call.inputs[place].reset(bytes) ? reinterpret_cast<std::uintptr_t>(call.inputs[place].data()) : 0;
}

template <typename T>
std::span<const T> input(std::size_t place) {
  return {reinterpret_cast<const T*>(call.inputs[place].data()), call.inputs[place].size() / sizeof(T)};
}

/// A mesh in four places: positions, indices, UVs, groups.
MeshView mesh(std::size_t place) {
  return {input<float>(place), input<std::uint32_t>(place + 1), input<float>(place + 2), input<std::uint32_t>(place + 3)};
}

/// @return Where `answer` is.
std::uintptr_t answer(const Status& status, std::span<const Bytes> arrays = {}) {
  std::uintptr_t* next = call.answer;
  *next++ = static_cast<std::uintptr_t>(status.code);
  *next++ = static_cast<std::uintptr_t>(status.argument);
  *next++ = status.at;
  for (const Bytes array : arrays) {
    *next++ = reinterpret_cast<std::uintptr_t>(array.data());
    *next++ = array.size();
  }
  return reinterpret_cast<std::uintptr_t>(call.answer);
}

template <std::size_t kCount>
std::uintptr_t answer(const Status& status, const Bytes (&arrays)[kCount]) {
  static_assert(kCount <= kMostArrays);
  return answer(status, std::span<const Bytes>(arrays));
}

template <typename T>
Bytes bytes(const Array<T>& array) {
  return std::as_bytes(std::span<const T>(array.begin(), array.end()));
}

// Structures go to and from JavaScript as numbers, field by field in these orders; so names stay out of here.

/// In the order of wasm/src/options.ts.
template <typename Visit>
void eachField(cagecast::TransferOptions& o, const Visit& visit) {
  visit(o.projection), visit(o.weldTolerance), visit(o.seams), visit(o.occlusionReach), visit(o.pokeThrough);
  visit(o.votes), visit(o.depths), visit(o.secondLook), visit(o.bothSides), visit(o.holes);
  visit(o.threshold), visit(o.floor), visit(o.minCovered), visit(o.minOfAll), visit(o.maxUncovered), visit(o.copies), visit(o.partialTriangles);
}

/// This and the next ones in the order of wasm/src/transfer.ts.
template <typename Visit>
void eachField(cagecast::SegmentStats& s, const Visit& visit) {
  visit(s.points), visit(s.area), visit(s.exposedArea), visit(s.coveredArea), visit(s.sunkArea), visit(s.group), visit(s.copyOf);
}

template <typename Visit>
void eachField(cagecast::HoleShare& s, const Visit& visit) {
  visit(s.hole), visit(s.segment), visit(s.exposedArea), visit(s.uncoveredArea);
}

template <typename Visit>
void eachField(cagecast::Projection& p, const Visit& visit) {
  cagecast::Timings& t = p.timings;
  visit(t.weld), visit(t.build), visit(t.project), visit(t.occluded), visit(t.covered), visit(t.segments), visit(t.secondLook);
  visit(t.holes), visit(t.seams), visit(t.classify), visit(t.total), visit(p.peakBytes);
}

template <typename Thing>
std::size_t fieldsOf() {
  Thing thing;
  std::size_t count = 0;
  eachField(thing, [&](const auto&) { ++count; });
  return count;
}

/// @return false if there is not enough memory.
template <typename Thing>
bool toNumbers(std::span<Thing> things, Array<double>& out) {
  if (!out.reset(things.size() * fieldsOf<Thing>())) return false;
  double* next = out.data();
  for (Thing& thing : things) {
    eachField(thing, [&](const auto& field) { *next++ = static_cast<double>(field); });
  }
  return true;
}

template <typename Thing>
void fromNumbers(const double* numbers, std::span<Thing> out) {
  for (Thing& thing : out) {
    eachField(thing, [&]<typename T>(T& field) {
      if constexpr (std::is_enum_v<T>) {
        field = static_cast<T>(static_cast<unsigned>(*numbers++));
      } else {
        field = static_cast<T>(*numbers++);
      }
    });
  }
}

constexpr Status kOutOfMemory{cagecast::Code::outOfMemory};

cagecast::TransferOptions options() {
  cagecast::TransferOptions options;
  fromNumbers(input<double>(0).data(), std::span(&options, 1));
  return options;
}

/// The options of a preset: 0 `paper`, 1 `default`.
std::uintptr_t presetOptions(unsigned preset) {
  auto options = preset == 0 ? cagecast::TransferOptions::paper() : cagecast::TransferOptions::standard();
  if (!toNumbers(std::span(&options, 1), call.options)) return answer(kOutOfMemory);
  return answer({}, {bytes(call.options)});
}

/// The answer of a projection, or of a transfer.
std::uintptr_t projection(const Status& status, const Array<cagecast::Zone>& zones) {
  cagecast::Projection& p = call.result.projection;
  if (!status.ok()) return answer(status);
  if (!toNumbers(std::span(p.segmentStats.begin(), p.segmentStats.end()), call.stats) ||
      !toNumbers(std::span(p.holeShares.begin(), p.holeShares.end()), call.shares) || !toNumbers(std::span(&p, 1), call.numbers)) {
    return answer(kOutOfMemory);
  }
  return answer(status, {bytes(p.uvs), bytes(p.cornerUvs), bytes(zones), bytes(p.triangles), bytes(p.distances), bytes(p.segments),
                         bytes(call.stats), bytes(p.restores), bytes(call.shares), bytes(call.numbers),
                         bytes(call.result.zones.cosmeticTriangles), bytes(call.result.zones.culledSegments), bytes(call.result.zones.margins)});
}

/// Of the inputs: options, cage, target.
std::uintptr_t project() {
  const Status status = cagecast::project(mesh(1), mesh(5), options(), call.result.projection);
  return projection(status, call.result.projection.zones);
}

/// As `project`.
std::uintptr_t transfer() {
  const Status status = cagecast::transfer(mesh(1), mesh(5), options(), call.result);
  return projection(status, call.result.zones.zones);
}

/// Of the inputs: options; zones, segments, stats, restores, shares and indices of a projection; a lock per segment, or none.
std::uintptr_t classify() {
  Array<cagecast::SegmentStats> stats;
  Array<cagecast::HoleShare> shares;
  if (!stats.reset(input<double>(3).size() / fieldsOf<cagecast::SegmentStats>()) ||
      !shares.reset(input<double>(5).size() / fieldsOf<cagecast::HoleShare>())) {
    return answer(kOutOfMemory);
  }
  fromNumbers(input<double>(3).data(), std::span(stats.begin(), stats.end()));
  fromNumbers(input<double>(5).data(), std::span(shares.begin(), shares.end()));
  cagecast::ClassifyOptions classifyOptions = options();
  classifyOptions.locks = input<cagecast::Lock>(7);
  cagecast::Zones& zones = call.result.zones;
  const Status status = cagecast::classify({input<cagecast::Zone>(1), input<std::uint32_t>(2), stats, input<std::uint32_t>(4), shares},
                                           input<std::uint32_t>(6), classifyOptions, zones);
  return answer(status, {bytes(zones.zones), bytes(zones.cosmeticTriangles), bytes(zones.culledSegments), bytes(zones.margins)});
}

/// Of the inputs: indices, UVs per corner.
std::uintptr_t splitVertices(unsigned vertexCount) {
  cagecast::SplitVertices& split = call.split;
  const Status status = cagecast::splitVertices(input<std::uint32_t>(0), input<float>(1), vertexCount, split);
  return answer(status, {bytes(split.sources), bytes(split.indices), bytes(split.uvs)});
}

/// Frees what a call read and left.
void release() {
  std::destroy_at(&call);
  std::construct_at(&call);
}

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast) {
  emscripten::function("room", &room);
  emscripten::function("presetOptions", &presetOptions);
  emscripten::function("project", &project);
  emscripten::function("transfer", &transfer);
  emscripten::function("classify", &classify);
  emscripten::function("splitVertices", &splitVertices);
  emscripten::function("release", &release);
}
