#include "input/weld.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

#include "geometry/hilbert.hpp"
#include "geometry/triangle.hpp"
#include "input/merge_near.hpp"
#include "simd/simd.hpp"

namespace cagecast {
namespace {

using simd::f32x4;

/// A vertex in the lower half; in the upper half its key, the place of its cell on the Hilbert curve.
using Placed = std::uint64_t;
std::uint32_t keyOf(Placed placed) { return static_cast<std::uint32_t>(placed >> 32); }
std::uint32_t vertexOf(Placed placed) { return static_cast<std::uint32_t>(placed); }

/// More than any key.
constexpr std::uint32_t kNoKey = ~0u;
/// So many vertices of a cell are compared each with each; more are sorted, so that no input makes it quadratic.
constexpr std::uint32_t kFew = 16;

/// Keys are sorted by two or three digits: 2 · 9, 2 · 12 or 3 · 10 bits.
class Digits {
 public:
  static constexpr std::uint32_t kMaxValues = 2 << 12;

  explicit Digits(int keyBits) : count_(keyBits > 24 ? 3 : 2), bits_(keyBits / count_) {}

  [[nodiscard]] std::uint32_t values() const { return 1u << bits_; }  ///< Of one digit.
  [[nodiscard]] std::uint32_t allValues() const { return static_cast<std::uint32_t>(count_) << bits_; }

  /// Counts a key's digits.
  /// @param counts  `allValues()`, digit by digit, 0 in the beginning.
  void count(std::uint32_t key, std::uint32_t* counts) const {
    const std::uint32_t mask = values() - 1;
    ++counts[key & mask];
    ++(counts + values())[key >> bits_ & mask];
    // Only large meshes have a third digit; the others should not pay for it.
    if (count_ > 2) [[unlikely]]
      ++(counts + 2 * std::size_t{values()})[key >> 2 * bits_];
  }

  /// Sorts by key, stably: least significant digit first.
  /// @param counts  Of all keys; used up.
  /// @return The one of the two arrays that holds the result.
  Placed* sort(Placed* items, Placed* other, std::uint32_t itemCount, std::uint32_t* counts) const {
    for (int digit = 0; digit < count_; ++digit) {
      std::uint32_t sum = 0;
      for (std::uint32_t value = 0; value < values(); ++value) sum += std::exchange(counts[value], sum);
      const int shift = 32 + digit * bits_;
      const std::uint32_t mask = values() - 1;
      for (std::uint32_t i = 0; i < itemCount; ++i) other[counts[items[i] >> shift & mask]++] = items[i];
      std::swap(items, other);
      counts += values();
    }
    return items;
  }

 private:
  int count_, bits_;
};

/// A vertex as it is compared: its scaled position, without −0, and its group.
struct alignas(16) Site {
  float x, y, z;
  std::uint32_t group;

  static Site of(f32x4 position, std::uint32_t group) {
    float lanes[4];
    simd::store(lanes, position);
    return {lanes[0], lanes[1], lanes[2], group};
  }

  /// Without −0, equal positions have equal bits.
  friend bool operator==(const Site& a, const Site& b) {
    // By halves: memcmp is a loop in WebAssembly.
    std::uint64_t halves[2];
    std::uint64_t others[2];
    std::memcpy(halves, &a, sizeof halves);
    std::memcpy(others, &b, sizeof others);
    return ((halves[0] ^ others[0]) | (halves[1] ^ others[1])) == 0;
  }
  friend bool operator<(const Site& a, const Site& b) {
    return std::tie(a.x, a.y, a.z, a.group) < std::tie(b.x, b.y, b.z, b.group);
  }
};

/// Sorts the vertices of the first cell by site, and equal ones by index.
void sortCell(Placed* begin, const Site* sites) {
  Placed* end = begin;
  while (keyOf(*end) == keyOf(*begin)) ++end;
  const auto isBefore = [&](Placed a, Placed b) {
    const Site& s = sites[vertexOf(a)];
    const Site& t = sites[vertexOf(b)];
    return s == t ? a < b : s < t;
  };
  // Takes little of the time; std::sort would be a larger function.
  std::make_heap(begin, end, isBefore);
  std::sort_heap(begin, end, isBefore);
}

/// The points that vertices are welded to.
struct Welded {
  std::uint32_t* firstVertex;  ///< 1 per point.
  std::uint32_t* cells;        ///< 1 per point: its cell.
  std::uint32_t* ofVertex;     ///< 1 per vertex: its point.
};

/// Makes points of the vertices, in the order of their cells and, within a cell, of the first vertex of each point.
/// @param placed  Sorted by cell; after the last come `kFew` entries of no cell.
/// @return How many points there are.
std::uint32_t weldEqual(Placed* placed, std::uint32_t vertexCount, const Site* sites, const Welded& out) {
  std::uint32_t count = 0;
  std::uint32_t first = 0;  // The first point that the vertex can be equal to.
  bool isCrowded = false;
  std::uint32_t lastKey = kNoKey;
  for (Placed* const end = placed + vertexCount; placed < end; ++placed) {
    const std::uint32_t key = keyOf(*placed);
    if (key != lastKey) {
      lastKey = key;
      first = count;
      isCrowded = keyOf(placed[kFew]) == key;
      if (isCrowded) sortCell(placed, sites);
    }
    const std::uint32_t v = vertexOf(*placed);
    std::uint32_t point = first;
    while (point < count && !(sites[v] == sites[out.firstVertex[point]])) ++point;
    out.ofVertex[v] = point;
    if (point < count) continue;
    out.firstVertex[point] = v;
    out.cells[point] = key;
    ++count;
    // In a crowded cell equal vertices follow each other.
    if (isCrowded) first = point;
  }
  return count;
}

/// Finds the corners of the triangles that have an area, and twice that area.
/// @return How many there are.
std::uint32_t weldTriangles(std::span<const std::uint32_t> indices, const std::uint32_t* ofVertex,
                            const float* positions, std::uint32_t* triangles, double* areas) {
  double least = std::numeric_limits<double>::infinity();
  const auto all = static_cast<std::uint32_t>(indices.size() / 3);
  for (std::size_t t = 0; t < all; ++t) {
    const float* corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      triangles[3 * t + k] = ofVertex[indices[3 * t + k]];
      corner[k] = positions + Points::kStride * triangles[3 * t + k];
    }
    areas[t] = length(areaNormal(corner[0], corner[1], corner[2]));
    least = std::min(least, areas[t]);
  }
  if (least > 0) return all;

  std::uint32_t kept = 0;
  for (std::uint32_t t = 0; t < all; ++t) {
    if (!(areas[t] > 0)) continue;
    std::copy_n(triangles + std::size_t{3} * t, 3, triangles + std::size_t{3} * kept);
    areas[kept++] = areas[t];
  }
  return kept;
}

/// Sorts the vertices along a Hilbert curve: equal positions come together, and points are numbered along the curve.
/// @param sites  Filled with the position and group of each vertex.
/// @param unsorted, spare  Working memory for all vertices and kFew more.
/// @return The sorted vertices, in either memory, followed by kFew that belong to no vertex.
Placed* sortAlongCurve(const MeshView& target, const Units& units, Site* sites, Placed* unsorted, Placed* spare) {
  const auto vertexCount = static_cast<std::uint32_t>(target.positions.size() / 3);
  const int levels = vertexCount < (1u << 13) ? 6 : vertexCount < (1u << 18) ? 8 : 10;
  float side = 0;
  for (int k = 0; k < 3; ++k) side = std::max(side, units.high[k] - units.low[k]);
  // A pose may be next to a single point, whose cells would be more than a float can count.
  const float cells = side > 0x1p-100f ? static_cast<float>((1 << levels) - 1) / side : 0.0f;
  const HilbertCurve curve(levels);
  const Digits digits(3 * levels);
  std::uint32_t counts[Digits::kMaxValues];
  std::fill(counts, counts + digits.allValues(), 0u);
  const float* position = target.positions.data();
  const std::uint32_t* groupOf = target.groups.empty() ? nullptr : target.groups.data();
  const f32x4 scale = simd::splat(units.scale);
  const f32x4 low = simd::load3(units.low);
  for (std::uint32_t v = 0; v < vertexCount; ++v, position += 3) {
    const f32x4 p = simd::load3(position) * scale + simd::splat(0);
    sites[v] = Site::of(p, groupOf == nullptr ? 0 : groupOf[v]);
    const simd::u32x4 cell = simd::rounded((p - low) * simd::splat(cells));
    const std::uint32_t key = curve.key(simd::lane<0>(cell), simd::lane<1>(cell), simd::lane<2>(cell));
    digits.count(key, counts);
    unsorted[v] = Placed{key} << 32 | v;
  }
  Placed* placed = digits.sort(unsorted, spare, vertexCount, counts);
  std::fill_n(placed + vertexCount, kFew, Placed{kNoKey} << 32);
  return placed;
}

}  // namespace

void Points::split(Vec3 p, float* position, float* positionLow) noexcept {
  const auto part = [](double x, float& rounded, float& left) {
    rounded = static_cast<float>(x);
    left = static_cast<float>(x - static_cast<double>(rounded));
  };
  part(p.x, position[0], positionLow[0]);
  part(p.y, position[1], positionLow[1]);
  part(p.z, position[2], positionLow[2]);
  position[3] = 0;
}

Code weld(const MeshView& target, const Units& units, float tolerance, Arena& arena, Points& out) noexcept {
  const auto vertexCount = static_cast<std::uint32_t>(target.positions.size() / 3);
  const auto allTriangles = static_cast<std::uint32_t>(target.indices.size() / 3);
  auto* ofVertex = arena.allocate<std::uint32_t>(vertexCount);
  auto* positions = arena.allocate<float>(Points::kStride * vertexCount);
  auto* cells = arena.allocate<std::uint32_t>(vertexCount);
  auto* triangles = arena.allocate<std::uint32_t>(std::size_t{3} * allTriangles);
  auto* doubleAreas = arena.allocate<double>(allTriangles);
  const bool tolerant = tolerance > 0;
  auto* groups = arena.allocate<std::uint32_t>(tolerant ? vertexCount : 0);

  std::uint32_t pointCount = 0;
  {
    const Arena::Scope scope(arena);
    auto* sites = arena.allocate<Site>(vertexCount);
    auto* unsorted = arena.allocate<Placed>(vertexCount + kFew);
    auto* spare = arena.allocate<Placed>(vertexCount + kFew);
    auto* firstVertex = arena.allocate<std::uint32_t>(vertexCount);
    if (arena.failed()) return Code::outOfMemory;
    Placed* placed = sortAlongCurve(target, units, sites, unsorted, spare);
    pointCount = weldEqual(placed, vertexCount, sites, {firstVertex, cells, ofVertex});
    for (std::uint32_t i = 0; i < pointCount; ++i) {
      const Site& site = sites[firstVertex[i]];
      simd::store(positions + Points::kStride * i, simd::of(site.x, site.y, site.z, 0));
      if (tolerant) groups[i] = site.group;
    }
  }
  if (tolerant) {
    const Arena::Scope scope(arena);
    const std::uint32_t all = pointCount;
    auto* merged = arena.allocate<std::uint32_t>(all);
    if (arena.failed()) return Code::outOfMemory;
    const double radius = static_cast<double>(tolerance) * units.diagonal;
    if (const Code code = mergeNear(positions, groups, pointCount, radius, merged); code != Code::ok) return code;
    // Joined points keep the order of their first members, and the cells of these.
    for (std::uint32_t i = 0, next = 0; i < all; ++i) {
      if (merged[i] == next) cells[next++] = cells[i];
    }
    for (std::uint32_t v = 0; v < vertexCount; ++v) ofVertex[v] = merged[ofVertex[v]];
  }

  const std::uint32_t kept = weldTriangles(target.indices, ofVertex, positions, triangles, doubleAreas);
  out = {pointCount, positions, cells, ofVertex, kept, triangles, doubleAreas};
  return Code::ok;
}

}  // namespace cagecast
