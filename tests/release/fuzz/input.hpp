#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <span>
#include <vector>

#include "cagecast/transfer.hpp"

/// Makes meshes and options of a fuzzer's bytes, so that small changes of them are small changes of a scene. Bytes that
/// are missing count as 0.
namespace cagecast::fuzz {

/// Ends the program if a promise does not hold; a fuzzer reports that with the input that led to it.
inline void require(bool holds) {
  if (!holds) __builtin_trap();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t first = rest_.front();
    rest_ = rest_.subspan(1);
    return first;
  }
  bool flag() { return (byte() & 1) != 0; }
  /// A whole number in 0..limit-1, for limits up to 65536.
  std::uint32_t below(std::uint32_t limit) {
    std::uint32_t value = byte();
    if (limit > 256) value = value << 8 | byte();
    return value % limit;
  }
  /// A number in 0..1, in steps of 1/255.
  float share() { return static_cast<float>(byte()) / 255; }

  /// A coordinate: mostly on a grid of 1/16, where coincidences are frequent, else a little off it, or any float.
  float coordinate() {
    const std::uint8_t kind = byte();
    const float onGrid = static_cast<float>(static_cast<std::int8_t>(byte())) / 16;
    if (kind < 200) return onGrid;
    if (kind < 250) return onGrid + static_cast<float>(kind - 225) * 1e-6f;
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
    float any;
    std::memcpy(&any, &bits, sizeof any);
    return any;
  }

  TransferOptions options() {
    TransferOptions out = flag() ? TransferOptions{} : TransferOptions::paper();
    out.threshold = share();
    out.seams = flag() ? Seams::corner : Seams::vertex;
    if (flag()) out.weldTolerance = share() / 100;
    if (flag()) out.minCovered = share();
    if (flag()) out.steps.floor = below(2) != 0;
    const std::uint8_t off = byte();
    if ((off & 1) != 0) out.steps.interiorSamples = false;
    if ((off & 4) != 0) out.steps.recheck = false;
    if ((off & 8) != 0) out.steps.holes = false;
    return out;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// A mesh and its arrays.
struct Mesh {
  std::vector<float> positions, uvs, poses;
  std::vector<std::uint32_t> indices, groups;

  /// Up to 40 vertices and 60 triangles.
  explicit Mesh(Input& input, bool hasUvs) {
    const std::uint32_t vertices = input.below(41), triangles = input.below(61);
    for (std::uint32_t i = 0; i < 3 * vertices; ++i) positions.push_back(input.coordinate());
    // One more than there are, now and then.
    const std::uint32_t range = vertices + (input.byte() == 255 ? 1u : 0u);
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) indices.push_back(range == 0 ? 0 : input.below(range));
    for (std::uint32_t i = 0; i < 2 * vertices && hasUvs; ++i) uvs.push_back(input.share());
    if (input.flag())
      for (std::uint32_t i = 0; i < vertices; ++i) groups.push_back(input.below(3));
  }
  /// A ball of rings and sectors, some of whose triangles are missing. Those at its poles are needles: the sine of π as
  /// a float is not 0.
  static Mesh ball(Input& input, bool hasUvs) {
    const std::uint32_t rings = 2 + input.below(4), sectors = 3 + input.below(6), row = sectors + 1;
    const float radius = 1 + input.share();
    Mesh out;
    for (std::uint32_t i = 0; i <= rings; ++i)
      for (std::uint32_t j = 0; j <= sectors; ++j) {
        const double u = static_cast<double>(j) / sectors, v = static_cast<double>(i) / rings;
        const double polar = std::numbers::pi * v, around = 2 * std::numbers::pi * u;
        for (const double at :
             {std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)})
          out.positions.push_back(radius * static_cast<float>(at));
        if (hasUvs) out.uvs.insert(out.uvs.end(), {static_cast<float>(u), static_cast<float>(v)});
      }
    for (std::uint32_t i = 0; i < rings; ++i)
      for (std::uint32_t j = 0; j < sectors; ++j) {
        const std::uint32_t missing = input.below(4), at = i * row + j;
        if ((missing & 1) == 0) out.indices.insert(out.indices.end(), {at, at + 1, at + row});
        if ((missing & 2) == 0) out.indices.insert(out.indices.end(), {at + 1, at + row + 1, at + row});
      }
    return out;
  }
  /// Adds a pose, in which some vertices are elsewhere.
  void move(Input& input) {
    for (const float x : positions) poses.push_back(input.below(4) == 0 ? input.coordinate() : x);
  }
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups, poses}; }

 private:
  Mesh() = default;
};

/// A cage, a target and options. Either mesh may be a ball instead.
struct Scene {
  Mesh cage, target;
  TransferOptions options;

  explicit Scene(Input& input) : cage(input, true), target(input, false), options(input.options()) {
    const std::uint8_t balls = input.byte();
    if ((balls & 1) != 0) cage = Mesh::ball(input, true);
    if ((balls & 2) != 0) target = Mesh::ball(input, false);
    if ((balls & 4) != 0) target.move(input);
  }
};

}  // namespace cagecast::fuzz
