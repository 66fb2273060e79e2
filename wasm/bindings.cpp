/// The JavaScript interface of the core, made with embind: copies arrays in, calls a function, and returns views of
/// what it left in memory. Nothing is decided here.

#include <emscripten/bind.h>
#include <emscripten/val.h>
#include <cagecast/clip.hpp>
#include <cagecast/split.hpp>
#include <cagecast/transfer.hpp>

#include <string>

#include "arrays.hpp"

namespace {

using namespace cagecast;
using namespace cagecast::bindings;

struct Meshes {
  Mesh cage;
  Mesh target;

  bool copy(const val& cageSource, const val& targetSource) {
    return cage.copy(cageSource) && target.copy(targetSource);
  }
};

/// Options with the caller's parts, locks and masks, copied from JavaScript.
struct Overrides {
  PartArrays parts;
  Array<LockEntry> locks;
  Array<Mask> vertexMasks, triangleMasks;

  bool copy(const val& source) {
    const val masks = source["masks"];
    return parts.copy(source["parts"]) && copyRecords(source["locks"], locks) &&
           copyArray(masks["vertices"], vertexMasks) && copyArray(masks["triangles"], triangleMasks);
  }
  [[nodiscard]] TransferOptions over(TransferOptions options) const {
    options.parts = parts.view();
    options.locks = locks;
    options.masks = {vertexMasks, triangleMasks};
    return options;
  }
};

enum class Preset : std::uint8_t { standard, paper };

TransferOptions presetOptions(Preset preset) {
  return preset == Preset::paper ? TransferOptions::paper() : TransferOptions{};
}

val endingOf(const Status& status, const Meshes& meshes = {}) {
  return ending(status, status.ok() ? "" : describe(status, meshes.cage.view(), meshes.target.view()));
}

/// The memory that calls work in and leave their results in. The arrays that a call returns are views of it, valid
/// until `release` or the next call.
class Calls {
 public:
  val project(const val& cage, const val& target, const TransferOptions& options, const val& given) {
    Meshes meshes;
    Overrides overrides;
    if (!meshes.copy(cage, target) || !overrides.copy(given)) return endingOf(kOutOfMemory);
    Projection& projection = result_.projection;
    const Status status =
        cagecast::project(meshes.cage.view(), meshes.target.view(), overrides.over(options), workspace_, projection);
    if (!status.ok()) return endingOf(status, meshes);
    indices_ = std::move(meshes.target.indices);
    val out = projected();
    out.set("visibility", view(projection.visibility));
    out.set("segmentStats", listed(projection.segmentStats));
    out.set("recovery", view(projection.recovery));
    out.set("hiddenBy", view(projection.hiddenBy));
    out.set("hiders", view(projection.hiders));
    out.set("holeShares", listed(projection.holeShares));
    out.set("indices", view(indices_));
    return out;
  }

  val transfer(const val& cage, const val& target, const TransferOptions& options, const val& given) {
    Meshes meshes;
    Overrides overrides;
    if (!meshes.copy(cage, target) || !overrides.copy(given)) return endingOf(kOutOfMemory);
    const Status status =
        cagecast::transfer(meshes.cage.view(), meshes.target.view(), overrides.over(options), workspace_, result_);
    if (!status.ok()) return endingOf(status, meshes);
    val out = projected();
    out.set("segmentStats", listed(result_.projection.segmentStats));
    decided(out);
    return out;
  }

  val classify(const val& source, const TransferOptions& options, const val& given) {
    Projection& projection = result_.projection;
    Overrides overrides;
    if (!overrides.copy(given) || !copyArray(source["visibility"], projection.visibility) ||
        !copyArray(source["segments"], projection.segments) || !copyArray(source["recovery"], projection.recovery) ||
        !copyArray(source["hiddenBy"], projection.hiddenBy) || !copyArray(source["hiders"], projection.hiders) ||
        !copyArray(source["indices"], indices_) || !copyRecords(source["segmentStats"], projection.segmentStats) ||
        !copyRecords(source["holeShares"], projection.holeShares)) {
      return endingOf(kOutOfMemory);
    }
    const Status status = cagecast::classify(projection.view(), indices_, overrides.over(options), result_.zones);
    if (!status.ok()) return endingOf(status);
    result_.setVerdicts();
    val out = endingOf(status);
    out.set("segmentStats", listed(projection.segmentStats));
    decided(out);
    return out;
  }

  val splitVertices(const val& target, const val& cornerUvs) {
    Meshes meshes;
    Array<float> uvs;
    if (!meshes.target.copy(target) || !copyArray(cornerUvs, uvs)) return endingOf(kOutOfMemory);
    const auto vertexCount = static_cast<std::uint32_t>(meshes.target.positions.size() / 3);
    const Status status = cagecast::splitVertices(meshes.target.indices, uvs, vertexCount, split_);
    if (!status.ok()) return endingOf(status, meshes);
    val out = endingOf(status);
    out.set("sources", view(split_.sources));
    out.set("indices", view(split_.indices));
    out.set("uvs", view(split_.uvs));
    return out;
  }

  /// @param decision  Of a transfer: its `zones`, its `segments`, and `culledBy` of each segment.
  val cutBorders(const val& cage, const val& target, const val& decision, const TransferOptions& options,
                 const val& given) {
    Meshes meshes;
    Overrides overrides;
    Array<Zone> zones;
    Array<std::uint32_t> segments;
    Array<CulledBy> culledBy;
    if (!meshes.copy(cage, target) || !overrides.copy(given) || !copyArray(decision["zones"], zones) ||
        !copyArray(decision["segments"], segments) || !copyRecords(decision["culledBy"], culledBy)) {
      return endingOf(kOutOfMemory);
    }
    const Status status = cagecast::cutBorders(meshes.cage.view(), {meshes.target.view(), zones, segments, culledBy},
                                               overrides.over(options), workspace_, cut_);
    if (!status.ok()) return endingOf(status, meshes);
    val out = endingOf(status);
    out.set("sources", view(cut_.sources));
    out.set("weights", view(cut_.weights));
    out.set("indices", view(cut_.indices));
    out.set("triangles", view(cut_.origins));
    out.set("uvs", view(cut_.uvs));
    out.set("cornerUvs", view(cut_.cornerUvs));
    out.set("zones", view(cut_.zones));
    out.set("cosmeticTriangles", view(cut_.cosmeticTriangles));
    return out;
  }

  /// Frees the result of the last call and the working memory.
  void release() {
    result_ = {};
    split_ = {};
    cut_ = {};
    indices_ = {};
    workspace_.release();
  }

 private:
  /// What `project` and `transfer` both return.
  val projected() {
    const Projection& projection = result_.projection;
    val out = endingOf({});
    out.set("uvs", view(projection.uvs));
    out.set("cornerUvs", view(projection.cornerUvs));
    out.set("triangles", view(projection.triangles));
    out.set("distances", view(projection.distances));
    out.set("segments", view(projection.segments));
    out.set("timings", projection.timings);
    out.set("peakBytes", static_cast<double>(projection.peakBytes));
    return out;
  }

  /// What `classify` and `transfer` both return.
  void decided(val& out) {
    out.set("zones", view(result_.zones.zones));
    out.set("cosmeticTriangles", view(result_.zones.cosmeticTriangles));
  }

  Workspace workspace_;
  TransferResult result_;
  SplitVertices split_;
  CutTarget cut_;
  Array<std::uint32_t> indices_;
};

// Fields that follow from others are for reading only.
double coverageOf(const SegmentStats& stats) { return stats.coverage(); }
double scoreOf(const SegmentStats& stats) { return stats.score(); }
double confidenceOf(const SegmentStats& stats) { return stats.confidence(); }
bool isCulled(const SegmentStats& stats) { return stats.culled(); }
template <typename T>
void ignore(SegmentStats& /*stats*/, T /*value*/) {}

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast) {
  using namespace emscripten;

  enum_<Preset>("Preset").value("default", Preset::standard).value("paper", Preset::paper);
  enum_<ProjectionMode>("ProjectionMode")
      .value("nearestPoint", ProjectionMode::nearestPoint)
      .value("nearestVertex", ProjectionMode::nearestVertex);
  enum_<Seams>("Seams").value("vertex", Seams::vertex).value("corner", Seams::corner);
  enum_<Lock>("Lock").value("auto", Lock::automatic).value("keep", Lock::keep).value("exclude", Lock::exclude);
  enum_<CulledBy>("CulledBy")
      .value("none", CulledBy::none)
      .value("coverage", CulledBy::coverage)
      .value("hole", CulledBy::hole)
      .value("lock", CulledBy::lock)
      .value("ignore", CulledBy::ignore);

  {
    value_object<Steps> steps("Steps");
#define CAGECAST_STEP(stage, name, ...) steps.field(#name, &Steps::name);
#include <cagecast/options.def>
    value_object<TransferOptions> options("TransferOptions");
#define CAGECAST_OPTION(stage, name, ...) options.field(#name, &TransferOptions::name);
#include <cagecast/options.def>
    options.field("steps", &TransferOptions::steps);
  }

  value_object<LockEntry>("LockEntry").field("segment", &LockEntry::segment).field("lock", &LockEntry::lock);
  value_object<Ratios>("Ratios")
      .field("threshold", &Ratios::threshold)
      .field("floor", &Ratios::floor)
      .field("depth", &Ratios::depth)
      .field("hole", &Ratios::hole);
  value_object<SegmentStats>("SegmentStats")
      .field("points", &SegmentStats::points)
      .field("area", &SegmentStats::area)
      .field("beyondArea", &SegmentStats::beyondArea)
      .field("exposedArea", &SegmentStats::exposedArea)
      .field("coveredArea", &SegmentStats::coveredArea)
      .field("coverage", &coverageOf, &ignore<double>)
      .field("depth", &SegmentStats::depth)
      .field("group", &SegmentStats::group)
      .field("ratios", &SegmentStats::ratios)
      .field("score", &scoreOf, &ignore<double>)
      .field("confidence", &confidenceOf, &ignore<double>)
      .field("culled", &isCulled, &ignore<bool>)
      .field("culledBy", &SegmentStats::culledBy);
  value_object<HoleShare>("HoleShare")
      .field("hole", &HoleShare::hole)
      .field("segment", &HoleShare::segment)
      .field("exposedArea", &HoleShare::exposedArea)
      .field("uncoveredArea", &HoleShare::uncoveredArea)
      .field("hiddenArea", &HoleShare::hiddenArea);
  value_object<Timings>("Timings")
      .field("weld", &Timings::weld)
      .field("build", &Timings::build)
      .field("project", &Timings::project)
      .field("occluded", &Timings::occluded)
      .field("covered", &Timings::covered)
      .field("segments", &Timings::segments)
      .field("recheck", &Timings::recheck)
      .field("motion", &Timings::motion)
      .field("holes", &Timings::holes)
      .field("seams", &Timings::seams)
      .field("classify", &Timings::classify)
      .field("total", &Timings::total);

  class_<Calls>("Workspace")
      .constructor<>()
      .function("project", &Calls::project)
      .function("transfer", &Calls::transfer)
      .function("classify", &Calls::classify)
      .function("splitVertices", &Calls::splitVertices)
      .function("cutBorders", &Calls::cutBorders)
      .function("release", &Calls::release);
  function("presetOptions", &presetOptions);
  constant("throughHole", Recovery::throughHole);
  constant("maxTriangles", kMaxTriangles);
}
