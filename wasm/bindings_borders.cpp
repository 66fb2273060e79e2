/// The bridge from JavaScript to `cutBorders` alone, for a module of its own: see bindings.cpp.

#include <cagecast/clip.hpp>

#include "bridge.hpp"

namespace {

using namespace cagecast::bridge;

[[clang::no_destroy]] cagecast::CutTarget cut;
[[clang::no_destroy]] cagecast::Workspace workspace;

}  // namespace

extern "C" {

/// Of the inputs: options, cage, target; of a transfer to it zones, segments, and which of these are culled.
EMSCRIPTEN_KEEPALIVE std::uintptr_t cutBorders() {
  const cagecast::DecidedTarget target{mesh(5), input<cagecast::Zone>(9), input<std::uint32_t>(10),
                                       input<cagecast::CulledBy>(11)};
  const cagecast::Status status = cagecast::cutBorders(mesh(1), target, givenOptions(), workspace, cut);
  return answer(status, {bytes(cut.sources), bytes(cut.weights), bytes(cut.indices), bytes(cut.origins), bytes(cut.uvs),
                         bytes(cut.cornerUvs), bytes(cut.zones), bytes(cut.cosmeticTriangles)});
}

/// Frees what a call read and left.
EMSCRIPTEN_KEEPALIVE void release() {
  renew(exchange);
  renew(cut);
}

}  // extern "C"
