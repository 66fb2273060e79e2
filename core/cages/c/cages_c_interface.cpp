#include <utility>
#include <vector>

#include "c/c_interface.hpp"
#include "cagecast/cages.hpp"

namespace cagecast::cages::c {
namespace {

using cagecast::c::choiceOf, cagecast::c::dataOf, cagecast::c::fill, cagecast::c::listOf, cagecast::c::orEmpty,
    cagecast::c::viewOf;

static_assert(static_cast<int>(Kind::prop) == 3);

/// A cage, and what C sees of its names.
struct CageMemory {
  FittedCage cage;
  std::vector<CagecastLandmark> landmarks;
  std::vector<const char*> missing, guessed;
};

std::string textOf(const char* text) { return text == nullptr ? "" : text; }
Position positionOf(const float (&position)[3]) { return {position[0], position[1], position[2]}; }

std::vector<Landmark> landmarksOf(const CagecastLandmark* landmarks, std::uint32_t count) {
  std::vector<Landmark> out;
  for (const CagecastLandmark& one : listOf(landmarks, count))
    out.push_back({textOf(one.name), positionOf(one.position), one.confidence});
  return out;
}

Model modelOf(const CagecastModel& in) {
  const std::size_t vertices = in.mesh.vertexCount, triangles = in.mesh.triangleCount;
  Model out{.mesh = viewOf(&in.mesh),
            .marks = listOf(in.marks, triangles),
            .hints = landmarksOf(in.hints, in.hintCount),
            .vertexJoints = listOf(in.vertexJoints, vertices)};
  for (const char* name : listOf(in.parts, in.partCount)) out.parts.push_back(textOf(name));
  for (const CagecastJoint& joint : listOf(in.joints, in.jointCount))
    out.joints.push_back({textOf(joint.name), positionOf(joint.position), joint.parent});
  for (const CagecastBaseColor& color : listOf(in.baseColors, in.baseColorCount)) {
    const std::size_t bytes = std::size_t{4} * color.width * color.height;
    out.baseColors.push_back({.factor = positionOf(color.factor),
                              .image = {color.width, color.height, listOf(color.pixels, bytes)},
                              .isKnown = color.isKnown != 0});
  }
  return out;
}

Parts partsOf(const CagecastCageOptions& options) {
  return {.ignore = {}, .keep = listOf(options.keep), .exclude = listOf(options.exclude)};
}

Progress progressOf(const CagecastCageOptions& options) {
  if (options.progress == nullptr) return nullptr;
  return [options](float share, const char* stage) { return options.progress(share, stage, options.user) != 0; };
}

std::vector<const char*> namesOf(const std::vector<std::string>& names) {
  std::vector<const char*> out;
  out.reserve(names.size());
  for (const std::string& name : names) out.push_back(name.c_str());
  return out;
}

/// Keeps a cage, with what C sees of it.
void keep(FittedCage cage, CageMemory& memory) {
  memory.cage = std::move(cage);
  memory.landmarks.clear();
  for (const auto& [name, position, confidence] : memory.cage.landmarks)
    memory.landmarks.push_back({name.c_str(), {position[0], position[1], position[2]}, confidence});
  memory.missing = namesOf(memory.cage.missing);
  memory.guessed = namesOf(memory.cage.guessed);
}

CagecastList cListOf(const std::vector<std::uint32_t>& list) {
  return {dataOf(list), static_cast<std::uint32_t>(list.size())};
}

void show(const CageMemory& memory, CagecastCage& out) {
  const FittedCage& cage = memory.cage;
  out.mesh.positions = cage.positions.data();
  out.mesh.uvs = cage.uvs.data();
  out.mesh.indices = cage.indices.data();
  out.mesh.vertexCount = static_cast<std::uint32_t>(cage.positions.size() / 3);
  out.mesh.triangleCount = static_cast<std::uint32_t>(cage.indices.size() / 3);
  out.landmarks = dataOf(memory.landmarks);
  out.landmarkCount = static_cast<std::uint32_t>(memory.landmarks.size());
  out.missing = dataOf(memory.missing);
  out.missingCount = static_cast<std::uint32_t>(memory.missing.size());
  out.guessed = dataOf(memory.guessed);
  out.guessedCount = static_cast<std::uint32_t>(memory.guessed.size());
  out.bare = cListOf(cage.bare);
  out.closed = cListOf(cage.closed);
  out.kind = static_cast<std::int32_t>(cage.kind);
}

}  // namespace

extern "C" {

std::int32_t cagecastMakeCage(const CagecastModel* model, const CagecastCageOptions* options, CagecastCage* out) {
  const CagecastCageOptions given = orEmpty(options);
  return fill<CageMemory>(
      out,
      [&](CageMemory& memory, std::string& sentence) {
        const Model of = modelOf(orEmpty(model));
        const MakeOptions made{
            choiceOf<Kind>(given.kind), partsOf(given), given.triangles, given.closing, given.offset, given.voxels};
        FittedCage cage;
        const Status status = makeCage(of, made, progressOf(given), cage);
        if (status.ok())
          keep(std::move(cage), memory);
        else
          sentence = describe(status, of);
        return status;
      },
      [&](const CageMemory& memory) { show(memory, *out); });
}

std::int32_t cagecastFitCage(const CagecastCage* from, const CagecastModel* model, const CagecastCageOptions* options,
                             CagecastCage* out) {
  const CagecastCageOptions given = orEmpty(options);
  const CagecastCage source = orEmpty(from);  // Which may be `out`.
  return fill<CageMemory>(
      out,
      [&](CageMemory& memory, std::string& sentence) {
        const Template cage{viewOf(&source.mesh), landmarksOf(source.landmarks, source.landmarkCount),
                            choiceOf<Kind>(source.kind)};
        const Model of = modelOf(orEmpty(model));
        const FitOptions fit{partsOf(given), landmarksOf(given.landmarks, given.landmarkCount)};
        FittedCage fitted;
        const Status status = fitCage(cage, of, fit, progressOf(given), fitted);
        if (status.ok())
          keep(std::move(fitted), memory);
        else
          sentence = describe(status, cage, of, fit);
        return status;
      },
      [&](const CageMemory& memory) { show(memory, *out); });
}

void cagecastFreeCage(CagecastCage* cage) { cagecast::c::release<CageMemory>(cage); }

}  // extern "C"

}  // namespace cagecast::cages::c
