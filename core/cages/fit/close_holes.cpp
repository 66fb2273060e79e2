#include <algorithm>
#include <cmath>
#include <map>

#include "fit/steps.hpp"
#include "mesh/surface.hpp"
#include "views/base_color.hpp"

/// Holes with nothing behind them: a sculpture has no eyes to keep free, and closed lips of one piece no mouth.
namespace cagecast::cages {

namespace {

// Lengths in distances of both eyes.
constexpr double kOutward = 0.5;   ///< From a hole's border outward, what belongs to it: lips bulge out of theirs.
constexpr double kMaxDepth = 0.6;  ///< From a hole's border inward to the first thing seen, or it is an opening.
/// A second layer of skin is the lining of a mouth if it lies this far behind the first: nearer are creases, farther is
/// the back of the head, and what else lies there has nothing to do with the hole.
constexpr double kLayerFrom = 0.1, kLayerTo = 0.8;
constexpr int kLayers = 6;  ///< That a ray goes through, at most.
/// Places along each side of a hole, and how many must lie within it for a verdict.
constexpr int kPlaces = 24;
constexpr std::size_t kFewest = 8;
/// A ring around a hole, in sizes of the hole.
struct Ring {
  double from, to;
};
constexpr Ring kWithin{0, 1}, kAround{1.3, 2};
/// Where a second layer is that of a wall, as of a hollow bust, and no lining: in most places of it.
constexpr Ring kWall{2.2, 3};
constexpr double kWallShare = 0.5;
constexpr double kOtherColor = 12;   ///< How far another colour is, in CIELAB.
constexpr double kOtherShare = 0.1;  ///< Of a hole: what is less of it does not count.

double crossOf(const Flat& a, const Flat& b, const Flat& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether a point is within a polygon, by how often a line to the right meets it.
bool isWithin(const std::vector<Flat>& polygon, const Flat& p) {
  bool is = false;
  for (std::size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++) {
    const Flat &a = polygon[i], &b = polygon[k];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) is = !is;
  }
  return is;
}

/// A hole as it is seen from in front.
class HoleView {
 public:
  HoleView(const FaceHole& hole, const Axes& axes, const std::vector<Vec3>& positions) : axes_(axes) {
    for (const std::uint32_t v : hole.loop) {
      border_.push_back(flat(positions[v]));
      depths_.push_back(dot(positions[v], axes.front));
      middle_ = {middle_.x + border_.back().x, middle_.y + border_.back().y};
    }
    const double share = 1 / static_cast<double>(hole.loop.size());
    middle_ = {share * middle_.x, share * middle_.y};
  }

  /// How far a point is before the border.
  [[nodiscard]] double rise(const Vec3& p) const { return dot(p, axes_.front) - depthAt(flat(p)); }
  [[nodiscard]] bool has(const Vec3& p) const { return isWithin(border_, flat(p)); }

  /// Rays from before the face at the places of a grid that lie within a ring.
  [[nodiscard]] std::vector<SurfaceRay> rays(const Ring& ring, double before) const {
    const std::vector<Flat> inner = scaled(ring.from), outer = scaled(ring.to);
    Flat low = outer.front(), high = low;
    for (const Flat& p : outer) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    std::vector<SurfaceRay> out;
    for (int i = 0; i < kPlaces; ++i)
      for (int k = 0; k < kPlaces; ++k) {
        const Flat p{low.x + (i + 0.5) / kPlaces * (high.x - low.x), low.y + (k + 0.5) / kPlaces * (high.y - low.y)};
        if (!isWithin(outer, p) || isWithin(inner, p)) continue;
        out.push_back({p.x * axes_.left + p.y * axes_.up + (depthAt(p) + before) * axes_.front, -1.0 * axes_.front});
      }
    return out;
  }

 private:
  [[nodiscard]] Flat flat(const Vec3& p) const { return {dot(p, axes_.left), dot(p, axes_.up)}; }
  /// Between the depths of the border.
  [[nodiscard]] double depthAt(const Flat& p) const {
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < border_.size(); ++i) {
      const double x = p.x - border_[i].x, y = p.y - border_[i].y, weight = 1 / std::max(x * x + y * y, 1e-30);
      sum += weight * depths_[i];
      total += weight;
    }
    return sum / total;
  }
  [[nodiscard]] std::vector<Flat> scaled(double by) const {
    std::vector<Flat> out = border_;
    for (Flat& p : out) p = {middle_.x + by * (p.x - middle_.x), middle_.y + by * (p.y - middle_.y)};
    return out;
  }

  const Axes& axes_;
  std::vector<Flat> border_;
  std::vector<double> depths_;
  Flat middle_;
};

/// Whether names, or morph targets, say that there is an eye or a mouth.
bool isTold(const FaceHole& hole, const SeenModel& seen) {
  const std::vector<Landmark>& hints = seen.model.hints;
  return seen.figure.has(hole.isMouth ? Role::mouth : Role::eye) ||
         std::any_of(hints.begin(), hints.end(),
                     [&](const Landmark& hint) { return hint.name.starts_with("mouth") == hole.isMouth; });
}

/// Whether an open border of the surface lies within a hole.
bool hasOpening(const HoleView& view, double apart, const TriangleMesh& mesh,
                const std::vector<std::vector<std::uint32_t>>& openings) {
  for (const std::vector<std::uint32_t>& opening : openings)
    for (const std::uint32_t v : opening) {
      const double rise = view.rise(mesh.positions[v]);
      if (rise < kOutward * apart && rise > -kLayerTo * apart && view.has(mesh.positions[v])) return true;
    }
  return false;
}

/// The component that most rays meet first; `kNone` if they meet nothing.
std::uint32_t commonestOf(const std::vector<RayHit>& first, const SeenModel& seen) {
  std::map<std::uint32_t, std::size_t> counts;
  std::uint32_t best = kNone;
  for (const RayHit& hit : first) {
    if (std::isinf(hit.distance)) continue;
    const std::uint32_t component = seen.figure.components[hit.triangle];
    if (++counts[component] > counts[best]) best = component;
  }
  return best;
}

/// What rays into a hole may meet.
class Layers {
 public:
  /// @param skin  The component that is skin.
  /// @param withLining  Whether skin behind skin counts, as in a mouth; behind an eye it is the wall of a hollow bust.
  Layers(const SeenModel& seen, const Surface& surface, double apart, std::uint32_t skin, bool withLining)
      : seen_(seen), surface_(surface), apart_(apart), skin_(skin), withLining_(withLining) {}

  /// The share of rays that meet something other than skin, nothing near, or skin again behind skin.
  [[nodiscard]] double shareOf(const std::vector<SurfaceRay>& rays) const {
    const std::vector<RayHit> first = surface_.trace(rays);
    std::size_t others = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool isNear = first[i].distance < (kOutward + kMaxDepth) * apart_;
      if (!isNear || !isSkin(first[i]) || hasMoreBehind(rays[i], first[i].distance)) ++others;
    }
    return static_cast<double>(others) / static_cast<double>(std::max<std::size_t>(1, rays.size()));
  }

 private:
  [[nodiscard]] bool isSkin(const RayHit& hit) const {
    return seen_.figure.roles[hit.triangle] == Role::surface && seen_.figure.components[hit.triangle] == skin_;
  }

  /// Whether something other than skin lies behind the first layer, or a lining.
  [[nodiscard]] bool hasMoreBehind(const SurfaceRay& ray, double first) const {
    const double step = 1e-4 * apart_;
    double from = first + step;
    for (int layer = 1; layer < kLayers; ++layer) {
      const SurfaceRay rest{ray.origin + from * ray.direction, ray.direction};
      const RayHit hit = surface_.trace(std::span(&rest, 1))[0];
      const double behind = from + hit.distance - first;
      if (!(behind < kLayerTo * apart_)) return false;
      if (!isSkin(hit) || (withLining_ && behind > kLayerFrom * apart_)) return true;
      from += hit.distance + step;
    }
    return false;
  }

  const SeenModel& seen_;
  const Surface& surface_;
  double apart_;
  std::uint32_t skin_;
  bool withLining_;
};

/// The directions of a face, by its holes.
Axes axesOf(const std::vector<FaceHole>& holes, const TriangleMesh& cage) {
  const Vec3 left = middleOf(cage, holes[0].loop), right = middleOf(cage, holes[1].loop);
  Axes axes;
  axes.left = unit(left - right);
  const Vec3 rise = 0.5 * (left + right) - middleOf(cage, holes[2].loop);
  axes.up = unit(rise - dot(rise, axes.left) * axes.left);
  axes.front = cross(axes.left, axes.up);
  axes.known = length(axes.front) > 0;
  return axes;
}

/// The colours of what rays meet; empty if one of them is not known.
std::vector<Vec3> colorsOf(const std::vector<SurfaceRay>& rays, const std::vector<RayHit>& hits,
                           const SeenModel& seen) {
  const MeshView& mesh = seen.model.mesh;
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (std::isinf(hits[i].distance)) continue;
    const std::uint32_t triangle = seen.figure.triangleOf[hits[i].triangle];
    const std::size_t part = mesh.groups.empty() ? 0 : mesh.groups[mesh.indices[3 * std::size_t{triangle}]];
    const auto color =
        seen.model.baseColors[part].isKnown
            ? baseColorAt(seen.model, triangle, seen.toModel(rays[i].origin + hits[i].distance * rays[i].direction))
            : std::nullopt;
    if (!color) return {};
    out.push_back(*color);
  }
  return out;
}

/// Whether all of a hole looks about as what is around it.
bool isOneColor(const std::vector<Vec3>& within, const std::vector<Vec3>& around) {
  if (within.empty() || around.empty()) return false;
  std::vector<double> each[3];
  for (const Vec3& color : around)
    for (const auto& [list, value] : {std::pair{0, color.x}, {1, color.y}, {2, color.z}}) each[list].push_back(value);
  const Vec3 usual{medianOf(each[0]), medianOf(each[1]), medianOf(each[2])};
  const auto others = std::count_if(within.begin(), within.end(),
                                    [&](const Vec3& color) { return length(color - usual) > kOtherColor; });
  return static_cast<double>(others) <= kOtherShare * static_cast<double>(within.size());
}

}  // namespace

std::vector<bool> emptyHoles(const std::vector<FaceHole>& holes, const SeenModel& seen,
                             const std::vector<Vec3>& positions) {
  std::vector<bool> out(holes.size());
  if (seen.model.baseColors.empty() || holes.size() != 3) return out;
  const TriangleMesh cage{positions, {}};
  const Axes axes = axesOf(holes, cage);
  if (!axes.known) return out;
  const double apart = length(middleOf(cage, holes[0].loop) - middleOf(cage, holes[1].loop));
  const TriangleMesh& mesh = seen.figure.mesh;
  const Surface surface(mesh);
  const auto openings = boundaryLoops(mesh);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const HoleView view(holes[i], axes, positions);
    if (isTold(holes[i], seen) || hasOpening(view, apart, mesh, openings)) continue;
    const auto raysIn = [&](const Ring& ring) { return view.rays(ring, kOutward * apart); };
    const std::vector<SurfaceRay> within = raysIn(kWithin), around = raysIn(kAround);
    const std::uint32_t skin = commonestOf(surface.trace(around), seen);
    const Layers layers(seen, surface, apart, skin, holes[i].isMouth);
    const bool hasMore = layers.shareOf(within) > kOtherShare;
    const bool isWall = hasMore && holes[i].isMouth && layers.shareOf(raysIn(kWall)) > kWallShare;
    if (within.size() < kFewest || (hasMore && !isWall)) continue;
    out[i] = isOneColor(colorsOf(within, surface.trace(within), seen), colorsOf(around, surface.trace(around), seen));
  }
  return out;
}

std::vector<Triangle3> lidOf(const std::vector<Flat>& uvs) {
  std::vector<std::uint32_t> left(uvs.size());  // With the hole on its left.
  double area = 0;
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    left[i] = static_cast<std::uint32_t>(uvs.size()) - 1 - i;
    area += crossOf({0, 0}, uvs[i], uvs[(i + 1) % uvs.size()]);
  }
  const double side = area < 0 ? 1 : -1;
  std::vector<Triangle3> out;
  while (left.size() > 2) {
    // The best ear: the corner whose triangle is the least thin and has no other corner in it.
    std::size_t best = left.size();
    double most = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t before = (i + left.size() - 1) % left.size(), after = (i + 1) % left.size();
      const Flat &a = uvs[left[before]], &b = uvs[left[i]], &c = uvs[left[after]];
      const double twice = side * crossOf(a, b, c);
      if (!(twice > 0)) continue;
      const bool isFree = std::none_of(left.begin(), left.end(), [&](std::uint32_t k) {
        const Flat& p = uvs[k];
        return k != left[before] && k != left[i] && k != left[after] && side * crossOf(a, b, p) >= 0 &&
               side * crossOf(b, c, p) >= 0 && side * crossOf(c, a, p) >= 0;
      });
      const double longest = std::max(
          {std::hypot(b.x - a.x, b.y - a.y), std::hypot(c.x - b.x, c.y - b.y), std::hypot(a.x - c.x, a.y - c.y)});
      if (!isFree || twice / (longest * longest) <= most) continue;
      most = twice / (longest * longest);
      best = i;
    }
    if (best == left.size()) return {};
    const std::size_t before = (best + left.size() - 1) % left.size(), after = (best + 1) % left.size();
    out.push_back({left[before], left[best], left[after]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return out;
}

}  // namespace cagecast::cages
