/// The JavaScript interface of the library that makes and fits cages, made with embind: copies arguments in, calls a
/// function, and copies what it returns out. Nothing is decided here.

#include <emscripten/bind.h>
#include <emscripten/val.h>
#include <cagecast/cages.hpp>

#include <string>
#include <vector>

#include "arrays.hpp"

namespace {

using namespace cagecast;
using namespace cagecast::bindings;
using namespace cagecast::cages;

/// A typed array of its own.
template <typename T>
val copied(const std::vector<T>& values) {
  return val(emscripten::typed_memory_view(values.size(), values.data())).template call<val>("slice");
}

template <typename T>
std::vector<T> listOf(const val& source) {
  std::vector<T> out(source["length"].as<std::size_t>());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = source[i].as<T>();
  return out;
}

/// @param given  What a call was given, for `describe`.
template <typename... Given>
val endingOf(const Status& status, const Given&... given) {
  return ending(status, describe(status, given...));
}

/// The images of base colours, copied from JavaScript.
struct Images {
  std::vector<cagecast::Array<std::uint8_t>> pixels;

  bool copy(const val& source) {
    pixels.resize(source["length"].as<std::size_t>());
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if (!copyArray(source[i]["data"], pixels[i])) return false;
    return true;
  }
  /// @param colors  Each with the number of its image; -1 for none.
  [[nodiscard]] std::vector<BaseColor> colorsOf(const val& colors, const val& images) const {
    std::vector<BaseColor> out(colors["length"].as<std::size_t>());
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c].factor = colors[c]["factor"].as<Position>();
      out[c].isKnown = colors[c]["isKnown"].as<bool>();
      const auto image = colors[c]["image"].as<int>();
      if (image < 0) continue;
      const val size = images[image];
      out[c].image = {size["width"].as<std::uint32_t>(), size["height"].as<std::uint32_t>(),
                      pixels[static_cast<std::size_t>(image)]};
    }
    return out;
  }
};

/// A model, copied from JavaScript.
struct ModelArrays {
  Mesh mesh;
  Images images;
  cagecast::Array<std::uint8_t> marks;
  cagecast::Array<std::uint16_t> vertexJoints;
  Model model;

  bool copy(const val& source) {
    if (!mesh.copy(source["mesh"]) || !copyArray(source["marks"], marks) ||
        !copyArray(source["vertexJoints"], vertexJoints) || !images.copy(source["images"]))
      return false;
    model = {mesh.view(),
             listOf<std::string>(source["parts"]),
             listOf<Joint>(source["joints"]),
             marks,
             listOf<Landmark>(source["hints"]),
             vertexJoints,
             images.colorsOf(source["baseColors"], source["images"])};
    return true;
  }
};

Progress progressTo(const val& report) {
  return [&report](float share, const char* stage) { return report(share, std::string(stage)).as<bool>(); };
}

void setCage(val& out, const Cage& cage) {
  out.set("positions", copied(cage.positions));
  out.set("uvs", copied(cage.uvs));
  out.set("indices", copied(cage.indices));
  out.set("landmarks", listed(cage.landmarks));
  out.set("kind", cage.kind);
}

val makeCageCall(const val& target, MakeOptions options, const val& parts, const val& report) {
  ModelArrays arrays;
  PartArrays lists;
  if (!arrays.copy(target) || !lists.copy(parts)) return endingOf(kOutOfMemory, arrays.model);
  options.parts = lists.view();
  Cage cage;
  const Status status = makeCage(arrays.model, options, progressTo(report), cage);
  val out = endingOf(status, arrays.model);
  if (status.ok()) setCage(out, cage);
  return out;
}

val fitCageCall(const val& from, const val& target, const val& landmarks, const val& parts, const val& report) {
  ModelArrays arrays;
  PartArrays lists;
  Mesh mesh;
  if (!arrays.copy(target) || !lists.copy(parts) || !mesh.copy(from["mesh"]))
    return endingOf(kOutOfMemory, arrays.model);
  const Template source{mesh.view(), listOf<Landmark>(from["landmarks"]), from["kind"].as<Kind>()};
  const FitOptions options{lists.view(), listOf<Landmark>(landmarks)};
  FittedCage cage;
  const Status status = fitCage(source, arrays.model, options, progressTo(report), cage);
  val out = endingOf(status, source, arrays.model, options);
  if (!status.ok()) return out;
  setCage(out, cage);
  out.set("missing", listed(cage.missing));
  out.set("guessed", listed(cage.guessed));
  out.set("bare", listed(cage.bare));
  out.set("closed", listed(cage.closed));
  return out;
}

val findLandmarksCall(const val& target, const val& report) {
  ModelArrays arrays;
  if (!arrays.copy(target)) return endingOf(kOutOfMemory, arrays.model);
  FoundLandmarks found;
  const Status status = findLandmarks(arrays.model, progressTo(report), found);
  val out = endingOf(status, arrays.model);
  if (!status.ok()) return out;
  out.set("landmarks", listed(found.landmarks));
  out.set("missing", listed(found.missing));
  out.set("rig", found.rig);
  out.set("kind", found.kind);
  return out;
}

val refineCageCall(const val& cage, const val& target, const RefineOptions& options, const val& report) {
  ModelArrays arrays;
  Mesh mesh;
  if (!arrays.copy(target) || !mesh.copy(cage)) return endingOf(kOutOfMemory, arrays.model);
  Cage refined;
  const Status status = refineCage(mesh.view(), arrays.model, options, progressTo(report), refined);
  val out = endingOf(status, mesh.view(), arrays.model, options);
  if (status.ok()) setCage(out, refined);
  return out;
}

val excludedByNameCall(const val& parts) {
  val out = val::array();
  const std::vector<bool> isExcluded = excludedByName(listOf<std::string>(parts));
  for (std::size_t p = 0; p < isExcluded.size(); ++p) out.set(p, static_cast<bool>(isExcluded[p]));
  return out;
}

MakeOptions makeOptions() { return {}; }
RefineOptions refineOptions() { return {}; }

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast_cages) {
  using namespace emscripten;

  enum_<Kind>("Kind")
      .value("automatic", Kind::automatic)
      .value("head", Kind::head)
      .value("body", Kind::body)
      .value("prop", Kind::prop);
  value_array<Position>("Position")
      .element(emscripten::index<0>())
      .element(emscripten::index<1>())
      .element(emscripten::index<2>());
  value_object<Landmark>("Landmark")
      .field("name", &Landmark::name)
      .field("position", &Landmark::position)
      .field("confidence", &Landmark::confidence);
  value_object<Joint>("Joint")
      .field("name", &Joint::name)
      .field("position", &Joint::position)
      .field("parent", &Joint::parent);
  value_object<MakeOptions>("MakeOptions")
      .field("kind", &MakeOptions::kind)
      .field("triangles", &MakeOptions::triangles)
      .field("closing", &MakeOptions::closing)
      .field("offset", &MakeOptions::offset)
      .field("voxels", &MakeOptions::voxels);
  value_object<RefineOptions>("RefineOptions").field("reach", &RefineOptions::reach);

  function("makeOptions", &makeOptions);
  function("refineOptions", &refineOptions);
  function("makeCage", &makeCageCall);
  function("fitCage", &fitCageCall);
  function("findLandmarks", &findLandmarksCall);
  function("refineCage", &refineCageCall);
  function("excludedByName", &excludedByNameCall);
}
