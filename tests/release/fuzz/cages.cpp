// Makes, fits and refines cages for any model: a status with a sentence, or a cage that is consistent. Grids are coarse
// and cages small, so that an input takes milliseconds. Steps by themselves are in cage_steps.cpp, landmarks in
// landmarks.cpp.

#include "cagecast/cages.hpp"

#include <cmath>

#include "fuzz/figure.hpp"

using namespace cagecast;
using fuzz::require;

namespace {

void check(const cages::Cage& cage) {
  const std::size_t vertices = cage.positions.size() / 3;
  require(cage.uvs.size() == 2 * vertices && cage.indices.size() % 3 == 0);
  for (const float x : cage.positions) require(std::isfinite(x));
  for (const float x : cage.uvs) require(std::isfinite(x));
  for (const std::uint32_t index : cage.indices) require(index < vertices);
}

void make(fuzz::Input& input, const fuzz::Figure& figure, fuzz::Patience& patience) {
  cages::MakeOptions options;
  options.kind = static_cast<cages::Kind>(input.below(4));
  const std::uint32_t size = input.below(16);
  options.voxels = size == 15 ? 32 : 16 + size / 4;
  options.triangles = 50 + input.below(200);
  cages::Cage cage;
  const Status status = makeCage(figure.model, options, patience.progress(), cage);
  if (fuzz::isDone(status, patience, figure.model)) check(cage);
}

void fit(fuzz::Input& input, const fuzz::Mesh& other, const fuzz::Figure& figure, fuzz::Patience& patience) {
  const cages::Template from{other.view(),
                             {{"nose_tip", figure.anywhere},
                              {"chin", {0, 0, 0}},
                              {"crown", {0, 1, 0}},
                              {"eye_centre_left", {0.5f, 0.5f, 0}},
                              {"eye_centre_right", {-0.5f, 0.5f, 0}},
                              {"eye_inner_left", {0.4f, 0.5f, 0.1f}},
                              {"eye_outer_left", {0.6f, 0.5f, 0.1f}},
                              {"eye_inner_right", {-0.4f, 0.5f, 0.1f}},
                              {"eye_outer_right", {-0.6f, 0.5f, 0.1f}}}};
  cages::FitOptions options;
  if (input.flag()) options.landmarks = from.landmarks;  // Else they are found, or guessed.
  cages::FittedCage cage;
  const Status status = fitCage(from, figure.model, options, patience.progress(), cage);
  if (!fuzz::isDone(status, patience, from, figure.model, options)) return;
  check(cage);
  fuzz::check(cage.landmarks);
}

void refine(const fuzz::Mesh& other, const fuzz::Figure& figure, fuzz::Patience& patience) {
  cages::Cage cage;
  const Status status = refineCage(other.view(), figure.model, {}, patience.progress(), cage);
  if (fuzz::isDone(status, patience, other.view(), figure.model, cages::RefineOptions())) check(cage);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t call = input.below(3);
  fuzz::Patience patience(input);
  const fuzz::Figure figure(input);
  if (call == 0) make(input, figure, patience);
  if (call == 1) fit(input, fuzz::Mesh(input, true), figure, patience);
  // A cage that may be in place: the model's own triangles.
  if (call == 2) refine(input.flag() ? fuzz::Mesh(input, true) : figure.mesh, figure, patience);
  return 0;
}
