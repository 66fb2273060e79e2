#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <numbers>
#include <span>
#include <utility>
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

  /// Sets an option to a value of its range, from the least to the greatest, if a byte says so.
  /// @param mostly  It is at most this, or the greatest.
  void vary(float& option, float mostly, std::initializer_list<float> range) {
    if (!flag()) return;
    const float low = range.begin()[0], high = range.begin()[1], part = share();
    option = part == 1 ? high : low + part * (std::min(high, mostly) - low);
  }
  /// Sets an option to one of its values, if a byte says so.
  template <typename Option>
  void vary(Option& option, float, std::initializer_list<Option> values) {
    if (flag()) option = values.begin()[below(static_cast<std::uint32_t>(values.size()))];
  }

  /// A preset, of which each option of options.def may be varied.
  TransferOptions options() {
    TransferOptions out = flag() ? TransferOptions{} : TransferOptions::paper();
// Says how large a number mostly is, or which names there are.
#define CAGECAST_MOSTLY_share constexpr float mostly = 1;
#define CAGECAST_MOSTLY_length constexpr float mostly = 0.1f;
#define CAGECAST_MOSTLY_toggle constexpr float mostly = 1;
#define CAGECAST_MOSTLY_choice(type) \
  using enum type;                   \
  constexpr float mostly = 1;
#define CAGECAST_VARY(kind, field, range) \
  { CAGECAST_MOSTLY_##kind vary(out.field, mostly, {CAGECAST_VALUES range}); }
#define CAGECAST_VALUES(...) __VA_ARGS__
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) CAGECAST_VARY(kind, name, range)
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) CAGECAST_VARY(kind, steps.name, range)
#include "cagecast/options.def"
#undef CAGECAST_VARY
#undef CAGECAST_VALUES
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
    const std::uint32_t rings = 2 + input.below(4), sectors = 3 + input.below(6);
    const float radius = 1 + input.share();
    Mesh out;
    out.addBall({rings, sectors, hasUvs}, [](const Spot& p) { return p; });
    for (float& x : out.positions) x *= radius;
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < out.indices.size(); i += 6) {
      const std::uint32_t missing = input.below(4);
      for (std::size_t k = 0; k < 6; ++k)
        if ((missing & (k < 3 ? 1u : 2u)) == 0) some.push_back(out.indices[i + k]);
    }
    out.indices = std::move(some);
    return out;
  }
  /// The head of a figure that faces +z, in three groups: skin, with a nose, a mouth's crease and a few bumps, and two
  /// eyeballs. Each may be as large as it likes, or not there.
  static Mesh head(Input& input) {
    const auto some = [&](double most) { return most * static_cast<double>(input.share()); };
    const double nose = some(0.5), crease = some(0.2), eye = some(0.3), eyeX = some(0.5), eyeZ = 1 - some(0.6);
    struct Bump {
      double x, y, height;
    };
    std::vector<Bump> bumps;
    for (std::uint32_t i = input.below(4); i > 0; --i) bumps.push_back({some(2) - 1, some(2) - 1, some(0.6) - 0.3});
    Mesh out;
    const auto hill = [](double x, double width, double y, double height) {
      return std::exp(-x * x / (width * width) - y * y / (height * height));
    };
    out.addBall({24, 24, true}, [&](const Spot& p) {
      Spot at{0.7 * p.x, p.y, 0.85 * p.z};
      if (p.z <= 0) return at;
      at.z += nose * hill(at.x, 0.12, at.y + 0.1, 0.2) - crease * hill(at.x, 0.25, at.y + 0.45, 0.08);
      for (const Bump& bump : bumps) at.z += bump.height * hill(at.x - bump.x, 0.15, at.y - bump.y, 0.15);
      return at;
    });
    // A picture of the face lies over its front.
    for (std::size_t v = 0; v < out.uvs.size() / 2; ++v) {
      const float x = out.positions[3 * v], y = out.positions[3 * v + 1];
      const bool isFront = out.positions[3 * v + 2] > 0;
      out.uvs[2 * v] = isFront ? 0.5f + 0.5f * x : 0;
      out.uvs[2 * v + 1] = isFront ? 0.5f - 0.5f * y : 0;
    }
    out.groups.assign(out.positions.size() / 3, 0);
    for (const double side : {1.0, -1.0}) {
      if (eye > 0)
        out.addBall({6, 8, true}, [&](const Spot& p) {
          return Spot{side * eyeX + eye * p.x, 0.1 + eye * p.y, 0.85 * eyeZ + eye * p.z};
        });
      out.groups.resize(out.positions.size() / 3, side > 0 ? 1 : 2);
    }
    return out;
  }
  /// Adds a pose, in which some vertices are elsewhere.
  void move(Input& input) {
    for (const float x : positions) poses.push_back(input.below(4) == 0 ? input.coordinate() : x);
  }
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups, poses}; }

 private:
  struct Spot {
    double x, y, z;
  };
  struct Shape {
    std::uint32_t rings, sectors;
    bool hasUvs;
  };
  Mesh() = default;

  /// @param place  Where a place of the ball of radius 1 about the origin is.
  template <typename Place>
  void addBall(const Shape& shape, const Place& place) {
    const std::uint32_t first = static_cast<std::uint32_t>(positions.size() / 3), row = shape.sectors + 1;
    for (std::uint32_t i = 0; i <= shape.rings; ++i)
      for (std::uint32_t j = 0; j <= shape.sectors; ++j) {
        const double u = static_cast<double>(j) / shape.sectors, v = static_cast<double>(i) / shape.rings;
        const double polar = std::numbers::pi * v, around = 2 * std::numbers::pi * u;
        const Spot at =
            place({std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)});
        for (const double x : {at.x, at.y, at.z}) positions.push_back(static_cast<float>(x));
        if (shape.hasUvs) uvs.insert(uvs.end(), {static_cast<float>(u), static_cast<float>(v)});
      }
    for (std::uint32_t i = 0; i < shape.rings; ++i)
      for (std::uint32_t j = 0; j < shape.sectors; ++j) {
        const std::uint32_t at = first + i * row + j;
        indices.insert(indices.end(), {at, at + 1, at + row, at + 1, at + row + 1, at + row});
      }
  }
};

/// A cage, a target and options. Either mesh may be a ball instead, and what is painted may be masked.
struct Scene {
  Mesh cage, target;
  std::vector<Mask> vertexMasks, triangleMasks;
  TransferOptions options;

  explicit Scene(Input& input) : cage(input, true), target(input, false), options(input.options()) {
    const std::uint8_t has = input.byte();
    if ((has & 1) != 0) cage = Mesh::ball(input, true);
    if ((has & 2) != 0) target = Mesh::ball(input, false);
    if ((has & 4) != 0) target.move(input);
    if ((has & 8) != 0) mask(input, target.positions.size() / 3, vertexMasks);
    if ((has & 16) != 0) mask(input, target.indices.size() / 3, triangleMasks);
    options.masks = {vertexMasks, triangleMasks};
  }
  Scene(const Scene&) = delete;  // Its options refer to its masks.
  Scene& operator=(const Scene&) = delete;

 private:
  static void mask(Input& input, std::size_t count, std::vector<Mask>& masks) {
    for (; count > 0; --count) {
      const std::uint32_t drawn = input.below(8);
      masks.push_back(drawn == 1 ? Mask::never : drawn == 2 ? Mask::always : Mask::automatic);
    }
  }
};

}  // namespace cagecast::fuzz
