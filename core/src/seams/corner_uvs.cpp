#include "seams/corner_uvs.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cage/uv_charts.hpp"
#include "geometry/closest_point.hpp"
#include "seams/chart_flood.hpp"
#include "search/near_kernel.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 9: how far from a corner's place its patch reaches, in longest edges and in shares of the
/// diagonal.
constexpr double kPatchEdges = 1.5;
constexpr double kPatchSlack = 0.01;
/// docs/method.md, step 9: sums of distances within this share of the diagonal are equal.
constexpr double kTieSum = 1e-7;

/// UVs up to here are exact enough as floats for a first look: they are off by a hundredth of the slack at most.
constexpr float kMostUv = 256;
/// What the first look allows of the squares of the explained length and of the slack: less than the exact limit, which
/// is the square of their sum, by more than floats round.
constexpr double kFirstLook = 0.99 * kSmear * kSmear;
constexpr double kFirstSlack = 0.9 * kSmearSlack * kSmearSlack;

/// What the first look knows of a triangle of the cage,
struct OfTriangle {
  float explains;  ///< Squared UV length per squared length.
  float island;    ///< The number.
};
/// and of the place of a point of the target.
struct alignas(16) FirstLook {
  float u, v;
  OfTriangle on;
};
/// Numbers up to here are exact as floats.
constexpr std::uint32_t kMostIslands = 1u << 24;

/// Mends triangles across seams, many at a time.
class SeamResolver {
 public:
  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  SeamResolver(const Cage& cage, const CageTree& tree, const UvCharts& charts, double diagonal, Arena& arena) noexcept
      : cage_(cage),
        tree_(tree),
        charts_(charts),
        diagonal_(diagonal),
        patches_(cage, tree, charts, diagonal, arena),
        candidates_(arena.allocate<Candidate>(cage.count)),
        corners_(arena.allocate<Corner>(kMostCorners)),
        knowns_(arena.allocate<Known>(kMostCorners)),
        recent_(arena.allocate<std::uint32_t>(kRecent)),
        torn_(arena.allocate<Torn>(kMostTorn)) {
    for (auto& near : near_) near = arena.allocate<std::uint32_t>(std::size_t{cage.count} + 1);
    if (arena.failed()) return;
    std::fill(recent_, recent_ + kRecent, 0u);
  }

  /// Mends a triangle if the texture is torn or smeared over it; at the latest when `mend` is called.
  /// @param[out] uvs  6 floats.
  void add(const Points& points, const PointResults& results, const std::uint32_t* point, float* uvs) noexcept {
    if (cornerCount_ + 3 > kMostCorners || tornCount_ == kMostTorn) mend();
    Torn& torn = torn_[tornCount_];
    for (int c = 0; c < 3; ++c) {
      std::uint32_t& i = recent_[point[c] % kRecent];
      if (i >= cornerCount_ || corners_[i].point != point[c]) {
        i = cornerCount_++;
        setCorner(corners_[i], point[c], points.at(point[c]), results.triangles[point[c]]);
      }
      torn.corners[c] = corners_ + i;
    }
    torn.uvs = uvs;
    if (isAcross(torn.corners)) ++tornCount_;
  }

  /// Mends all that were added.
  void mend() noexcept {
    Torn* const end = torn_ + tornCount_;
    std::ptrdiff_t most = kMostTorn;
    for (Torn* torn = torn_; torn < end;) {
      patches_.clear();
      Torn* const first = torn;
      Torn* next = torn;
      do {
        addPatches(*next++);
      } while (next < end && next - first < most && patches_.hasRoom());
      patches_.grow();
      while (torn < next && hasGrown(*torn)) choose(*torn++);
      // There is always room for one. Where there was not for all, there will hardly be for more than there was.
      if (torn < next) most = std::max<std::ptrdiff_t>(torn - first, 1);
    }
    tornCount_ = cornerCount_ = 0;
  }

 private:
  static constexpr std::uint32_t kMostTorn = ChartFlood::kMostTriangles;
  /// Triangles often share corners; some turn out not to be torn, and leave theirs.
  static constexpr std::uint32_t kMostCorners = 2 * kMostTorn;
  static constexpr std::uint32_t kRecent = 4096;

  /// A triangle across a seam.
  struct Torn {
    Corner* corners[3];
    float* uvs;
    Patch* patches[3];           ///< Around each corner's place; null where an earlier one is on the same triangle.
    std::uint8_t inGroup[3][3];  ///< For each patch: which of its group's points the corners are.
  };
  /// Places of a corner that were decided already: patches have most of them in common.
  struct Known {
    static constexpr std::uint32_t kMost = 2;
    std::uint32_t count;
    Candidate places[kMost];
  };
  /// The corners' places on one patch.
  struct Choice {
    double sum;  ///< Of the distances.
    float uvs[6];
  };

  /// Finds the place of a point of the target on the triangle that it is nearest to.
  void setCorner(Corner& corner, std::uint32_t point, const float* position, std::uint32_t t) const noexcept {
    corner.point = point;
    corner.group = 0;
    corner.position = position;
    corner.p = Vec3::from(position);
    setPlace(cage_, corner.p, t, corner.at);
    corner.uv = uvOf(corner.at);
    knowns_[&corner - corners_].count = 0;
  }

  /// Whether the texture is torn or smeared over a triangle, in double.
  [[nodiscard]] bool isAcross(const Corner* const (&corners)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      const Corner& a = *corners[k];
      const Corner& b = *corners[(k + 1) % 3];
      const Landing from{a.at.slot, a.at.place.distance, a.uv};
      const Landing to{b.at.slot, b.at.place.distance, b.uv};
      if (charts_.tears(from, to, length(b.p - a.p))) return true;
    }
    return false;
  }

  void addPatches(Torn& torn) noexcept {
    Corner* const(&corners)[3] = torn.corners;
    double longest = 0;  // Squared.
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = corners[(k + 1) % 3]->p - corners[k]->p;
      longest = std::max(longest, dot(edge, edge));
    }
    const double reach = kPatchEdges * std::sqrt(longest) + kPatchSlack * diagonal_;
    for (int k = 0; k < 3; ++k) {
      const bool isKnown =
          std::any_of(corners, corners + k, [&](const Corner* c) { return c->at.slot == corners[k]->at.slot; });
      torn.patches[k] = isKnown ? nullptr : &patches_.add(corners, k, reach, torn.inGroup[k]);
    }
  }

  [[nodiscard]] static bool hasGrown(const Torn& torn) noexcept {
    return std::none_of(torn.patches, torn.patches + 3,
                        [](const Patch* patch) { return patch != nullptr && patch->near == nullptr; });
  }

  /// Projects the corners onto the patch around that one of them which brings all of them nearest.
  void choose(const Torn& torn) noexcept {
    // In float first: which of the patches might.
    double sums[3];
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      sums[k] = sumOf(torn, k);
      least = std::min(least, sums[k]);
    }
    const double unsure = kTieSum * diagonal_ + 6 * (kTieDistance * diagonal_ + kRounding * (tree_.extent + least));
    Choice choices[3];
    int count = 0;
    const double limit = least + unsure;
    least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      if (sums[k] > limit) continue;
      project(torn, k, choices[count]);
      least = std::min(least, choices[count++].sum);
    }
    int chosen = 0;
    while (choices[chosen].sum > least + kTieSum * diagonal_) ++chosen;
    std::copy_n(choices[chosen].uvs, 6, torn.uvs);
  }

  /// Of the corners' distances to a patch, in float.
  static double sumOf(const Torn& torn, int k) noexcept {
    const Patch* const patch = torn.patches[k];
    if (patch == nullptr) return std::numeric_limits<double>::infinity();
    const auto distance = [&](int c) { return std::sqrt(static_cast<double>(patch->least[torn.inGroup[k][c]])); };
    return torn.corners[k]->at.place.distance + distance((k + 1) % 3) + distance((k + 2) % 3);
  }

  /// Projects the corners onto the patch around corner k: step 1 once more, with the patch for a cage. Those whose
  /// triangle it has stay where they are.
  void project(const Torn& torn, int k, Choice& out) noexcept {
    const Patch& patch = *torn.patches[k];
    std::uint32_t counts[3] = {};
    unsigned keeps[3] = {1, 0, 0};
    for (std::uint32_t i = 0; i < patch.nearCount; ++i) {
      const auto [triangle, points] = patch.near[i];
      for (int c = 1; c < 3; ++c) {
        near_[c - 1][counts[c]] = triangle;
        counts[c] += points >> torn.inGroup[k][(k + c) % 3] & 1;
        keeps[c] |= unsigned{triangle == torn.corners[(k + c) % 3]->at.slot};
      }
    }
    out.sum = 0;
    for (int c = 0; c < 3; ++c) {
      const Corner& corner = *torn.corners[(k + c) % 3];
      const Candidate& at = keeps[c] != 0 ? corner.at : nearestTo(corner, near_[c - 1], counts[c]);
      out.sum += at.place.distance;
      simd::storeRounded(out.uvs + 2 * ((k + c) % 3), blendUvs(cage_.triangles[at.slot], at.place));
    }
  }

  /// Projects a corner onto a patch.
  /// @param near  What of it might be the nearest.
  [[nodiscard]] const Candidate& nearestTo(const Corner& corner, const std::uint32_t* near,
                                           std::uint32_t count) const noexcept {
    const Candidate& only = placeOf(corner, near[0], candidates_[0]);
    if (count == 1) return only;
    // Copied only if there are several.
    candidates_[0] = only;
    for (std::uint32_t i = 1; i < count; ++i) candidates_[i] = placeOf(corner, near[i], candidates_[i]);
    return nearestOf(candidates_, count, diagonal_);
  }

  [[nodiscard]] Uv uvOf(const Candidate& at) const noexcept { return uvAt(cage_.triangles[at.slot], at.place); }

  /// @param spare  Where to put the place if too many are known.
  [[nodiscard]] const Candidate& placeOf(const Corner& corner, std::uint32_t t, Candidate& spare) const noexcept {
    Known& known = knowns_[&corner - corners_];
    for (std::uint32_t i = 0; i < known.count; ++i) {
      if (known.places[i].slot == t) return known.places[i];
    }
    Candidate& place = known.count < Known::kMost ? known.places[known.count++] : spare;
    setPlace(cage_, corner.p, t, place);
    return place;
  }

  const Cage& cage_;
  const CageTree& tree_;
  const UvCharts& charts_;
  double diagonal_;
  ChartFlood patches_;
  Candidate* candidates_;   ///< Places on what might be nearest to one corner.
  std::uint32_t* near_[2];  ///< What of a patch might be nearest to each of two corners.
  Corner* corners_;
  Known* knowns_;          ///< Of each corner.
  std::uint32_t* recent_;  ///< By the last bits of a point's number: which corner may be of that point.
  Torn* torn_;
  std::uint32_t cornerCount_ = 0, tornCount_ = 0;
};

}  // namespace

bool findCornerUvs(const MeshView& targetMesh, const Points& points, const Cage& cage, const HalfEdges& edges,
                   const CageTree& tree, const Units& units, const PointResults& results, Arena& arena,
                   float* cornerUvs) noexcept {
  const Arena::Mark mark = arena.mark();
  UvCharts charts;
  if (!findUvCharts(cage, edges, arena, charts)) return false;
  SeamResolver mender(cage, tree, charts, units.diagonal, arena);
  auto* ofTriangle = arena.allocate<OfTriangle>(cage.count);
  auto* looks = arena.allocate<FirstLook>(points.count);
  if (arena.failed()) return false;

  const std::size_t allTriangles = targetMesh.indices.size() / 3;
  // The points of all triangles, also of those without an area.
  const std::uint32_t* corners = points.triangles;
  if (points.triangleCount < allTriangles) {
    auto* ofAll = arena.allocate<std::uint32_t>(targetMesh.indices.size());
    if (arena.failed()) return false;
    for (std::size_t i = 0; i < targetMesh.indices.size(); ++i) ofAll[i] = points.ofVertex[targetMesh.indices[i]];
    corners = ofAll;
  }

  // A first look in float: most triangles are clearly whole in the texture.
  const bool looksTell = charts.mostUv <= kMostUv && cage.count <= kMostIslands;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    // Below infinity, so that a product with it stays a number.
    const double explained = std::min(kFirstLook * charts.stretch[t] * charts.stretch[t], 1e30);
    ofTriangle[t] = {looksTell ? static_cast<float>(explained) : -std::numeric_limits<float>::infinity(),
                     static_cast<float>(charts.islands[t])};
  }
  for (std::uint32_t i = 0; i < points.count; ++i) {
    looks[i] = {results.uvs[2 * i], results.uvs[2 * i + 1], ofTriangle[results.triangles[i]]};
  }
  // Of each triangle four bits, all of them set if it is whole; two triangles at a time where there are eight lanes.
  const float* const positions = points.positions;
  const auto areWhole = [looks, positions](const std::uint32_t(&point)[simd::kParts][3]) {
    const simd::wide zero = simd::splatWide(0);
    // First by edge, then by axis: how far it goes, how far in UV, what the more stretched of its ends explains, and
    // from island to island.
    simd::wide lengths[4], inUv[4];
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const auto place = [&](int corner) {
        return simd::loadParts([&](int part) { return positions + Points::kStride * point[part][corner]; });
      };
      const auto look = [&](int corner) {
        return simd::loadParts([&](int part) { return &looks[point[part][corner]].u; });
      };
      lengths[k] = place(l) - place(k);
      inUv[k] = simd::withLane<2>(look(l) - look(k), simd::max(look(k), look(l)));
    }
    lengths[3] = inUv[3] = zero;
    auto& [x, y, z, unused] = lengths;
    auto& [u, v, explains, islands] = inUv;
    simd::transpose(x, y, z, unused);
    simd::transpose(u, v, explains, islands);
    const simd::wide squared = simd::multiplyAdd(z, z, simd::multiplyAdd(y, y, x * x));
    const simd::wide limit = simd::multiplyAdd(explains, squared, simd::splatWide(static_cast<float>(kFirstSlack)));
    const simd::wide squaredInUv = simd::multiplyAdd(v, v, u * u);
    return simd::bits((squaredInUv <= limit) & (islands * islands <= zero));
  };
  for (std::size_t first = 0; first < allTriangles; first += simd::kParts) {
    std::uint32_t point[simd::kParts][3];
    for (std::size_t part = 0; part < simd::kParts; ++part) {
      const std::size_t corner = 3 * std::min(first + part, allTriangles - 1);
      for (std::size_t c = 0; c < 3; ++c) {
        point[part][c] = corners[corner + c];
        std::memcpy(cornerUvs + 2 * (corner + c), looks + point[part][c], 2 * sizeof(float));
      }
    }
    const unsigned whole = areWhole(point);
    if (whole == (1u << simd::kWide) - 1) continue;
    for (std::size_t part = 0; part < simd::kParts && first + part < allTriangles; ++part) {
      if ((whole >> 4 * part & 0xF) == 0xF) continue;
      const std::uint32_t* const torn = corners + 3 * (first + part);
      const Vec3 normal = areaNormal(points.at(torn[0]), points.at(torn[1]), points.at(torn[2]));
      if (dot(normal, normal) > 0) mender.add(points, results, torn, cornerUvs + 6 * (first + part));
    }
  }
  mender.mend();
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
