#include "clip/border_classifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "clip/tie.hpp"

namespace cagecast {
namespace {

/// Parts with more cage triangles nearby than this are not tested for smeared texture: all pairs are compared.
constexpr std::uint32_t kMaxPairwise = 8;
/// Where more cage triangles than this are near a part, none is left out for losing a tie: all pairs are compared here
/// too, and fans of more triangles are rare.
constexpr std::size_t kMaxTied = 128;

/// The centroid of a part's corners, and the radius of the ball around it that contains them.
struct Ball {
  Vec3 centre{0, 0, 0};
  double radius = 0;

  explicit Ball(Hull hull) noexcept {
    for (const Vec3 corner : hull) centre = centre + corner;
    centre = 1 / static_cast<double>(hull.size()) * centre;
    for (const Vec3 corner : hull) radius = std::max(radius, length(corner - centre));
  }
};

/// Not inlined, to keep the code small.
ClosestPoint closestPointOf(const CageTriangle& t, Vec3 p) { return closestPointOnTriangle(t, p); }

/// How fast the texture changes across a triangle, at most: UV length per length.
double fastestChange(const CageTriangle& t) {
  double squared = 0;
  for (int k = 0; k < 2; ++k) {
    const auto a = static_cast<double>(t.uvs[k]);
    const auto b = static_cast<double>(t.uvs[2 + k]);
    const auto c = static_cast<double>(t.uvs[4 + k]);
    const Vec3 change = (b - a) * t.gradientB + (c - a) * t.gradientC;
    squared += dot(change, change);
  }
  return std::sqrt(squared);
}

}  // namespace

BorderClassifier::BorderClassifier(const ClipCage& cage, BorderKind kind, std::uint64_t limit, Arena& arena) noexcept
    : cage_(cage),
      charts_(kind == BorderKind::seams ? cage.charts : nullptr),
      diagonal_(cage.units.diagonal),
      slack_(1.001 * kTieDistance * cage.units.diagonal),
      // Points are rounded to float for the search. The size of the scene, added, makes it allow for more than that.
      search_(cage.tree, cage.units.diagonal + static_cast<double>(cage.units.sceneSize), arena),
      found_(arena.allocate<std::uint32_t>(cage.cage.count)),
      candidates_(arena.allocate<Candidate>(cage.cage.count)),
      lines_(cage.cage, cage.tree, cage.loops, arena),
      clearances_(arena.allocate<double>(cage.mesh.positions.size() / 3)),
      limit_(limit) {
  if (!arena.failed()) std::fill_n(clearances_, cage.mesh.positions.size() / 3, -1.0);
}

/// Finds the nearest of some cage triangles by the tie rule.
const Candidate& BorderClassifier::nearestOf(const std::uint32_t* cageTriangles, std::uint32_t count, Vec3 p) noexcept {
  comparisons_ += count;
  std::uint32_t candidateCount = 0;
  double limit = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < count; ++i) {
    const CageTriangle& t = cage_.cage.triangles[cageTriangles[i]];
    // A triangle is no nearer than its plane.
    if (std::abs(dot(p - Vec3::from(t.a), t.normal.exact)) > limit) continue;
    Candidate& candidate = candidates_[candidateCount] = {cageTriangles[i], closestPointOf(t, p)};
    if (candidate.point.distance > limit) continue;
    limit = std::min(limit, candidate.point.distance + slack_);
    ++candidateCount;
  }
  return cagecast::nearestOf(candidates_, candidateCount, diagonal_);
}

/// Finds the cage triangles that are no farther from a point than the nearest one plus `more`; `found_` gets them.
/// @param distance  As in `ClosestPointSearch::widen`.
/// @return How many there are.
std::uint32_t BorderClassifier::findWithin(Vec3 p, double more, double distance) noexcept {
  search_.widen(more, distance);
  alignas(16) const float rounded[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
  search_.search(rounded, 1);
  return search_.candidates(0, found_);
}

BorderSample BorderClassifier::sample(Vec3 p) noexcept {
  return classify(nearestOf(found_, findWithin(p, 0, diagonal_), p));
}

BorderSample BorderClassifier::sample(NearbyTriangles nearby, Vec3 p) noexcept {
  return nearby.count == 0 ? sample(p) : classify(nearestOf(&listed_[nearby.first], nearby.count, p));
}

BorderSample BorderClassifier::classify(const Candidate& nearest) const noexcept {
  const auto& [cageTriangle, place] = nearest;
  const CageTriangle& t = cage_.cage.triangles[cageTriangle];
  const Vec3 closest = positionOf(t, place);
  const std::uint32_t region = charts_ != nullptr
                                   ? charts_->charts[cageTriangle]
                                   : cage_.loops.elementAt(t, cageTriangle, closest, diagonal_) != BoundaryLoops::kNone;
  return {region, cageTriangle, closest, uvAt(t, place)};
}

NearbyTriangles BorderClassifier::listNearby(Hull hull, double distance) noexcept {
  const auto& [centre, radius] = Ball(hull);
  // For any point of the part, the nearest triangle is at most this much farther from the centre than the one nearest
  // to the centre.
  const std::uint32_t count = findWithin(centre, 2 * radius, distance);
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (std::uint32_t i = 0; i < count; ++i) listed_.add(found_[i]);
  return failed() ? NearbyTriangles{} : narrow({first, count}, hull);
}

NearbyTriangles BorderClassifier::narrow(NearbyTriangles nearby, Hull hull) noexcept {
  if (nearby.count <= 1) return nearby;
  comparisons_ += std::uint64_t{2} * nearby.count;  // With the centre, and with the corners.
  const Vec3 centre = Ball(hull).centre;
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t cageTriangle = listed_[nearby.first + i];
    candidates_[i] = {cageTriangle, closestPointOf(cage_.cage.triangles[cageTriangle], centre)};
  }
  const std::uint32_t nearest = cagecast::nearestOf(candidates_, nearby.count, diagonal_).cageTriangle;
  // The distance to a triangle is a convex function. So, within the part, the distance to the cage is at most what is
  // interpolated between the corners' distances to one triangle,
  limits_.truncate(0);
  for (const Vec3 corner : hull) limits_.add(closestPointOf(cage_.cage.triangles[nearest], corner).distance + slack_);
  if (failed()) return nearby;
  // and the distance to any other triangle is at least its tangent at the centre.
  const auto isFar = [&](const Candidate& candidate) {
    const auto& [cageTriangle, place] = candidate;
    const Vec3 offset = centre - positionOf(cage_.cage.triangles[cageTriangle], place);
    const Vec3 away = place.distance > slack_ ? 1 / place.distance * offset : Vec3{0, 0, 0};
    for (std::size_t k = 0; k < hull.size(); ++k) {
      if (place.distance + dot(away, hull[k] - centre) <= limits_[k]) return false;
    }
    return true;
  };
  const std::span<const Candidate> near(candidates_, std::remove_if(candidates_, candidates_ + nearby.count, isFar));
  const auto first = static_cast<std::uint32_t>(listed_.size());
  for (const Candidate& candidate : near) {
    if (!losesTie(candidate, near, hull)) listed_.add(candidate.cageTriangle);
  }
  return failed() ? nearby : NearbyTriangles{first, static_cast<std::uint32_t>(listed_.size()) - first};
}

/// Whether a triangle surely loses to one of those near a part, at all points of the part.
/// @param loser,near  With their closest points to the part's centroid.
bool BorderClassifier::losesTie(const Candidate& loser, std::span<const Candidate> near, Hull hull) noexcept {
  if (loser.point.inside || near.size() > kMaxTied) return false;
  return std::any_of(near.begin(), near.end(), [&](const Candidate& other) {
    // At the centroid, too, the winner is as near, and its plane as far. Most pairs are told apart by that.
    if (other.point.distance > loser.point.distance + slack_ ||
        std::abs(other.point.height) < std::abs(loser.point.height)) {
      return false;
    }
    ++comparisons_;
    return other.cageTriangle != loser.cageTriangle &&
           cagecast::losesTie(cage_.cage, loser.cageTriangle, other.cageTriangle, hull, diagonal_);
  });
}

bool BorderClassifier::separates(const BorderSample& a, const BorderSample& b) const noexcept {
  return a.region != b.region || (charts_ != nullptr && charts_->isSmeared(a, b, length(b.closest - a.closest)));
}

/// Whether all points of a part whose nearest cage triangle is a certain one are surely in a region.
bool BorderClassifier::isSurelyIn(std::uint32_t region, std::uint32_t cageTriangle, Hull hull) const noexcept {
  if (charts_ != nullptr) return charts_->charts[cageTriangle] == region;
  const CageTriangle& t = cage_.cage.triangles[cageTriangle];
  return region == 0 ? cage_.loops.areSurelyOff(t, cageTriangle, hull, diagonal_)
                     : cage_.loops.areSurelyOn(t, cageTriangle, hull);
}

bool BorderClassifier::isSurelyIn(std::uint32_t region, NearbyTriangles nearby, Hull hull) noexcept {
  if (nearby.count == 0) return false;
  const std::uint32_t* begin = &listed_[nearby.first];
  return std::all_of(begin, begin + nearby.count, [&](std::uint32_t cageTriangle) {
    ++comparisons_;
    return isSurelyIn(region, cageTriangle, hull);
  });
}

bool BorderClassifier::isSurelyWhole(std::uint32_t region, NearbyTriangles nearby, Hull hull) noexcept {
  if (!isSurelyIn(region, nearby, hull)) return false;
  if (charts_ == nullptr) return true;
  if (nearby.count > kMaxPairwise) return false;
  // The texture around the point of each triangle that is closest to the centre. For another point of the part, the
  // closest point moves no farther than the point itself.
  struct Around {
    Vec3 closest;
    Uv uv;
    double fastest, stretch;
  };
  Around around[kMaxPairwise];
  const auto& [centre, radius] = Ball(hull);
  for (std::uint32_t i = 0; i < nearby.count; ++i) {
    const std::uint32_t cageTriangle = listed_[nearby.first + i];
    const CageTriangle& t = cage_.cage.triangles[cageTriangle];
    const ClosestPoint place = closestPointOf(t, centre);
    const Around& a =
        around[i] = {positionOf(t, place), uvAt(t, place), fastestChange(t), charts_->stretch[cageTriangle]};
    // Within one triangle, the stretch of its edges mostly explains the texture's change.
    if (a.fastest > kSmear * a.stretch && 2 * a.fastest * radius > kSmearSlack) return false;
    for (std::uint32_t j = 0; j < i; ++j) {
      const Around& b = around[j];
      const double apart = std::max(0.0, length(a.closest - b.closest) - 2 * radius);
      const double du = a.uv.u - b.uv.u, dv = a.uv.v - b.uv.v;
      if (std::sqrt(du * du + dv * dv) + (a.fastest + b.fastest) * radius >
          kSmear * std::max(a.stretch, b.stretch) * apart + kSmearSlack)
        return false;
    }
  }
  return true;
}

double BorderClassifier::clearance(const BorderSample& sample, Vec3 p) noexcept {
  if (charts_ != nullptr) return 0;
  const CageTriangle& t = cage_.cage.triangles[sample.cageTriangle];
  const std::uint32_t* index = cage_.mesh.indices.data() + std::size_t{3} * t.index;
  const float* corners[3] = {t.a, t.b, t.c};
  double toLoop = 0;  // A lower bound for p.
  for (std::uint32_t k = 0; k < 3; ++k) {
    double& known = clearances_[index[k]];
    const Vec3 corner = Vec3::from(corners[k]);
    if (known < 0) known = lines_.distance(corner);
    toLoop = std::max(toLoop, known - length(p - corner));
  }
  // Along a way from p both the distance to the loops and that to the cage change by at most its length. As long as the
  // former is greater, the closest point lies on no loop.
  return (toLoop - length(p - sample.closest)) / 2;
}

}  // namespace cagecast
