#include "weld.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

#include "curve.hpp"
#include "point_search.hpp"
#include "triangle.hpp"

namespace cagecast {
namespace {

/// A vertex and the place of its cell on the curve.
struct Placed {
  std::uint32_t key;
  std::uint32_t vertex;
};

/// Sorts by key, stably: least significant digit first.
/// @return The one of the two arrays that holds the result.
Placed* sortByKey(Placed* items, Placed* other, std::uint32_t count, int keyBits) {
  constexpr int kMostDigitBits = 12;
  const int digits = (keyBits + kMostDigitBits - 1) / kMostDigitBits;
  const int digitBits = (keyBits + digits - 1) / digits;
  const std::uint32_t mask = (1u << digitBits) - 1;
  std::uint32_t starts[1 << kMostDigitBits];
  for (int shift = 0; shift < keyBits; shift += digitBits) {
    std::fill(starts, starts + mask + 1, 0u);
    for (std::uint32_t i = 0; i < count; ++i) ++starts[items[i].key >> shift & mask];
    std::uint32_t sum = 0;
    for (std::uint32_t digit = 0; digit <= mask; ++digit) sum += std::exchange(starts[digit], sum);
    for (std::uint32_t i = 0; i < count; ++i) other[starts[items[i].key >> shift & mask]++] = items[i];
    std::swap(items, other);
  }
  return items;
}

/// A vertex as weld sees it, scaled. Adding 0 made 0 of −0, so equal is the same as equal to the bit.
struct Site {
  float x, y, z;
  std::uint32_t group;

  /// Makes a point of it: the group takes the place of the fourth float.
  void put(float* position) const { std::memcpy(position, this, sizeof(Site)); }
  [[nodiscard]] bool isAt(const float* position) const { return std::memcmp(position, this, sizeof(Site)) == 0; }

  friend bool operator==(const Site& a, const Site& b) { return std::memcmp(&a, &b, sizeof(Site)) == 0; }
  friend bool operator<(const Site& a, const Site& b) { return std::tie(a.x, a.y, a.z, a.group) < std::tie(b.x, b.y, b.z, b.group); }
};

/// Sorts the vertices of the first cell by site, and equal ones by index.
/// @param end  Of all cells.
void sortCell(Placed* begin, const Placed* end, const Site* sites) {
  Placed* cellEnd = begin;
  while (cellEnd < end && cellEnd->key == begin->key) ++cellEnd;
  // By heap: it happens seldom, and std::sort is 5 KB of WebAssembly.
  const auto before = [&](const Placed& a, const Placed& b) {
    return sites[a.vertex] == sites[b.vertex] ? a.vertex < b.vertex : sites[a.vertex] < sites[b.vertex];
  };
  std::make_heap(begin, cellEnd, before);
  std::sort_heap(begin, cellEnd, before);
}

}  // namespace

bool weld(const MeshView& target, const Units& units, float tolerance, Scratch& scratch, Points& out) noexcept {
  const auto vertexCount = static_cast<std::uint32_t>(target.positions.size() / 3);
  const auto allTriangles = static_cast<std::uint32_t>(target.indices.size() / 3);
  auto* ofVertex = scratch.take<std::uint32_t>(vertexCount);
  auto* positions = scratch.take<float>(Points::kStride * vertexCount);
  auto* places = scratch.take<std::uint32_t>(vertexCount);
  auto* triangles = scratch.take<std::uint32_t>(std::size_t{3} * allTriangles);
  auto* doubleAreas = scratch.take<double>(allTriangles);
  const bool tolerant = tolerance > 0;
  auto* groups = scratch.take<std::uint32_t>(tolerant ? vertexCount : 0);
  const Scratch::Mark mark = scratch.mark();
  auto* sites = scratch.take<Site>(vertexCount);
  auto* placed = scratch.take<Placed>(vertexCount);
  auto* spare = scratch.take<Placed>(vertexCount);
  if (scratch.failed()) return false;

  // Sort the vertices along the curve: equal positions come together, and points are born in curve order.
  const int levels = vertexCount < (1u << 13) ? 6 : vertexCount < (1u << 18) ? 8 : 10;
  float side = 0;
  for (int k = 0; k < 3; ++k) side = std::max(side, units.high[k] - units.low[k]);
  const float cells = side > 0 ? static_cast<float>((1 << levels) - 1) / side : 0.0f;
  const HilbertCurve curve;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const float* p = target.positions.data() + std::size_t{3} * v;
    const Site s{p[0] * units.scale + 0.0f, p[1] * units.scale + 0.0f, p[2] * units.scale + 0.0f,
                 target.groups.empty() ? 0 : target.groups[v]};
    const auto cell = [cells](float x, float low) { return static_cast<std::uint32_t>(static_cast<std::int32_t>((x - low) * cells)); };
    sites[v] = s;
    placed[v] = {curve.key(cell(s.x, units.low[0]), cell(s.y, units.low[1]), cell(s.z, units.low[2]), levels), v};
  }
  if (Placed* sorted = sortByKey(placed, spare, vertexCount, 3 * levels); sorted != placed) std::swap(placed, spare);

  // Within a cell, compare each with each while they are few; sort a crowded one, so that no input makes this quadratic.
  constexpr std::uint32_t kFew = 16;
  std::uint32_t pointCount = 0;
  std::uint32_t firstPoint = 0;  // Of the cell.
  bool crowded = false;
  for (std::uint32_t i = 0; i < vertexCount; ++i) {
    const std::uint32_t key = placed[i].key;
    if (i == 0 || key != placed[i - 1].key) {
      firstPoint = pointCount;
      crowded = i + kFew < vertexCount && placed[i + kFew].key == key;
      if (crowded) sortCell(placed + i, placed + vertexCount, sites);
    }
    const std::uint32_t v = placed[i].vertex;
    const Site& s = sites[v];
    std::uint32_t point = crowded && pointCount > firstPoint ? pointCount - 1 : firstPoint;
    while (point < pointCount && !s.isAt(positions + Points::kStride * point)) ++point;
    if (point == pointCount) {
      ++pointCount;
      places[point] = key;
      s.put(positions + Points::kStride * point);
    }
    ofVertex[v] = point;
  }
  if (!target.groups.empty()) {
    for (std::uint32_t i = 0; i < pointCount; ++i) {
      float& group = positions[Points::kStride * i + 3];
      if (tolerant) std::memcpy(&groups[i], &group, sizeof group);
      group = 0;
    }
  } else if (tolerant) {
    std::fill(groups, groups + pointCount, 0u);
  }
  scratch.rewind(mark);

  if (tolerant) {
    const std::uint32_t all = pointCount;
    auto* merged = scratch.take<std::uint32_t>(all);
    if (scratch.failed()) return false;
    const double radius = static_cast<double>(tolerance) * units.diagonal;
    if (!mergeNear(positions, groups, all, radius, merged, pointCount)) return false;
    // Joined points keep the order of their first members, and the places of these.
    for (std::uint32_t i = 0, next = 0; i < all; ++i) {
      if (merged[i] == next) places[next++] = places[i];
    }
    for (std::uint32_t v = 0; v < vertexCount; ++v) ofVertex[v] = merged[ofVertex[v]];
    scratch.rewind(mark);
  }

  std::uint32_t kept = 0;
  for (std::uint32_t t = 0; t < allTriangles; ++t) {
    const std::uint32_t* index = target.indices.data() + std::size_t{3} * t;
    const std::uint32_t corner[3] = {ofVertex[index[0]], ofVertex[index[1]], ofVertex[index[2]]};
    const auto position = [&](int i) { return positions + Points::kStride * corner[i]; };
    const double doubleArea = length(areaNormal(position(0), position(1), position(2)));
    if (!(doubleArea > 0)) continue;
    std::copy(corner, corner + 3, triangles + std::size_t{3} * kept);
    doubleAreas[kept++] = doubleArea;
  }

  out = {pointCount, positions, places, ofVertex, kept, triangles, doubleAreas};
  return true;
}

}  // namespace cagecast
