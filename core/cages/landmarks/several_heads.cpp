#include <algorithm>
#include <cmath>
#include <vector>

#include "landmarks/eyes.hpp"

namespace cagecast::cages {

namespace {

/// Balls, or distances of eyes, are alike if the larger is at most this many times the smaller.
constexpr double kAlikeBalls = 1.5;
/// Heads beside each other are at least this far apart, in distances of their eyes: a head is more than twice as wide,
/// and they may be pushed into each other.
constexpr double kBeside = 1.5;
/// The largest balls that are looked at, as each pair is compared with each.
constexpr std::size_t kMaxBalls = 24;

bool alike(double a, double b) { return std::max(a, b) <= kAlikeBalls * std::min(a, b); }

/// Whether the way from one point to another goes to the side rather than up.
bool isLevel(const Vec3& way) { return std::abs(way.y) < 0.5 * length(way); }

/// Two balls that may be the eyes of a head.
struct EyePair {
  Vec3 middle;
  double apart;
};

std::vector<EyePair> eyePairsOf(const std::vector<Sphere>& balls) {
  std::vector<EyePair> pairs;
  for (std::size_t i = 0; i < balls.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Vec3 &a = balls[i].centre, &b = balls[k].centre;
      const double apart = length(b - a);
      const bool areApart = apart > 2 * std::max(balls[i].radius, balls[k].radius);
      if (areApart && isLevel(b - a) && alike(balls[i].radius, balls[k].radius))
        pairs.push_back({0.5 * (a + b), apart});
    }
  return pairs;
}

}  // namespace

bool haveSeveralHeads(std::vector<Sphere> balls) {
  std::stable_sort(balls.begin(), balls.end(), [](const Sphere& a, const Sphere& b) { return a.radius > b.radius; });
  balls.resize(std::min(balls.size(), kMaxBalls));
  const std::vector<EyePair> pairs = eyePairsOf(balls);
  for (const EyePair& one : pairs)
    for (const EyePair& other : pairs) {
      const Vec3 way = other.middle - one.middle;
      if (alike(one.apart, other.apart) && isLevel(way) && length(way) > kBeside * std::max(one.apart, other.apart))
        return true;
    }
  return false;
}

}  // namespace cagecast::cages
