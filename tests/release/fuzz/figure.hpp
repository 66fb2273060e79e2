#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "fuzz/input.hpp"

namespace cagecast::fuzz {

/// Whoever waits for a call of the cages library: cancels it at one of its first reports, or lets it end.
class Patience {
 public:
  explicit Patience(Input& input) : reports_(input.flag() ? kEndless : input.below(40)) {}
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;

  /// Valid as long as this.
  [[nodiscard]] cages::Progress progress() {
    return [this](float share, const char* stage) { return ask(share) && stage != nullptr; };
  }
  bool ask(float share) {
    require(share >= 0 && share <= 1.0001f);
    require(!gone_);  // A cancelled call asks no more.
    if (reports_ == kEndless || reports_-- > 0) return true;
    gone_ = true;
    return false;
  }
  /// Whether it cancelled the call.
  [[nodiscard]] bool gone() const { return gone_; }

 private:
  static constexpr std::uint32_t kEndless = UINT32_MAX;
  std::uint32_t reports_;
  bool gone_ = false;
};

/// A model and its arrays.
struct Figure {
  Mesh mesh;
  cages::Position anywhere;
  std::vector<std::uint16_t> holders;
  std::vector<std::uint8_t> marks, pixels;
  cages::Model model;

  explicit Figure(Input& input) : mesh(input, true) {
    const std::uint8_t has = input.byte();
    const bool isHead = (has & 64) != 0;
    if ((has & 1) != 0) mesh = Mesh::ball(input, true);
    if (isHead) mesh = Mesh::head(input);
    const char* const names[] = {"head", "eye_l", "eye_r", "hair", "body/skin", "teeth", "wheel"};
    model.mesh = mesh.view();
    for (std::uint32_t i = isHead ? 3 : input.below(5); i > 0; --i) model.parts.emplace_back(names[input.below(7)]);
    anywhere = {input.coordinate(), input.coordinate(), input.coordinate()};
    if ((has & 2) != 0) model.joints = {{"Hips", {0, 0, 0}, -1}, {"Head", anywhere, 0}, {"LeftEye", anywhere, 1}};
    if ((has & 4) != 0) holders.resize(mesh.positions.size() / 3);
    for (std::uint16_t& joint : holders) joint = static_cast<std::uint16_t>(input.below(4));
    model.vertexJoints = holders;
    if ((has & 8) != 0) marks.resize(mesh.indices.size() / 3);
    for (std::uint8_t& mark : marks) mark = input.flag();
    model.marks = marks;
    if ((has & 16) != 0) model.hints = {{"eye_inner", anywhere}, {"eye_outer", {1, 0, 0}}, {"mouth", {0, -0.5f, 0.5f}}};
    if ((has & 128) != 0) paint(input);
    if ((has & 160) != 32) return;
    for (int i = 0; i < 4 * 2 * 2; ++i) pixels.push_back(input.byte());
    model.baseColors.assign(3, {{input.share(), input.share(), input.share()}, {2, 2, pixels}});
  }

 private:
  /// A picture of eyes and a mouth, each of any colour.
  void paint(Input& input) {
    constexpr std::uint32_t kSide = 64;
    using Color = std::array<std::uint8_t, 3>;
    const auto color = [&] { return Color{input.byte(), input.byte(), input.byte()}; };
    const Color skin = color(), eye = color(), iris = color(), lips = color(), hair = color();
    const double size = 0.25 * static_cast<double>(input.share()), hairline = static_cast<double>(input.share());
    const auto isWithin = [](double across, double up) { return across * across + up * up < 1; };
    const auto at = [&](double x, double y) {
      const double across = std::abs(x) - 0.27, up = y - 0.05;
      if (isWithin(across / (0.4 * size), up / (0.4 * size))) return iris;
      if (isWithin(across / size, up / (0.6 * size))) return eye;
      if (isWithin(x / 0.2, (y + 0.45) / 0.06)) return lips;
      return y > hairline ? hair : skin;
    };
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      const Color one = at(2 * (i % kSide + 0.5) / kSide - 1, 1 - 2 * (i / kSide + 0.5) / kSide);
      pixels.insert(pixels.end(), {one[0], one[1], one[2], 255});
    }
    model.baseColors.assign(3, {.image = {kSide, kSide, pixels}});
  }
};

/// @param given  What the call was given.
/// @return Whether there is an answer.
template <typename... Given>
bool isDone(const Status& status, const Patience& patience, const Given&... given) {
  require((status.code == Code::aborted) == patience.gone());
  if (!status.ok()) require(!describe(status, given...).empty());
  return status.ok();
}

inline void check(const std::vector<cages::Landmark>& landmarks) {
  for (const cages::Landmark& landmark : landmarks) {
    require(!landmark.name.empty() && landmark.confidence >= 0 && landmark.confidence <= 1);
    for (const float x : landmark.position) require(std::isfinite(x));
  }
}

}  // namespace cagecast::fuzz
