#include "seams/seam_resolver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cagecast {
namespace {

/// docs/method.md, step 12: the reach of a patch, as a multiple of the triangle's longest edge plus a share of the
/// diagonal.
constexpr double kPatchEdges = 1.5;
constexpr double kPatchSlack = 0.01;
/// docs/method.md, step 12: sums of distances whose difference is within this share of the diagonal are equal.
constexpr double kTieSum = 1e-7;

/// The sum of the corners' distances to the patch around corner k, in float precision; infinity if there is no patch.
double roughSum(Corner* const (&corners)[3], const ChartPatch* patch, const std::uint8_t (&inGroup)[3], int k) {
  if (patch == nullptr) return std::numeric_limits<double>::infinity();
  const auto distance = [&](int c) { return std::sqrt(static_cast<double>(patch->leastSquared[inGroup[c]])); };
  return corners[k]->closest.point.distance + distance((k + 1) % 3) + distance((k + 2) % 3);
}

}  // namespace

SeamResolver::SeamResolver(const Scene& scene, const UvCharts& charts) noexcept
    : cage_(scene.cage),
      tree_(scene.cageTree),
      charts_(charts),
      diagonal_(scene.units.diagonal),
      flood_(scene, charts),
      candidates_(scene.arena.allocate<Candidate>(scene.cage.count)),
      corners_(scene.arena.allocate<Corner>(kMaxCorners)),
      recent_(scene.arena.allocate<std::uint32_t>(kRecent)),
      queue_(scene.arena.allocate<Queued>(kMaxTriangles)) {
  if (!scene.arena.failed()) std::fill_n(recent_, kRecent, 0u);
}

void SeamResolver::add(const PointData& data, const std::uint32_t* triangle, float* uvs) noexcept {
  if (cornerCount_ + 3 > kMaxCorners || queuedCount_ == kMaxTriangles) finish();
  Queued& queued = queue_[queuedCount_];
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t point = triangle[c];
    std::uint32_t& i = recent_[point % kRecent];
    if (i >= cornerCount_ || corners_[i].point != point) {
      i = cornerCount_++;
      setCorner(corners_[i], point, data.points.at(point), data.cageTriangles[point]);
    }
    queued.corners[c] = corners_ + i;
  }
  queued.uvs = uvs;
  if (isAcrossSeam(queued.corners)) ++queuedCount_;
}

void SeamResolver::finish() noexcept {
  std::uint32_t limit = kMaxTriangles;
  for (std::uint32_t done = 0; done < queuedCount_;) {
    flood_.clear();
    std::uint32_t end = done;
    while (end < queuedCount_ && end - done < limit && (end == done || flood_.hasRoom())) addPatches(queue_[end++]);
    flood_.grow();
    const auto hasGrown = [](const ChartPatch* patch) { return patch == nullptr || patch->candidates != nullptr; };
    const std::uint32_t first = done;
    while (done < end && std::all_of(queue_[done].patches, queue_[done].patches + 3, hasGrown)) choose(queue_[done++]);
    // Memory for candidates ran short: fewer triangles at a time from here on. It is enough for one.
    if (done < end) limit = std::max(done - first, 1u);
  }
  queuedCount_ = cornerCount_ = 0;
}

/// Finds the closest point of a target point on its nearest cage triangle.
void SeamResolver::setCorner(Corner& corner, std::uint32_t point, const float* position,
                             std::uint32_t cageTriangle) const noexcept {
  corner.point = point;
  corner.group = 0;
  corner.position = position;
  corner.p = Vec3::from(position);
  const CageTriangle& triangle = cage_.triangles[cageTriangle];
  corner.closest = {cageTriangle, closestPointOnTriangle(triangle, corner.p)};
  corner.uv = uvAt(triangle, corner.closest.point);
}

/// Whether a seam separates any two corners, in double.
bool SeamResolver::isAcrossSeam(const Corner* const (&corners)[3]) const noexcept {
  for (int k = 0; k < 3; ++k) {
    const Corner& a = *corners[k];
    const Corner& b = *corners[(k + 1) % 3];
    const UvSample from{a.closest.cageTriangle, a.closest.point.distance, a.uv};
    const UvSample to{b.closest.cageTriangle, b.closest.point.distance, b.uv};
    if (charts_.separates(from, to, length(b.p - a.p))) return true;
  }
  return false;
}

void SeamResolver::addPatches(Queued& queued) noexcept {
  Corner* const(&corners)[3] = queued.corners;
  double longestSquared = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3]->p - corners[k]->p;
    longestSquared = std::max(longestSquared, dot(edge, edge));
  }
  const double reach = kPatchEdges * std::sqrt(longestSquared) + kPatchSlack * diagonal_;
  for (int k = 0; k < 3; ++k) {
    const bool isKnown = std::any_of(corners, corners + k, [&](const Corner* c) {
      return c->closest.cageTriangle == corners[k]->closest.cageTriangle;
    });
    queued.patches[k] = isKnown ? nullptr : &flood_.add(corners, k, reach, queued.inGroup[k]);
  }
}

/// Writes the UVs of a triangle: its corners projected onto the patch with the least sum of distances.
void SeamResolver::choose(const Queued& queued) noexcept {
  // In float first: which of the patches may have the least sum.
  double sums[3];
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    sums[k] = roughSum(queued.corners, queued.patches[k], queued.inGroup[k], k);
    least = std::min(least, sums[k]);
  }
  const double slack = kTieSum * diagonal_ + 6 * (kTieDistance * diagonal_ + kRounding * (tree_.extent + least));
  const double limit = least + slack;
  Projected projected[3];
  int count = 0;
  least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (sums[k] > limit) continue;
    projectOnto(queued, k, projected[count]);
    least = std::min(least, projected[count++].sum);
  }
  int chosen = 0;
  while (projected[chosen].sum > least + kTieSum * diagonal_) ++chosen;
  std::copy_n(projected[chosen].uvs, 6, queued.uvs);
}

/// Projects the corners onto the patch around the closest point of corner k: step 1, with the patch as the cage.
void SeamResolver::projectOnto(const Queued& queued, int k, Projected& out) noexcept {
  out.sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int c = (k + i) % 3;
    const Corner& corner = *queued.corners[c];
    const Candidate& closest =
        i == 0 ? corner.closest : closestOnPatch(corner, *queued.patches[k], queued.inGroup[k][c]);
    out.sum += closest.point.distance;
    const Uv uv = uvAt(cage_.triangles[closest.cageTriangle], closest.point);
    out.uvs[2 * c] = static_cast<float>(uv.u);
    out.uvs[2 * c + 1] = static_cast<float>(uv.v);
  }
}

/// Finds the closest point of a patch. A corner whose nearest cage triangle is in the patch keeps its closest point.
/// @param inGroup  The corner's number among the points of the patch's group.
const Candidate& SeamResolver::closestOnPatch(const Corner& corner, const ChartPatch& patch,
                                              std::uint32_t inGroup) noexcept {
  const PatchCandidate* const end = patch.candidates + patch.candidateCount;
  std::uint32_t count = 0;
  for (const PatchCandidate* candidate = patch.candidates; candidate < end; ++candidate) {
    if (candidate->cageTriangle == corner.closest.cageTriangle) return corner.closest;
    candidates_[count].cageTriangle = candidate->cageTriangle;
    count += candidate->points >> inGroup & 1;
  }
  for (std::uint32_t i = 0; i < count; ++i)
    candidates_[i].point = closestPointOnTriangle(cage_.triangles[candidates_[i].cageTriangle], corner.p);
  return count == 1 ? candidates_[0] : nearestOf(candidates_, count, diagonal_);
}

}  // namespace cagecast
