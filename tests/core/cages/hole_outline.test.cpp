#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "fit/hole_outline.hpp"

using namespace cagecast::cages;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// An eye of 2 by 1.
HoleContent ellipse() {
  HoleContent content;
  for (int d = 0; d < 144; ++d) {
    const double angle = kTurn * d / 144;
    content.contour.push_back(1 / std::hypot(std::cos(angle), 2 * std::sin(angle)));
  }
  return content;
}

constexpr double kEyeArea = std::numbers::pi / 2;

/// Corners that are crowded on one side, as those of a template may be.
std::vector<Flat> crowded() {
  std::vector<Flat> corners;
  for (const double angle : {0.0, 0.5, 0.9, 2.8, 3.4, 5.2}) corners.push_back({std::cos(angle), std::sin(angle)});
  return corners;
}

bool isInside(const std::vector<Flat>& hole, const Flat& p) {
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const Flat &a = hole[i], &b = hole[(i + 1) % hole.size()];
    // Convex enough here for a test by half planes about the middle.
    if (a.x * p.y - a.y * p.x < 0 || p.x * b.y - p.y * b.x < 0) continue;
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= 0;
  }
  return false;
}

double areaOf(const std::vector<Flat>& hole) {
  double twice = 0;
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const Flat &a = hole[i], &b = hole[(i + 1) % hole.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

double freeShare(const std::vector<Flat>& hole, const HoleContent& content) {
  double seen = 0;
  for (std::size_t d = 0; d < content.contour.size(); ++d) {
    const double angle = kTurn * static_cast<double>(d) / static_cast<double>(content.contour.size());
    seen += isInside(hole, {content.contour[d] * std::cos(angle), content.contour[d] * std::sin(angle)}) ? 1 : 0;
  }
  return seen / static_cast<double>(content.contour.size());
}

}  // namespace

TEST_CASE("a hole of few corners shows all of an eye and little else", "[cages][fit]") {
  const HoleContent content = ellipse();
  const std::vector<Flat> hole = fitOutline(crowded(), content);
  REQUIRE(hole.size() == 6);
  CHECK(freeShare(hole, content) > 0.95);
  CHECK(areaOf(hole) < 1.5 * kEyeArea);
}

TEST_CASE("a hole shows lashes where there is room for them", "[cages][fit]") {
  HoleContent content = ellipse();
  for (int i = -4; i <= 4; ++i) content.covers.push_back({{0.15 * i, 0.62 - 0.02 * i * i}, 1, 0});
  std::size_t shown = 0;
  const std::vector<Flat> hole = fitOutline(crowded(), content);
  for (const HoleContent::Cover& cover : content.covers) shown += isInside(hole, cover.at) ? 1 : 0;
  CHECK(2 * shown > content.covers.size());
  CHECK(freeShare(hole, content) > 0.95);
  CHECK(areaOf(hole) < 1.5 * kEyeArea);
}

TEST_CASE("a hole that shrinks folds no triangle beside it", "[cages][fit]") {
  HoleContent content = ellipse();
  // The edge from the first to the second corner has its third corner straight above the eye.
  const std::vector<Flat> corners = crowded();
  const Flat top{1.2, 2};
  content.neighbours.push_back({{1, 0, -1}, {corners[1], {1.6, 0.1}, top}});
  const std::vector<Flat> hole = fitOutline(corners, content);
  const Flat &a = hole[1], &b = hole[0];
  CHECK((b.x - a.x) * (top.y - a.y) - (b.y - a.y) * (top.x - a.x) > 0);
}
