/// The bridge from JavaScript. What a call leaves stays until `release` (bridge.hpp). Nothing is decided here; names,
/// defaults and messages for people are the package's.

#include <cagecast/split.hpp>

#include "bridge.hpp"

namespace cagecast {

/// This and the next ones in the order of wasm/src/transfer.ts.
template <typename Visit>
void eachField(SegmentStats& s, const Visit& visit) {
  visit(s.points), visit(s.area), visit(s.exposedArea), visit(s.coveredArea), visit(s.depthWeightedArea),
      visit(s.group), visit(s.twinOf);
}

template <typename Visit>
void eachField(HoleShare& s, const Visit& visit) {
  visit(s.hole), visit(s.segment), visit(s.exposedArea), visit(s.uncoveredArea), visit(s.hiddenArea);
}

template <typename Visit>
void eachField(Projection& p, const Visit& visit) {
  Timings& t = p.timings;
  visit(t.weld), visit(t.build), visit(t.project), visit(t.occluded), visit(t.covered), visit(t.segments),
      visit(t.secondLook);
  visit(t.holes), visit(t.seams), visit(t.classify), visit(t.total), visit(p.peakBytes);
}

}  // namespace cagecast

namespace {

using namespace cagecast::bridge;
using cagecast::Array;
using cagecast::Status;
using cagecast::Zone;

/// What a call leaves for JavaScript.
struct Call {
  cagecast::TransferResult result;
  cagecast::SplitVertices split;
  Array<double> stats, shares, numbers;
  Array<cagecast::LockEntry> locks;
};

[[clang::no_destroy]] Call call;
[[clang::no_destroy]] cagecast::Workspace workspace;

/// Of one lock per segment, or none.
cagecast::TransferOptions optionsWithLocks(std::size_t place) {
  cagecast::TransferOptions options = givenOptions();
  const auto locks = input<cagecast::Lock>(place);
  if (call.locks.reset(locks.size())) {
    for (std::uint32_t s = 0; s < locks.size(); ++s) call.locks[s] = {s, locks[s]};
    options.locks.segments = call.locks;
  }
  return options;
}

/// What a projection and a transfer both answer, and more.
std::uintptr_t projected(const Status& status, const Array<Zone>& zones, const Bytes (&more)[3]) {
  cagecast::Projection& p = call.result.projection;
  if (!status.ok()) return answer(status);
  if (!toNumbers(std::span(p.segmentStats.begin(), p.segmentStats.end()), call.stats) ||
      !toNumbers(std::span(&p, 1), call.numbers)) {
    return answer(kOutOfMemory);
  }
  return answer(status, {bytes(p.uvs), bytes(p.cornerUvs), bytes(zones), bytes(p.triangles), bytes(p.distances),
                         bytes(p.segments), bytes(call.stats), bytes(call.numbers), more[0], more[1], more[2]});
}

/// The answer of a transfer.
std::uintptr_t transferred(const Status& status) {
  const cagecast::Zones& zones = call.result.zones;
  return projected(status, zones.zones, {bytes(zones.cosmeticTriangles), bytes(zones.culledBy), bytes(zones.scores)});
}

}  // namespace

extern "C" {

/// Of the inputs: options, cage, target.
EMSCRIPTEN_KEEPALIVE std::uintptr_t project() {
  cagecast::Projection& p = call.result.projection;
  const Status status = cagecast::project(mesh(1), mesh(5), givenOptions(), workspace, p);
  if (status.ok() && !toNumbers(std::span(p.holeShares.begin(), p.holeShares.end()), call.shares))
    return answer(kOutOfMemory);
  return projected(status, p.zones, {bytes(p.recovery), bytes(call.shares), std::as_bytes(mesh(5).indices)});
}

/// As `project`.
EMSCRIPTEN_KEEPALIVE std::uintptr_t transfer() {
  return transferred(cagecast::transfer(mesh(1), mesh(5), givenOptions(), workspace, call.result));
}

/// The first half of `transfer`, for those who must know the segments to say which are locked: of the answer their
/// numbers alone.
EMSCRIPTEN_KEEPALIVE std::uintptr_t beginTransfer() {
  cagecast::Projection& p = call.result.projection;
  const Status status = cagecast::project(mesh(1), mesh(5), givenOptions(), workspace, p);
  if (!status.ok()) return answer(status);
  if (!toNumbers(std::span(p.segmentStats.begin(), p.segmentStats.end()), call.stats)) return answer(kOutOfMemory);
  return answer(status, {bytes(call.stats)});
}

/// The second half, with what the first was given still there: of a lock per segment besides, after the target.
EMSCRIPTEN_KEEPALIVE std::uintptr_t endTransfer() {
  const cagecast::TransferOptions classifyOptions = optionsWithLocks(9);
  cagecast::Projection& p = call.result.projection;
  const double start = emscripten_get_now();
  const Status status = cagecast::classify(p.view(), mesh(5).indices, classifyOptions, call.result.zones);
  p.timings.classify = emscripten_get_now() - start;
  p.timings.total += p.timings.classify;
  return transferred(status);
}

/// Of the inputs: options; zones, segments, stats, recovery, shares and indices of a projection; a lock per segment, or
/// none.
EMSCRIPTEN_KEEPALIVE std::uintptr_t classify() {
  Array<cagecast::SegmentStats> stats;
  Array<cagecast::HoleShare> shares;
  if (!stats.reset(input<double>(3).size() / fieldsOf<cagecast::SegmentStats>()) ||
      !shares.reset(input<double>(5).size() / fieldsOf<cagecast::HoleShare>())) {
    return answer(kOutOfMemory);
  }
  fromNumbers(input<double>(3).data(), std::span(stats.begin(), stats.end()));
  fromNumbers(input<double>(5).data(), std::span(shares.begin(), shares.end()));
  const cagecast::TransferOptions classifyOptions = optionsWithLocks(7);
  cagecast::Zones& zones = call.result.zones;
  const Status status =
      cagecast::classify({input<Zone>(1), input<std::uint32_t>(2), stats, input<std::uint32_t>(4), shares},
                         input<std::uint32_t>(6), classifyOptions, zones);
  return answer(status,
                {bytes(zones.zones), bytes(zones.cosmeticTriangles), bytes(zones.culledBy), bytes(zones.scores)});
}

/// Of the inputs: indices, UVs per corner.
EMSCRIPTEN_KEEPALIVE std::uintptr_t splitVertices(unsigned vertexCount) {
  cagecast::SplitVertices& split = call.split;
  const Status status = cagecast::splitVertices(input<std::uint32_t>(0), input<float>(1), vertexCount, split);
  return answer(status, {bytes(split.sources), bytes(split.indices), bytes(split.uvs)});
}

/// Frees what a call read and left.
EMSCRIPTEN_KEEPALIVE void release() {
  renew(exchange);
  renew(call);
}

}  // extern "C"
