// Makes, fits and refines cages for any model: a status with a sentence, or a cage that is consistent.

#include "cagecast/cages.hpp"

#include <cmath>

#include "fuzz/input.hpp"

using namespace cagecast;
using fuzz::require;

namespace {

/// @param given  What the call was given.
template <typename... Given>
void check(const Status& status, const cages::Cage& cage, const Given&... given) {
  if (!status.ok()) return require(!describe(status, given...).empty());
  const std::size_t vertices = cage.positions.size() / 3;
  require(cage.uvs.size() == 2 * vertices && cage.indices.size() % 3 == 0);
  for (const float x : cage.positions) require(std::isfinite(x));
  for (const float x : cage.uvs) require(std::isfinite(x));
  for (const std::uint32_t index : cage.indices) require(index < vertices);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Mesh mesh(input, false), other(input, true);
  const char* const names[] = {"head", "eye_l", "hair", "body/skin"};
  cages::Model model{mesh.view()};
  for (std::uint32_t i = input.below(5); i > 0; --i) model.parts.emplace_back(names[input.below(4)]);
  const cages::Position anywhere{input.coordinate(), input.coordinate(), input.coordinate()};
  if (input.flag()) model.joints = {{"Hips", {0, 0, 0}, -1}, {"Head", anywhere, 0}, {"LeftEye", anywhere, 1}};
  std::vector<std::uint16_t> holders(input.flag() ? mesh.view().positions.size() / 3 : 0);
  for (std::uint16_t& joint : holders) joint = static_cast<std::uint16_t>(input.below(4));
  model.vertexJoints = holders;
  const cages::Progress progress = [](float, const char*) { return true; };
  switch (input.below(3)) {
    case 0: {
      cages::MakeOptions options;
      options.kind = static_cast<cages::Kind>(input.below(4));
      options.voxels = 32;
      options.triangles = 50 + input.below(200);
      cages::Cage cage;
      check(makeCage(model, options, progress, cage), cage, model);
      break;
    }
    case 1: {
      cages::Template from{other.view(),
                           {{"nose_tip", anywhere},
                            {"chin", {0, 0, 0}},
                            {"crown", {0, 1, 0}},
                            {"eye_centre_left", {0.5f, 0.5f, 0}},
                            {"eye_centre_right", {-0.5f, 0.5f, 0}}}};
      cages::FittedCage cage;
      const Status status = fitCage(from, model, {}, progress, cage);
      check(status, cage, from, model, cages::FitOptions());
      break;
    }
    default: {
      cages::Cage cage;
      check(refineCage(other.view(), model, {}, progress, cage), cage, other.view(), model, cages::RefineOptions());
    }
  }
  return 0;
}
