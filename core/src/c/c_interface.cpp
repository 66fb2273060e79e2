#include "c/c_interface.hpp"

#include <new>

#include "cagecast/clip.hpp"
#include "cagecast/split.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast::c {
namespace {

static_assert(sizeof(CagecastLock) == sizeof(LockEntry) && sizeof(Mask) == 1 && sizeof(Zone) == 1);
static_assert(static_cast<int>(Zone::culled) == 3 && static_cast<int>(CulledBy::ignore) == 4);
static_assert(static_cast<int>(Lock::exclude) == 2 && static_cast<int>(Seams::corner) == 1);

struct TransferMemory {
  Workspace workspace;
  TransferResult result;
  Array<CagecastSegment> segments;
};

struct CutMemory {
  Workspace workspace;
  CutTarget cut;
};

void read(float& out, float value) { out = value; }
void read(bool& out, std::int32_t value) { out = value != 0; }
void read(Seams& out, std::int32_t value) { out = choiceOf<Seams>(value); }
void write(float& out, float value) { out = value; }
template <typename T>
void write(std::int32_t& out, T value) {
  out = static_cast<std::int32_t>(value);
}

TransferOptions optionsOf(const CagecastOptions* in, const MeshView& target) {
  if (in == nullptr) return {};
  TransferOptions out = in->paper != 0 ? TransferOptions::paper() : TransferOptions();
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) read(out.name, in->name);
#include "cagecast/options.def"
  out.parts = {listOf(in->ignore), listOf(in->keep), listOf(in->exclude)};
  out.locks = listOf(reinterpret_cast<const LockEntry*>(in->locks), in->lockCount);
  out.masks = {listOf(reinterpret_cast<const Mask*>(in->vertexMasks), target.positions.size() / 3),
               listOf(reinterpret_cast<const Mask*>(in->triangleMasks), target.indices.size() / 3)};
  return out;
}

const std::uint8_t* bytesOf(const Array<Zone>& zones) noexcept {
  return reinterpret_cast<const std::uint8_t*>(dataOf(zones));
}
std::uint32_t count(std::size_t size) noexcept { return static_cast<std::uint32_t>(size); }

/// The segments of a transfer for C.
Status listSegments(TransferMemory& memory) {
  const auto& stats = memory.result.projection.segmentStats;
  if (!memory.segments.reset(stats.size())) return {.code = Code::outOfMemory};
  for (std::size_t s = 0; s < stats.size(); ++s)
    memory.segments[s] = {.area = stats[s].area,
                          .exposedArea = stats[s].exposedArea,
                          .coveredArea = stats[s].coveredArea,
                          .score = stats[s].score(),
                          .confidence = stats[s].confidence(),
                          .points = stats[s].points,
                          .group = stats[s].group,
                          .culledBy = static_cast<std::uint8_t>(stats[s].culledBy)};
  return {};
}

void show(const TransferMemory& memory, CagecastTransfer& out) noexcept {
  const auto& [projection, zones] = memory.result;
  out.uvs = dataOf(projection.uvs);
  out.cornerUvs = dataOf(projection.cornerUvs);
  out.zones = bytesOf(zones.zones);
  out.cosmeticTriangles = dataOf(zones.cosmeticTriangles);
  out.cageTriangles = dataOf(projection.triangles);
  out.distances = dataOf(projection.distances);
  out.segments = dataOf(projection.segments);
  out.segmentStats = dataOf(memory.segments);
  out.vertexCount = count(zones.zones.size());
  out.triangleCount = count(zones.cosmeticTriangles.size());
  out.segmentCount = count(memory.segments.size());
}

void show(const CutTarget& cut, CagecastCut& out) noexcept {
  out.sources = dataOf(cut.sources);
  out.weights = dataOf(cut.weights);
  out.indices = dataOf(cut.indices);
  out.origins = dataOf(cut.origins);
  out.uvs = dataOf(cut.uvs);
  out.cornerUvs = dataOf(cut.cornerUvs);
  out.zones = bytesOf(cut.zones);
  out.cosmeticTriangles = dataOf(cut.cosmeticTriangles);
  out.vertexCount = count(cut.zones.size());
  out.newVertexCount = count(cut.sources.size() / 3);
  out.triangleCount = count(cut.origins.size());
}

}  // namespace

extern "C" {

void cagecastDefaults(CagecastOptions* options, std::int32_t paper) {
  const TransferOptions from = paper != 0 ? TransferOptions::paper() : TransferOptions();
  *options = {};
  options->paper = paper != 0;
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) write(options->name, from.name);
#include "cagecast/options.def"
}

std::int32_t cagecastTransfer(const CagecastMesh* cage, const CagecastMesh* target, const CagecastOptions* options,
                              CagecastTransfer* out) {
  const MeshView from = viewOf(cage), to = viewOf(target);
  return fill<TransferMemory>(
      out,
      [&](TransferMemory& memory, std::string& sentence) {
        Status status = cagecast::transfer(from, to, optionsOf(options, to), memory.workspace, memory.result);
        if (status.ok()) status = listSegments(memory);
        if (!status.ok()) memory.result = {};  // Of an earlier call.
        sentence = describe(status, from, to);
        return status;
      },
      [&](const TransferMemory& memory) { show(memory, *out); });
}

std::int32_t cagecastClassify(const CagecastMesh* target, const CagecastOptions* options, CagecastTransfer* transfer) {
  const MeshView to = viewOf(target);
  return fill<TransferMemory>(
      transfer,
      [&](TransferMemory& memory, std::string& sentence) {
        TransferResult& result = memory.result;
        Status status{Code::resultMismatch, Argument::target};  // What follows an error has nothing to decide.
        if (!result.projection.visibility.empty())
          status = classify(result.projection.view(), to.indices, optionsOf(options, to), result.zones);
        sentence = describe(status, {}, to);
        if (!status.ok()) return status;
        result.setVerdicts();
        return listSegments(memory);
      },
      [&](const TransferMemory& memory) { show(memory, *transfer); });
}

std::int32_t cagecastSplit(const CagecastMesh* mesh, const float* cornerUvs, CagecastSplit* out) {
  const MeshView of = viewOf(mesh);
  return fill<SplitVertices>(
      out,
      [&](SplitVertices& split, std::string& sentence) {
        const std::uint32_t vertices = mesh == nullptr ? 0 : mesh->vertexCount;
        const Status status = splitVertices(of.indices, listOf(cornerUvs, 2 * of.indices.size()), vertices, split);
        sentence = describe(status, {}, of);
        return status;
      },
      [&](const SplitVertices& split) {
        out->sources = dataOf(split.sources);
        out->indices = dataOf(split.indices);
        out->uvs = dataOf(split.uvs);
        out->vertexCount = count(split.sources.size());
        out->triangleCount = count(split.indices.size() / 3);
      });
}

std::int32_t cagecastCut(const CagecastMesh* cage, const CagecastMesh* target, const CagecastOptions* options,
                         const CagecastTransfer* transfer, CagecastCut* out) {
  const MeshView from = viewOf(cage), to = viewOf(target);
  return fill<CutMemory>(
      out,
      [&](CutMemory& memory, std::string& sentence) {
        DecidedTarget decided{.mesh = to, .zones = {}, .segments = {}, .culledBy = {}};
        if (transfer != nullptr && transfer->zones != nullptr) {
          const TransferResult& result = static_cast<TransferMemory*>(transfer->memory)->result;
          decided.zones = result.zones.zones;
          decided.segments = result.projection.segments;
          decided.culledBy = result.zones.culledBy;
        }
        const Status status = cutBorders(from, decided, optionsOf(options, to), memory.workspace, memory.cut);
        sentence = describe(status, from, to);
        return status;
      },
      [&](const CutMemory& memory) { show(memory.cut, *out); });
}

void cagecastFreeTransfer(CagecastTransfer* transfer) { release<TransferMemory>(transfer); }
void cagecastFreeSplit(CagecastSplit* split) { release<SplitVertices>(split); }
void cagecastFreeCut(CagecastCut* cut) { release<CutMemory>(cut); }

}  // extern "C"

}  // namespace cagecast::c
