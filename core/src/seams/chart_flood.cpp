#include "seams/chart_flood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cage/boundary_loops.hpp"

namespace cagecast {

void setPlace(const Cage& cage, const Vec3& p, std::uint32_t t, Candidate& out) noexcept {
  out.slot = t;
  out.place = closestPointOnTriangle(cage.triangles[t], p);
}

ChartFlood::ChartFlood(const Cage& cage, const CageTree& tree, const UvCharts& charts, double diagonal,
                       Arena& arena) noexcept
    : cage_(cage),
      tree_(tree),
      charts_(charts),
      fixedSlack_(fixedSlack(slackOf(tree, diagonal), kRelativeSlack)),
      rows_(arena.allocate<NearTriangle>(cage.count)),
      patches_(arena.allocate<Patch>(kMostPatches)),
      groups_(arena.allocate<Group>(kMostGroups)),
      near_(arena.allocate<NearPoints>(kRoom + std::size_t{3} * cage.count)),
      room_(kRoom + 3 * cage.count) {
  const std::size_t count = cage.count;
  for (Walk& walk : walks_) {
    walk.triangles = arena.allocate<std::uint32_t>(count + 1);
    walk.squares = arena.allocate<float>(Patch::kPoints * (count + 1));
    walk.beyond = arena.allocate<std::uint32_t>(count + 1);
    walk.beyondSquares = arena.allocate<float>(count + 1);
    walk.seen = arena.allocate<std::uint32_t>(4 * count);
    if (arena.failed()) return;
    walk.sideSeen = walk.seen + count;
    std::fill(walk.seen, walk.sideSeen + 3 * count, 0u);
  }
  for (std::uint32_t i = 0; i < tree.leafCount; ++i) {
    NearTriangle four[4];
    NearTriangle::of(tree.near[i], four);
    // Leaves are full but for the last.
    for (std::uint32_t k = 0; k < std::min(4u, cage.count - 4 * i); ++k) rows_[tree.near[i].slot[k]] = four[k];
  }
}

Patch& ChartFlood::add(Corner* const (&corners)[3], int k, double reach, std::uint8_t (&inGroup)[3]) noexcept {
  Group& group = groupWith(corners, k, inGroup);
  Patch** at = &group.narrowest;
  while (*at != nullptr && (*at)->reach < reach) at = &(*at)->wider;
  if (*at != nullptr && (*at)->reach == reach) return **at;
  const Vec3& q = group.place;
  const double rounding = 2 * kRounding * (tree_.extent + reach + std::abs(q.x) + std::abs(q.y) + std::abs(q.z));
  const double surely = std::max(0.0, reach - rounding);
  const auto within = static_cast<float>(surely * surely);
  const auto beyond = static_cast<float>((reach + rounding) * (reach + rounding));
  Patch& patch = patches_[patchCount_++];
  patch.reach = reach;
  patch.limits = simd::of(within, beyond, beyond, beyond);
  patch.near = nullptr;
  patch.wider = *at;
  *at = &patch;
  return patch;
}

/// A group around the place of corner k that has the other two among its points.
ChartFlood::Group& ChartFlood::groupWith(Corner* const (&corners)[3], int k, std::uint8_t (&inGroup)[3]) noexcept {
  Corner& own = *corners[k];
  const bool isThere = own.group < groupCount_ && groups_[own.group].points[kPlace] == own.point;
  Group* group = isThere ? groups_ + own.group : &addGroup(own);
  inGroup[k] = kPlace;
  for (;;) {
    std::uint32_t count = group->count;
    for (int c = 0; c < 3; ++c) {
      if (c == k) continue;
      std::uint32_t at = count;
      for (std::uint32_t i = kPlace + 1; i < Patch::kPoints; ++i) at = group->points[i] == corners[c]->point ? i : at;
      inGroup[c] = static_cast<std::uint8_t>(at);
      count = std::max(count, at + 1);
    }
    if (count <= Patch::kPoints) {
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
  group.first = own.at.slot;
  group.place = positionOf(cage_.triangles[group.first], own.at.place);
  const double place[3] = {group.place.x, group.place.y, group.place.z};
  // What is not a point yet is where the place is.
  for (int axis = 0; axis < 3; ++axis) {
    const simd::wide ofPlace = simd::splatWide(static_cast<float>(place[axis]) - tree_.middle[axis]);
    for (std::size_t v = 0; v < kVectors; ++v) simd::store(group.positions[axis] + simd::kWide * v, ofPlace);
  }
  for (std::uint32_t i = 0; i < Patch::kPoints; i += simd::kWidth)
    simd::store(group.points + i, simd::splatCount(UINT32_MAX));
  group.points[kPlace] = own.point;
  group.count = kPlace + 1;
  group.narrowest = nullptr;
  return group;
}

void ChartFlood::setPoint(Group& group, std::uint32_t at, const Corner& corner) const noexcept {
  group.points[at] = corner.point;
  for (int axis = 0; axis < 3; ++axis) group.positions[axis][at] = corner.position[axis] - tree_.middle[axis];
}

/// Begins the next group, if there is one.
void ChartFlood::begin(Walk& walk) noexcept {
  walk.size = walk.end = 0;
  walk.patch = nullptr;
  if (nextGroup_ == groupCount_) return;
  walk.group = groups_ + nextGroup_++;
  walk.narrower = nullptr;
  walk.patch = walk.group->narrowest;
  walk.beyondCount = 0;
  for (simd::wide& least : walk.least) least = simd::splatWide(std::numeric_limits<float>::max());
  // The first is always near enough: what is next to it is looked at with it, but for fans, one ring less.
  ++walk.mark;
  const auto add = [&](std::uint32_t t) {
    walk.triangles[walk.end] = t;
    walk.end += walk.seen[t] != walk.mark;
    walk.seen[t] = walk.mark;
  };
  add(walk.group->first);
  for (const std::uint32_t t : charts_.beside[walk.group->first].triangles) add(t);
}

// What is always inlined is called from one place, for every ring.

/// Looks at the triangles next to the last ring, and keeps those near enough.
[[gnu::always_inline]] inline void ChartFlood::look(Walk& walk) noexcept {
  if (walk.patch == nullptr) return;
  // In registers, as stores might change the walk for all the compiler knows.
  std::uint32_t* const triangles = walk.triangles;
  float* const squares = walk.squares;
  std::uint32_t* const beyond = walk.beyond;
  float* const beyondSquares = walk.beyondSquares;
  const NearTriangle* const rows = rows_;
  const simd::f32x4 limits = walk.patch->limits;
  const Group& group = *walk.group;
  simd::wide x[kVectors], y[kVectors], z[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    x[v] = simd::loadWide(group.positions[0] + simd::kWide * v);
    y[v] = simd::loadWide(group.positions[1] + simd::kWide * v);
    z[v] = simd::loadWide(group.positions[2] + simd::kWide * v);
  }
  const std::uint32_t end = walk.end;
  std::uint32_t size = walk.size;
  std::uint32_t beyondCount = walk.beyondCount;
  for (std::uint32_t i = size; i < end; ++i) {
    const std::uint32_t t = triangles[i];
    float* const row = squares + std::size_t{Patch::kPoints} * size;
    for (std::size_t v = 0; v < kVectors; ++v) {
      simd::store(row + simd::kWide * v, squaredDistances(rows[t], x[v], y[v], z[v]));
    }
    // No branch that is a coin toss: what is not kept is written over by the next.
    const unsigned isWithin = simd::bits(simd::splat(row[kPlace]) <= limits);
    std::uint32_t isNear = isWithin & 1;
    if (isWithin == kUnsure) isNear = isWithinReach(walk, t);
    beyond[beyondCount] = t;
    beyondSquares[beyondCount] = row[kPlace];
    beyondCount += 1 - isNear;
    triangles[size] = t;
    size += isNear;
  }
  walk.kept = size;
  walk.beyondCount = beyondCount;
}

/// In double, where floats do not tell.
[[gnu::noinline, gnu::cold]] bool ChartFlood::isWithinReach(const Walk& walk, std::uint32_t t) const noexcept {
  if (t == walk.group->first) return true;
  Candidate at;
  setPlace(cage_, walk.group->place, t, at);
  return at.place.distance <= walk.patch->reach;
}

/// Adds the triangles that were kept, and finds what is next to them.
[[gnu::always_inline]] inline void ChartFlood::meet(Walk& walk) noexcept {
  if (walk.patch == nullptr) return;
  // In registers, as above.
  std::uint32_t* const triangles = walk.triangles;
  std::uint32_t* const seen = walk.seen;
  const float* const squares = walk.squares;
  const Beside* const besides = charts_.beside;
  const std::uint32_t mark = walk.mark;
  const std::uint32_t kept = walk.kept;
  simd::wide least[kVectors];
  std::copy(walk.least, walk.least + kVectors, least);
  std::uint32_t end = kept;
  const auto add = [&](std::uint32_t t) {
    triangles[end] = t;
    end += seen[t] != mark;
    seen[t] = mark;
  };
  for (std::uint32_t i = walk.size; i < kept; ++i) {
    const float* const row = squares + std::size_t{Patch::kPoints} * i;
    for (std::size_t v = 0; v < kVectors; ++v) least[v] = simd::min(least[v], simd::loadWide(row + simd::kWide * v));
    const Beside& beside = besides[triangles[i]];
    for (const std::uint32_t t : beside.triangles) add(t);
    if (beside.isOnFan == 0) continue;
    const std::uint32_t sides = 3 * triangles[i];
    for (std::uint32_t side = sides; side < sides + 3; ++side) {
      if (walk.sideSeen[side] == mark) continue;
      // One round for all triangles that share the edge, however many.
      for (std::uint32_t more = charts_.nextSide[side]; more != side; more = charts_.nextSide[more]) {
        walk.sideSeen[more] = mark;
        add(more / 3);
      }
    }
  }
  std::copy(least, least + kVectors, walk.least);
  walk.size = kept;
  walk.end = end;
}

/// Lists what of a patch that has grown might be the nearest to any point.
/// @return false if there is no room.
[[gnu::always_inline]] inline bool ChartFlood::findNear(const Walk& walk) noexcept {
  if (room_ - nearCount_ < walk.size) return false;
  // In registers, as above.
  NearPoints* const near = near_ + nearCount_;
  const std::uint32_t* const triangles = walk.triangles;
  const float* const squares = walk.squares;
  const std::uint32_t size = walk.size;
  simd::wide limits[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    simd::store(walk.patch->least + simd::kWide * v, walk.least[v]);
    limits[v] = walk.least[v] * simd::splatWide(1 + static_cast<float>(kRelativeSlack)) + simd::splatWide(fixedSlack_);
  }
  const unsigned corners = (1u << walk.group->count) - (2u << kPlace);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < size; ++i) {
    const float* const row = squares + std::size_t{Patch::kPoints} * i;
    unsigned points = 0;
    for (std::size_t v = 0; v < kVectors; ++v) {
      points |= simd::bits(simd::loadWide(row + simd::kWide * v) <= limits[v]) << simd::kWide * v;
    }
    near[count] = {triangles[i], points};
    count += (points & corners) != 0;
  }
  walk.patch->near = near;
  walk.patch->nearCount = count;
  walk.patch->size = size;
  nearCount_ += count;
  return true;
}

/// Ends a patch, and goes on to the next wider one, or to the next group of the walk; where there is no more room, ends
/// the walk.
[[gnu::always_inline]] inline void ChartFlood::finish(Walk& walk) noexcept {
  Patch& patch = *walk.patch;
  Patch* const wider = patch.wider;
  if (walk.narrower != nullptr && walk.narrower->size == walk.size) {
    std::copy(walk.narrower->least, walk.narrower->least + Patch::kPoints, patch.least);
    patch.near = walk.narrower->near;
    patch.nearCount = walk.narrower->nearCount;
    patch.size = walk.size;
  } else if (!findNear(walk)) {
    walk.patch = nullptr;
    return;
  }
  if (wider == nullptr) return begin(walk);
  walk.narrower = &patch;
  walk.patch = wider;
  // What was too far, and may not be any more.
  float limits[4];
  simd::store(limits, wider->limits);
  std::uint32_t end = walk.end, left = 0;
  for (std::uint32_t i = 0; i < walk.beyondCount; ++i) {
    const std::uint32_t t = walk.beyond[i];
    const float squared = walk.beyondSquares[i];
    const bool isNear = squared <= limits[1];
    walk.triangles[end] = t;
    end += isNear;
    walk.beyond[left] = t;
    walk.beyondSquares[left] = squared;
    left += !isNear;
  }
  walk.end = end;
  walk.beyondCount = left;
}

void ChartFlood::grow() noexcept {
  for (Walk& walk : walks_) begin(walk);
  // In turn: how many triangles a ring leaves is known only when its looks are through; until then there are those of
  // the other.
  static_assert(kWalks == 2);
  while (walks_[0].patch != nullptr || walks_[1].patch != nullptr) {
    for (Walk& walk : walks_) look(walk);
    for (Walk& walk : walks_) {
      meet(walk);
      while (walk.size == walk.end && walk.patch != nullptr) finish(walk);
    }
  }
}

}  // namespace cagecast
