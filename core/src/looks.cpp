#include "looks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cagecast {
namespace {

/// Where the middle of a part is, and how far it reaches from there.
struct Extent {
  Vec3 middle{0, 0, 0};
  double radius = 0;

  explicit Extent(Hull hull) noexcept {
    for (const Vec3 corner : hull) middle = middle + corner;
    middle = 1 / static_cast<double>(hull.size()) * middle;
    for (const Vec3 corner : hull) radius = std::max(radius, length(corner - middle));
  }
};

/// Once in the code: `placeOn` is long.
Place placeOf(const CageTriangle& t, Vec3 p) { return placeOn(t, p); }

}  // namespace

Looker::Looker(const MeshView& mesh, const Cage& cage, const CageTree& tree, const Rims& rims, const Atlas* atlas, const Units& units,
               Scratch& scratch) noexcept
    : mesh_(mesh),
      cage_(cage),
      rims_(rims),
      atlas_(atlas),
      diagonal_(units.diagonal),
      margin_(1.001 * kTieDistance * units.diagonal),
      // Places are rounded for the search, by less than what a reach more makes it allow for.
      search_(tree, units.diagonal + static_cast<double>(units.reach), scratch),
      found_(scratch.take<std::uint32_t>(cage.count)),
      candidates_(scratch.take<Candidate>(cage.count)),
      lines_(cage, tree, rims, atlas, scratch),
      clearances_(scratch.take<double>(mesh.positions.size() / 3)) {
  if (!scratch.failed()) std::fill(clearances_, clearances_ + mesh.positions.size() / 3, -1.0);
}

const Candidate& Looker::nearestOf(const std::uint32_t* slots, std::uint32_t count, Vec3 p) noexcept {
  std::uint32_t found = 0;
  double limit = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < count; ++i) {
    const CageTriangle& t = cage_.triangles[slots[i]];
    // It is not nearer than its plane.
    if (std::abs(dot(p - Vec3::from(t.a), t.normal.exact)) > limit) continue;
    candidates_[found] = {slots[i], placeOf(t, p)};
    if (candidates_[found].place.distance > limit) continue;
    limit = std::min(limit, candidates_[found].place.distance + margin_);
    ++found;
  }
  return cagecast::nearestOf(candidates_, found, diagonal_);
}

std::uint32_t Looker::find(Vec3 p, double more, double distance) noexcept {
  search_.widen(more, distance);
  alignas(16) const float rounded[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
  search_.search(rounded, 1);
  return search_.candidates(0, found_);
}

Look Looker::at(Vec3 p) noexcept { return judge(nearestOf(found_, find(p, 0, diagonal_), p)); }

Look Looker::at(Nearby nearby, Vec3 p) noexcept {
  return nearby.count == 0 ? at(p) : judge(nearestOf(&listed_[nearby.first], nearby.count, p));
}

Look Looker::judge(const Candidate& nearest) const noexcept {
  const auto& [slot, place] = nearest;
  const CageTriangle& t = cage_.triangles[slot];
  Look look{atlas_ == nullptr ? 0 : atlas_->islands[slot], 4 * slot + 3, {slot, place.distance, uvAt(t, place)}};
  const std::uint32_t side = atlas_ == nullptr ? rims_.sideAt(t, slot, positionOf(t, place), diagonal_) : Rims::kNone;
  if (side != Rims::kNone) {
    constexpr std::uint32_t kCorner = 1u << 31;
    look.side = 1;
    look.cell = side < 3 ? 4 * slot + side : kCorner | rims_.vertexOf[cornersOf(slot)[side - 3]];
  }
  return look;
}

Nearby Looker::around(Hull hull, double distance) noexcept {
  const auto& [middle, radius] = Extent(hull);
  // The nearest to any place of the part is farther from the middle than the nearest there by no more than this.
  const std::uint32_t count = find(middle, 2 * radius, distance);
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (std::uint32_t i = 0; i < count; ++i) listed_.add(found_[i]);
  return failed() ? Nearby{} : within({first, count}, hull);
}

Nearby Looker::within(Nearby nearby, Hull hull) noexcept {
  if (nearby.count <= 1) return nearby;
  const Vec3 middle = Extent(hull).middle;
  const std::uint32_t nearest = nearestOf(&listed_[nearby.first], nearby.count, middle).slot;
  // Distance to a triangle is convex: between corners it is nowhere more than what lies straight between theirs,
  double limits[kMostCorners];
  for (std::size_t k = 0; k < hull.size(); ++k) limits[k] = placeOf(cage_.triangles[nearest], hull[k]).distance + margin_;
  // and nowhere less than straight on from the middle.
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t slot = listed_[nearby.first + i];
    const CageTriangle& t = cage_.triangles[slot];
    const Place place = placeOf(t, middle);
    const Vec3 away = place.distance > margin_ ? 1 / place.distance * (middle - positionOf(t, place)) : Vec3{0, 0, 0};
    bool isNear = false;
    for (std::size_t k = 0; k < hull.size(); ++k) isNear = isNear || place.distance + dot(away, hull[k] - middle) <= limits[k];
    if (isNear) listed_.add(slot);
  }
  return failed() ? nearby : Nearby{first, static_cast<std::uint32_t>(listed_.size()) - first};
}

bool Looker::isBetween(const Look& a, const Look& b, double apart) const noexcept {
  return atlas_ == nullptr ? a.side != b.side : atlas_->tears(a.landing, b.landing, apart);
}

bool Looker::areAllOn(std::uint32_t side, Nearby nearby, Hull hull) const noexcept {
  const auto* slots = &listed_[nearby.first];
  return nearby.count > 0 && std::all_of(slots, slots + nearby.count, [&](std::uint32_t slot) {
    if (atlas_ != nullptr) return atlas_->islands[slot] == side;
    return side == 0 ? rims_.areOff(cage_.triangles[slot], slot, hull, diagonal_) : rims_.areOn(cage_.triangles[slot], slot, hull);
  });
}

bool Looker::isWhole(std::uint32_t side, Nearby nearby, Hull hull) const noexcept {
  if (!areAllOn(side, nearby, hull)) return false;
  if (atlas_ == nullptr) return true;
  const auto& [middle, radius] = Extent(hull);
  Uv first{};
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t slot = listed_[nearby.first + i];
    const CageTriangle& t = cage_.triangles[slot];
    // How fast the texture changes across the triangle, at most.
    double squares = 0;
    for (int k = 0; k < 2; ++k) {
      const double a = static_cast<double>(t.uvs[k]);
      const Vec3 change = (static_cast<double>(t.uvs[2 + k]) - a) * t.towardsB + (static_cast<double>(t.uvs[4 + k]) - a) * t.towardsC;
      squares += dot(change, change);
    }
    const double fastest = std::sqrt(squares);
    // Mostly that is explained by its edges.
    if (nearby.count == 1 && fastest <= kSmear * atlas_->stretch[slot]) return true;
    // What is nearest to a place moves no farther than the place.
    const Uv uv = uvAt(t, placeOf(t, middle));
    if (i == 0) first = uv;
    const double du = uv.u - first.u, dv = uv.v - first.v;
    if (std::sqrt(du * du + dv * dv) + fastest * radius > kSmearSlack / 2) return false;
  }
  return true;
}

double Looker::clearance(const Look& look, Vec3 p) noexcept {
  const CageTriangle& t = cage_.triangles[look.landing.slot];
  const float* corners[3] = {t.a, t.b, t.c};
  double least = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    double& known = clearances_[cornersOf(look.landing.slot)[k]];
    const Vec3 corner = Vec3::from(corners[k]);
    if (known < 0) known = lines_.distance(corner);
    least = std::max(least, known - length(p - corner));
  }
  // The distance to the cage, and that to its rims or seams, change by no more than one steps.
  return (least - look.landing.distance) / 2;
}

}  // namespace cagecast
