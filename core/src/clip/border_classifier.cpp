#include "clip/border_classifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cagecast {
namespace {

/// Of more triangles it is not asked whether the texture hangs together.
constexpr std::uint32_t kMostPatches = 8;

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

/// Once in the code: `closestPointOnTriangle` is long.
ClosestPoint placeOf(const CageTriangle& t, Vec3 p) { return closestPointOnTriangle(t, p); }

}  // namespace

BorderClassifier::BorderClassifier(const MeshView& mesh, const Cage& cage, const CageTree& tree,
                                   const BoundaryLoops& loops, const UvCharts* charts, const Units& units,
                                   Arena& arena) noexcept
    : mesh_(mesh),
      cage_(cage),
      loops_(loops),
      charts_(charts),
      diagonal_(units.diagonal),
      margin_(1.001 * kTieDistance * units.diagonal),
      // Places are rounded for the search, by less than what a reach more makes it allow for.
      search_(tree, units.diagonal + static_cast<double>(units.reach), arena),
      found_(arena.allocate<std::uint32_t>(cage.count)),
      candidates_(arena.allocate<Candidate>(cage.count)),
      lines_(cage, tree, loops, arena),
      clearances_(arena.allocate<double>(mesh.positions.size() / 3)) {
  if (!arena.failed()) std::fill(clearances_, clearances_ + mesh.positions.size() / 3, -1.0);
}

const Candidate& BorderClassifier::nearestOf(const std::uint32_t* slots, std::uint32_t count, Vec3 p) noexcept {
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

std::uint32_t BorderClassifier::find(Vec3 p, double more, double distance) noexcept {
  search_.widen(more, distance);
  alignas(16) const float rounded[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
  search_.search(rounded, 1);
  return search_.candidates(0, found_);
}

Look BorderClassifier::at(Vec3 p) noexcept { return judge(nearestOf(found_, find(p, 0, diagonal_), p)); }

Look BorderClassifier::at(Nearby nearby, Vec3 p) noexcept {
  return nearby.count == 0 ? at(p) : judge(nearestOf(&listed_[nearby.first], nearby.count, p));
}

Look BorderClassifier::judge(const Candidate& nearest) const noexcept {
  const auto& [slot, place] = nearest;
  const CageTriangle& t = cage_.triangles[slot];
  const Vec3 q = positionOf(t, place);
  const std::uint32_t side =
      charts_ != nullptr ? charts_->charts[slot] : loops_.sideAt(t, slot, q, diagonal_) != BoundaryLoops::kNone;
  return {side, slot, q, uvAt(t, place)};
}

Nearby BorderClassifier::around(Hull hull, double distance) noexcept {
  const auto& [middle, radius] = Extent(hull);
  // The nearest to any place of the part is farther from the middle than the nearest there by no more than this.
  const std::uint32_t count = find(middle, 2 * radius, distance);
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (std::uint32_t i = 0; i < count; ++i) listed_.add(found_[i]);
  return failed() ? Nearby{} : within({first, count}, hull);
}

Nearby BorderClassifier::within(Nearby nearby, Hull hull) noexcept {
  if (nearby.count <= 1) return nearby;
  const Vec3 middle = Extent(hull).middle;
  const std::uint32_t nearest = nearestOf(&listed_[nearby.first], nearby.count, middle).slot;
  // Distance to a triangle is convex: between corners it is nowhere more than what lies straight between theirs,
  double limits[kMostCorners];
  for (std::size_t k = 0; k < hull.size(); ++k)
    limits[k] = placeOf(cage_.triangles[nearest], hull[k]).distance + margin_;
  // and nowhere less than straight on from the middle.
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t slot = listed_[nearby.first + i];
    const CageTriangle& t = cage_.triangles[slot];
    const ClosestPoint place = placeOf(t, middle);
    const Vec3 away = place.distance > margin_ ? 1 / place.distance * (middle - positionOf(t, place)) : Vec3{0, 0, 0};
    bool isNear = false;
    for (std::size_t k = 0; k < hull.size(); ++k)
      isNear = isNear || place.distance + dot(away, hull[k] - middle) <= limits[k];
    if (isNear) listed_.add(slot);
  }
  return failed() ? nearby : Nearby{first, static_cast<std::uint32_t>(listed_.size()) - first};
}

bool BorderClassifier::isBetween(const Look& a, const Look& b) const noexcept {
  if (a.side != b.side || charts_ == nullptr) return a.side != b.side;
  const double du = b.uv.u - a.uv.u, dv = b.uv.v - a.uv.v;
  const double explained = std::max(charts_->stretch[a.slot], charts_->stretch[b.slot]) * length(b.q - a.q);
  return std::sqrt(du * du + dv * dv) > kSmear * explained + kSmearSlack;
}

bool BorderClassifier::areAllOn(std::uint32_t side, Nearby nearby, Hull hull) const noexcept {
  const auto* slots = &listed_[nearby.first];
  return nearby.count > 0 && std::all_of(slots, slots + nearby.count, [&](std::uint32_t slot) {
           if (charts_ != nullptr) return charts_->charts[slot] == side;
           return side == 0 ? loops_.areOff(cage_.triangles[slot], slot, hull, diagonal_)
                            : loops_.areOn(cage_.triangles[slot], slot, hull);
         });
}

bool BorderClassifier::isWhole(std::uint32_t side, Nearby nearby, Hull hull) const noexcept {
  if (!areAllOn(side, nearby, hull)) return false;
  if (charts_ == nullptr) return true;
  // What is nearest to a place of the part, on each triangle: it moves no farther than the place.
  struct Patch {
    Vec3 q;
    Uv uv;
    double fastest, stretch;  ///< How fast the texture changes across the triangle, at most, and along its edges.
  };
  Patch patches[kMostPatches];
  if (nearby.count > kMostPatches) return false;
  const auto& [middle, radius] = Extent(hull);
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t slot = listed_[nearby.first + i];
    const CageTriangle& t = cage_.triangles[slot];
    double squares = 0;
    for (int k = 0; k < 2; ++k) {
      const auto a = static_cast<double>(t.uvs[k]);
      const auto b = static_cast<double>(t.uvs[2 + k]);
      const auto c = static_cast<double>(t.uvs[4 + k]);
      const TwoVec3 changes = simd::doubles(b - a, c - a) * t.gradients;
      const auto sum = [](simd::f64x2 both) { return simd::doubleOf<0>(both) + simd::doubleOf<1>(both); };
      const Vec3 change{sum(changes.x), sum(changes.y), sum(changes.z)};
      squares += dot(change, change);
    }
    const ClosestPoint place = placeOf(t, middle);
    const Patch& p = patches[i] = {positionOf(t, place), uvAt(t, place), std::sqrt(squares), charts_->stretch[slot]};
    // On one triangle the texture is mostly explained by its edges.
    if (p.fastest > kSmear * p.stretch && 2 * p.fastest * radius > kSmearSlack) return false;
    for (std::uint32_t j = 0; j < i; ++j) {
      const Patch& o = patches[j];
      const double apart = std::max(0.0, length(p.q - o.q) - 2 * radius);
      const double du = p.uv.u - o.uv.u, dv = p.uv.v - o.uv.v;
      if (std::sqrt(du * du + dv * dv) + (p.fastest + o.fastest) * radius >
          kSmear * std::max(p.stretch, o.stretch) * apart + kSmearSlack)
        return false;
    }
  }
  return true;
}

double BorderClassifier::clearance(const Look& look, Vec3 p) noexcept {
  if (charts_ != nullptr) return 0;
  const CageTriangle& t = cage_.triangles[look.slot];
  const std::uint32_t* index = mesh_.indices.data() + std::size_t{3} * t.index;
  const float* corners[3] = {t.a, t.b, t.c};
  double least = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    double& known = clearances_[index[k]];
    const Vec3 corner = Vec3::from(corners[k]);
    if (known < 0) known = lines_.distance(corner);
    least = std::max(least, known - length(p - corner));
  }
  // BoundaryLoops are at least so far from p. The distance to them, and that to the cage, change by no more than one
  // steps: as long as the one is greater than the other, what is nearest lies on no loop.
  return (least - length(p - look.q)) / 2;
}

}  // namespace cagecast
