#include <algorithm>
#include <cmath>
#include <optional>

#include "make/steps.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

/// Wheels: at most this much higher than long, and this thick; in diameters.
constexpr double kRound = 0.1, kThickest = 1.0, kThinnest = 0.08;
/// Their diameters, in heights of the model, and how far they are above its lowest point.
constexpr double kSmallest = 0.06, kLargest = 0.7, kHighest = 0.12;
/// Two are a pair if diameters and places differ by less than this share of the diameter.
constexpr double kAlike = 0.1;
/// A disc has no vertex where its box has corners, beyond this share of half its size along both.
constexpr double kCorner = 0.85;
/// More discs than this are no wheels: a heap of coins.
constexpr std::size_t kMaxWheels = 64;
/// What lies within a wheel is part of it, as rims are.
constexpr double kAround = 0.06;

/// A connected piece as a disc.
struct Disc {
  std::size_t axle = 0;  ///< 0 or 2: along x or z.
  Vec3 middle{};
  double diameter = 0;
  Bounds box;
};

double along(const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// The piece as a disc on the ground, if it is one.
std::optional<Disc> discOf(const TriangleMesh& piece, const Bounds& whole) {
  const Bounds box = boundsOf(piece);
  const Vec3 size = box.size(), middle = box.middle();
  const double height = whole.size().y;
  if (size.y < kSmallest * height || size.y > kLargest * height || box.low.y > whole.low.y + kHighest * height)
    return std::nullopt;
  for (const std::size_t axle : {std::size_t{0}, std::size_t{2}}) {
    const std::size_t across = 2 - axle;
    const double width = along(size, across), thickness = along(size, axle);
    const bool isDisc =
        std::abs(width - size.y) < kRound * size.y && thickness < kThickest * size.y && thickness > kThinnest * size.y;
    const auto isInCorner = [&](const Vec3& p) {
      const double high = std::abs(p.y - middle.y) / size.y, aside = std::abs(along(p - middle, across)) / width;
      return 2 * std::min(high, aside) > kCorner;
    };
    if (isDisc && std::none_of(piece.positions.begin(), piece.positions.end(), isInCorner))
      return Disc{axle, middle, size.y, box};
  }
  return std::nullopt;
}

/// Whether two discs may be the wheels of one axle, or one behind the other.
bool arePair(const Disc& a, const Disc& b) {
  const double most = kAlike * a.diameter;
  return a.axle == b.axle && std::abs(a.diameter - b.diameter) < most && std::abs(a.middle.y - b.middle.y) < most &&
         length(a.middle - b.middle) > 0.5 * a.diameter;
}

}  // namespace

std::vector<bool> wheelsOf(const TriangleMesh& mesh) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> pieces = connectedPieces(mesh, count);
  const Bounds whole = boundsOf(mesh);
  std::vector<Disc> discs;
  for (const TriangleMesh& piece : split(mesh, pieces, count))
    if (const auto disc = discOf(piece, whole)) discs.push_back(*disc);
  std::vector<Disc> wheels;
  if (discs.size() > kMaxWheels) discs.clear();
  for (const Disc& disc : discs)
    if (std::any_of(discs.begin(), discs.end(), [&](const Disc& other) { return arePair(disc, other); }))
      wheels.push_back(disc);
  std::vector<bool> isWheel(count, true);
  for (std::size_t t = 0; t < pieces.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Vec3& p = mesh.positions[v];
      isWheel[pieces[t]] = isWheel[pieces[t]] && std::any_of(wheels.begin(), wheels.end(), [&](const Disc& wheel) {
                             return wheel.box.distance(p) < kAround * wheel.diameter;
                           });
    }
  std::vector<bool> out(pieces.size());
  for (std::size_t t = 0; t < pieces.size(); ++t) out[t] = isWheel[pieces[t]];
  return out;
}

}  // namespace cagecast::cages
