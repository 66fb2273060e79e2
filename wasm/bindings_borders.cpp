/// The bridge from JavaScript to `cutBorders` alone, for a module of its own: see bindings.cpp.

#include <emscripten/bind.h>

#include <cagecast/borders.hpp>

#include "bridge.hpp"

namespace {

using namespace cagecast::bridge;

[[clang::no_destroy]] cagecast::CutTarget cut;

/// Of the inputs: options, cage, target; of a transfer to it zones, segments, and which of these are culled.
std::uintptr_t cutBorders() {
  const cagecast::DecidedView decided{input<cagecast::Zone>(9), input<std::uint32_t>(10), input<std::uint8_t>(11)};
  const cagecast::Status status = cagecast::cutBorders(mesh(1), mesh(5), givenOptions(), decided, cut);
  return answer(status, {bytes(cut.sources), bytes(cut.weights), bytes(cut.indices), bytes(cut.origins), bytes(cut.uvs), bytes(cut.cornerUvs),
                         bytes(cut.zones), bytes(cut.cosmeticTriangles)});
}

/// Frees what a call read and left.
void release() {
  renew(exchange);
  renew(cut);
}

}  // namespace

EMSCRIPTEN_BINDINGS(cagecast_borders) {
  emscripten::function("room", &room);
  emscripten::function("presetOptions", &presetOptions);
  emscripten::function("cutBorders", &cutBorders);
  emscripten::function("release", &release);
}
