/// What the bridges from JavaScript share (bindings.cpp, bindings_borders.cpp): JavaScript writes its arrays where
/// `room` says, and copies those of an answer from where its table says (wasm/src/bindings.ts).
///
/// Functions that JavaScript calls take and return numbers only, so they are exported as they are.
#pragma once

#include <emscripten/emscripten.h>

#include <array>
#include <memory>
#include <span>
#include <type_traits>

#include <cagecast/transfer.hpp>

namespace cagecast {

// Structures go to and from JavaScript as numbers, field by field in these orders; so names stay out of here.

/// In the order of wasm/src/options.ts.
template <typename Visit>
constexpr void eachField(TransferOptions& o, const Visit& visit) {
  visit(o.steps.projection), visit(o.weldTolerance), visit(o.seams), visit(o.occlusionReach), visit(o.pokeThrough);
  visit(o.steps.interiorSamples), visit(o.steps.farLoops), visit(o.steps.depthWeighting), visit(o.steps.secondLook),
      visit(o.steps.bothSides), visit(o.steps.exposedSide), visit(o.steps.holes);
  visit(o.threshold), visit(o.steps.floor), visit(o.minCovered), visit(o.steps.minOfAll), visit(o.steps.maxUncovered),
      visit(o.steps.twins), visit(o.steps.holeContents), visit(o.steps.partialTriangles);
}

}  // namespace cagecast

namespace cagecast::bridge {

using Bytes = std::span<const std::byte>;

/// Most arrays of an answer.
constexpr std::size_t kMostArrays = 11;

/// What goes in and out of a exchange.
struct Exchange {
  Array<std::byte> inputs[12];
  /// Code, argument and place of the status; then for each array of the answer its address and its size in bytes.
  std::uintptr_t answer[3 + 2 * kMostArrays];
};

[[clang::no_destroy]] inline Exchange exchange;

/// Frees what a thing holds.
template <typename Thing>
void renew(Thing& thing) {
  std::destroy_at(&thing);
  std::construct_at(&thing);
}

/// Makes room for an array from JavaScript, in bytes.
/// @return Where it belongs; 0 if there is not enough memory.
extern "C" EMSCRIPTEN_KEEPALIVE inline std::uintptr_t room(std::size_t place, std::size_t bytes) {
  Array<std::byte>& input = exchange.inputs[place];
  return input.reset(bytes) ? reinterpret_cast<std::uintptr_t>(input.data()) : 0;
}

template <typename T>
std::span<const T> input(std::size_t place) {
  return {reinterpret_cast<const T*>(exchange.inputs[place].data()), exchange.inputs[place].size() / sizeof(T)};
}

/// A mesh in four places: positions, indices, UVs, groups.
inline MeshView mesh(std::size_t place) {
  return {input<float>(place), input<std::uint32_t>(place + 1), input<float>(place + 2),
          input<std::uint32_t>(place + 3)};
}

/// @return Where `answer` is.
inline std::uintptr_t answer(const Status& status, std::span<const Bytes> arrays = {}) {
  std::uintptr_t* next = exchange.answer;
  *next++ = static_cast<std::uintptr_t>(status.code);
  *next++ = static_cast<std::uintptr_t>(status.argument);
  *next++ = status.at;
  for (const Bytes array : arrays) {
    *next++ = reinterpret_cast<std::uintptr_t>(array.data());
    *next++ = array.size();
  }
  return reinterpret_cast<std::uintptr_t>(exchange.answer);
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

template <typename Thing>
constexpr std::size_t fieldsOf() {
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

constexpr Status kOutOfMemory{Code::outOfMemory};

/// Of the first input.
[[gnu::noinline]] inline TransferOptions givenOptions() {
  TransferOptions options;
  fromNumbers(input<double>(0).data(), std::span(&options, 1));
  return options;
}

using OptionNumbers = std::array<double, fieldsOf<TransferOptions>()>;

constexpr OptionNumbers numbersOf(TransferOptions options) {
  OptionNumbers numbers{};
  std::size_t next = 0;
  eachField(options, [&](const auto& field) { numbers[next++] = static_cast<double>(field); });
  return numbers;
}

/// In numbers already: the code to make them of fields is longer than they are.
constexpr OptionNumbers kPresets[] = {numbersOf(TransferOptions::paper()), numbersOf(TransferOptions{})};

/// The options of a preset: 0 `paper`, 1 `default`.
extern "C" EMSCRIPTEN_KEEPALIVE inline std::uintptr_t presetOptions(unsigned preset) {
  return answer({}, {std::as_bytes(std::span(kPresets[preset]))});
}

}  // namespace cagecast::bridge
