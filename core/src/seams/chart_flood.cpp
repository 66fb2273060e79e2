#include "seams/chart_flood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cage/boundary_loops.hpp"

namespace cagecast {

ChartFlood::ChartFlood(const Scene& scene, const UvCharts& charts) noexcept
    : cage_(scene.cage),
      tree_(scene.cageTree),
      charts_(charts),
      fixedSlack_(fixedSlack(slackOf(scene.cageTree, scene.units.diagonal), kRelativeSlack)),
      candidateRoom_(kCandidateRoom + 3 * scene.cage.count) {
  const std::size_t count = cage_.count;
  Arena& arena = scene.arena;
  triangles_ = arena.allocate<FlatTriangles<1>>(count);
  patches_ = arena.allocate<ChartPatch>(kMaxPatches);
  groups_ = arena.allocate<Group>(kMaxGroups);
  candidates_ = arena.allocate<PatchCandidate>(candidateRoom_);
  queue_ = arena.allocate<std::uint32_t>(count + 1);  // One more, which `flood` may write and not keep.
  members_ = arena.allocate<std::uint32_t>(count);
  squares_ = arena.allocate<float>(ChartPatch::kPoints * count);
  outside_ = arena.allocate<OutOfReach>(count);
  met_ = arena.allocate<std::uint32_t>(count);
  edgeMet_ = arena.allocate<std::uint32_t>(3 * count);
  if (arena.failed()) return;
  std::fill_n(met_, count, 0u);
  std::fill_n(edgeMet_, 3 * count, 0u);
  for (std::uint32_t i = 0; i < count; ++i)
    triangles_[tree_.leaves[i / 4].cageTriangles[i % 4]] = triangleOf(tree_.leaves[i / 4], i % 4);
}

ChartPatch& ChartFlood::add(Corner* const (&corners)[3], int k, double reach, std::uint8_t (&inGroup)[3]) noexcept {
  Group& group = groupWith(corners, k, inGroup);
  ChartPatch** at = &group.narrowest;
  while (*at != nullptr && (*at)->reach < reach) at = &(*at)->wider;
  if (*at != nullptr && (*at)->reach == reach) return **at;
  ChartPatch& patch = patches_[patchCount_++];
  patch.reach = reach;
  patch.candidates = nullptr;
  patch.wider = *at;
  *at = &patch;
  return patch;
}

/// Finds or adds a group around the closest point of corner k that has the other two corners among its points.
ChartFlood::Group& ChartFlood::groupWith(Corner* const (&corners)[3], int k, std::uint8_t (&inGroup)[3]) noexcept {
  Corner& own = *corners[k];
  const bool isKnown = own.group < groupCount_ && groups_[own.group].points[kCentre] == own.point;
  Group* group = isKnown ? groups_ + own.group : &addGroup(own);
  inGroup[k] = kCentre;
  for (;;) {
    std::uint32_t count = group->count;
    for (int c = 0; c < 3; ++c) {
      if (c == k) continue;
      std::uint32_t at = count;  // A point that is not in the group yet gets the next free number.
      for (std::uint32_t i = kCentre + 1; i < ChartPatch::kPoints; ++i)
        at = group->points[i] == corners[c]->point ? i : at;
      inGroup[c] = static_cast<std::uint8_t>(at);
      count = std::max(count, at + 1);
    }
    if (count <= ChartPatch::kPoints) {
      for (int c = 0; c < 3; ++c) {
        if (c != k) setPoint(*group, inGroup[c], *corners[c]);
      }
      group->count = count;
      return *group;
    }
    group = &addGroup(own);
  }
}

ChartFlood::Group& ChartFlood::addGroup(Corner& own) noexcept {
  own.group = groupCount_++;
  Group& group = groups_[own.group];
  group.cageTriangle = own.closest.cageTriangle;
  group.centre = positionOf(cage_.triangles[group.cageTriangle], own.closest.point);
  const double centre[3] = {group.centre.x, group.centre.y, group.centre.z};
  // Unused points lie at the centre, so that the kernel has numbers to work on.
  for (int axis = 0; axis < 3; ++axis)
    std::fill_n(group.positions[axis], ChartPatch::kPoints, static_cast<float>(centre[axis]) - tree_.centre[axis]);
  std::fill_n(group.points, ChartPatch::kPoints, UINT32_MAX);
  group.points[kCentre] = own.point;
  group.count = kCentre + 1;
  group.narrowest = nullptr;
  return group;
}

void ChartFlood::setPoint(Group& group, std::uint32_t at, const Corner& corner) const noexcept {
  group.points[at] = corner.point;
  for (int axis = 0; axis < 3; ++axis) group.positions[axis][at] = corner.position[axis] - tree_.centre[axis];
}

void ChartFlood::grow() noexcept {
  while (grownGroups_ < groupCount_ && growGroup(groups_[grownGroups_])) ++grownGroups_;
}

/// @return false if there is no room for the candidates of all its patches.
bool ChartFlood::growGroup(const Group& group) noexcept {
  ++mark_;
  queueEnd_ = memberCount_ = outsideCount_ = 0;
  for (simd::f32x4& least : least_) least = simd::splat(std::numeric_limits<float>::max());
  const ChartPatch* narrower = nullptr;
  for (ChartPatch* patch = group.narrowest; patch != nullptr; patch = patch->wider) {
    const double limit = patch->reach + roundingAt(group, patch->reach);
    if (narrower != nullptr) requeueWithin(static_cast<float>(limit * limit));
    flood(group, patch->reach);
    patch->triangleCount = memberCount_;
    if (narrower != nullptr && narrower->triangleCount == memberCount_) {
      patch->candidates = narrower->candidates;
      patch->candidateCount = narrower->candidateCount;
      std::copy_n(narrower->leastSquared, ChartPatch::kPoints, patch->leastSquared);
    } else if (!listCandidates(group, *patch)) {
      return false;
    }
    narrower = patch;
  }
  return true;
}

/// How much a float distance from the centre of a group may be off, for distances about as long as the reach.
double ChartFlood::roundingAt(const Group& group, double reach) const noexcept {
  const Vec3& c = group.centre;
  return 2 * kRounding * (tree_.extent + reach + std::abs(c.x) + std::abs(c.y) + std::abs(c.z));
}

/// Queues the triangles again that were out of reach and are not surely out of a wider one.
/// @param limit  Squared distance.
void ChartFlood::requeueWithin(float limit) noexcept {
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < outsideCount_; ++i) {
    if (outside_[i].squared <= limit) {
      queue_[queueEnd_++] = outside_[i].cageTriangle;
    } else {
      outside_[left++] = outside_[i];
    }
  }
  outsideCount_ = left;
}

/// Calls `visit` with the triangles that share an edge in UV with this one: once per edge, however many share it.
template <typename Visit>
void ChartFlood::visitFans(std::uint32_t cageTriangle, Visit visit) noexcept {
  for (std::uint32_t halfEdge = 3 * cageTriangle; halfEdge < 3 * cageTriangle + 3; ++halfEdge) {
    if (edgeMet_[halfEdge] == mark_) continue;
    for (std::uint32_t other = charts_.nextHalfEdge[halfEdge]; other != halfEdge; other = charts_.nextHalfEdge[other]) {
      edgeMet_[other] = mark_;
      visit(other / 3);
    }
  }
}

/// Visits the queued triangles, adds those within reach to the members and queues their neighbours.
void ChartFlood::flood(const Group& group, double reach) noexcept {
  const double rounding = roundingAt(group, reach);
  const double inner = std::max(0.0, reach - rounding), outer = reach + rounding;
  const auto surelyWithin = static_cast<float>(inner * inner);
  const auto perhapsWithin = static_cast<float>(outer * outer);
  simd::f32x4 x[kVectors], y[kVectors], z[kVectors];
  for (std::uint32_t v = 0; v < kVectors; ++v) {
    x[v] = simd::load(group.positions[0] + simd::kWidth * v);
    y[v] = simd::load(group.positions[1] + simd::kWidth * v);
    z[v] = simd::load(group.positions[2] + simd::kWidth * v);
  }
  // Locals: the stores below may alias members, and the compiler would reload those for every triangle.
  std::uint32_t* const queue = queue_;
  std::uint32_t* const met = met_;
  const std::uint32_t mark = mark_;
  std::uint32_t end = queueEnd_, memberCount = memberCount_, outsideCount = outsideCount_;
  const auto enqueue = [&](std::uint32_t t) {
    // Without a branch, as it could not be predicted: a triangle met before is overwritten by the next.
    queue[end] = t;
    end += met[t] != mark;
    met[t] = mark;
  };
  if (memberCount == 0) enqueue(group.cageTriangle);
  for (std::uint32_t i = 0; i < end; ++i) {
    const std::uint32_t t = queue[i];
    const FlatTriangles<1>& triangle = triangles_[t];
    const simd::f32x4 squared = squaredDistances(triangle, x[0], y[0], z[0]);
    const float toCentre = simd::lane<0>(squared);
    // The centre lies on its own triangle, even if that is a needle, whose distance in floats is arbitrary.
    bool isWithin = toCentre <= surelyWithin || t == group.cageTriangle;
    if (!isWithin && toCentre <= perhapsWithin)
      isWithin = closestPointOnTriangle(cage_.triangles[t], group.centre).distance <= reach;
    if (!isWithin) {
      outside_[outsideCount++] = {t, toCentre};
      continue;
    }
    float* const squares = squares_ + std::size_t{ChartPatch::kPoints} * memberCount;
    members_[memberCount++] = t;
    simd::store(squares, squared);
    least_[0] = simd::min(least_[0], squared);
    for (std::uint32_t v = 1; v < group.vectors(); ++v) {
      const simd::f32x4 more = squaredDistances(triangle, x[v], y[v], z[v]);
      simd::store(squares + simd::kWidth * v, more);
      least_[v] = simd::min(least_[v], more);
    }
    const ChartNeighbours& neighbours = charts_.neighbours[t];
    for (const std::uint32_t neighbour : neighbours.triangles) enqueue(neighbour);
    if (neighbours.hasFan != 0) visitFans(t, enqueue);
  }
  queueEnd_ = 0;
  memberCount_ = memberCount;
  outsideCount_ = outsideCount;
}

/// Lists the members that may be the nearest to any point of the group but the centre.
/// @return false if there is no room.
bool ChartFlood::listCandidates(const Group& group, ChartPatch& patch) noexcept {
  if (candidateRoom_ - candidateCount_ < memberCount_) return false;
  simd::f32x4 limits[kVectors];
  for (std::uint32_t v = 0; v < group.vectors(); ++v) {
    simd::store(patch.leastSquared + simd::kWidth * v, least_[v]);
    limits[v] = least_[v] * simd::splat(1 + static_cast<float>(kRelativeSlack)) + simd::splat(fixedSlack_);
  }
  PatchCandidate* const candidates = candidates_ + candidateCount_;
  const unsigned corners = (1u << group.count) - (2u << kCentre);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < memberCount_; ++i) {
    const float* const squares = squares_ + std::size_t{ChartPatch::kPoints} * i;
    unsigned points = 0;
    for (std::uint32_t v = 0; v < group.vectors(); ++v)
      points |= simd::bits(simd::load(squares + simd::kWidth * v) <= limits[v]) << simd::kWidth * v;
    candidates[count] = {members_[i], points};
    count += (points & corners) != 0;
  }
  patch.candidates = candidates;
  patch.candidateCount = count;
  candidateCount_ += count;
  return true;
}

}  // namespace cagecast
