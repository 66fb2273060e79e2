#include "pipeline.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace cagecast::bench {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

/// Spreads the lowest 10 bits three apart.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ff;
  bits = (bits | bits << 8) & 0x0300f00f;
  bits = (bits | bits << 4) & 0x030c30c3;
  return (bits | bits << 2) & 0x09249249;
}

std::uint32_t root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

void Welded::weld(const MeshView& target) {
  const std::size_t vertexCount = target.positions.size() / 3;
  const std::size_t slots = std::bit_ceil(2 * vertexCount);
  const auto shift = static_cast<unsigned>(64 - std::countr_zero(slots));
  table_.assign(slots, kNone);
  points.clear();
  points.reserve(vertexCount);
  ofVertex.resize(vertexCount);
  low_ = high_ = at(target.positions, 0);
  std::vector<std::uint32_t>& firstVertex = order_;
  firstVertex.clear();
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    // Adding 0 makes 0 of −0.
    const Vec3f p = at(target.positions, v) + Vec3f{0, 0, 0};
    const std::uint32_t group = target.groups.empty() ? 0 : target.groups[v];
    std::uint64_t hash = (std::bit_cast<std::uint32_t>(p.x) ^ std::uint64_t{std::bit_cast<std::uint32_t>(p.y)} << 32) *
                         0x9e3779b97f4a7c15u;
    hash = (hash ^ hash >> 32 ^ std::bit_cast<std::uint32_t>(p.z) ^ std::uint64_t{group} << 32) * 0x9e3779b97f4a7c15u;
    std::size_t slot = hash >> shift;
    for (;; slot = (slot + 1) & (slots - 1)) {
      const std::uint32_t point = table_[slot];
      if (point == kNone) break;
      const Vec3f q = points[point];
      if (p.x == q.x && p.y == q.y && p.z == q.z &&
          (target.groups.empty() || target.groups[firstVertex[point]] == group))
        break;
    }
    if (table_[slot] == kNone) {
      table_[slot] = static_cast<std::uint32_t>(points.size());
      points.push_back(p);
      firstVertex.push_back(v);
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
    }
    ofVertex[v] = table_[slot];
  }
  diagonal = std::sqrt(dot(high_ - low_, high_ - low_));
}

const std::vector<std::uint32_t>& Welded::alongCurve() {
  // 21 or 30 bits, sorted by 11 or 10 of them at a time.
  const bool few = points.size() < (1u << 16);
  const float cells = few ? 127 : 1023;
  const unsigned digitBits = few ? 11 : 10;
  const Vec3f size = high_ - low_;
  const float side = std::max({size.x, size.y, size.z});
  const float scale = side > 0 ? cells / side : 0;
  keys_.resize(points.size());
  spareKeys_.resize(points.size());
  order_.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3f cell = scale * (points[i] - low_);
    const std::uint32_t key = spread(static_cast<std::uint32_t>(cell.x)) |
                              spread(static_cast<std::uint32_t>(cell.y)) << 1 |
                              spread(static_cast<std::uint32_t>(cell.z)) << 2;
    keys_[i] = std::uint64_t{key} << 32 | i;
  }
  for (unsigned shift = 32; shift < (few ? 53 : 62); shift += digitBits) {
    std::array<std::uint32_t, 1 << 11> starts{};
    const auto digit = [&](std::uint64_t key) { return key >> shift & ((1u << digitBits) - 1); };
    for (const std::uint64_t key : keys_) ++starts[digit(key)];
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) sum += std::exchange(start, sum);
    for (const std::uint64_t key : keys_) spareKeys_[starts[digit(key)]++] = key;
    keys_.swap(spareKeys_);
  }
  for (std::size_t i = 0; i < keys_.size(); ++i) order_[i] = static_cast<std::uint32_t>(keys_[i]);
  return order_;
}

void Decision::decide(const MeshView& target, const Welded& welded, const std::vector<Zone>& pointZones,
                      const std::vector<float>& pointUvs, const std::vector<float>& pointDistances,
                      const std::vector<std::uint32_t>& pointTriangles) {
  const std::size_t pointCount = welded.points.size();
  const std::size_t vertexCount = welded.ofVertex.size();
  const std::size_t triangleCount = target.indices.size() / 3;
  parents_.resize(pointCount);
  for (std::uint32_t i = 0; i < pointCount; ++i) parents_[i] = i;
  const auto corner = [&](std::size_t t, std::size_t i) { return welded.ofVertex[target.indices[3 * t + i]]; };
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const std::uint32_t a = root(parents_, corner(t, 0));
    for (std::size_t i = 1; i < 3; ++i) parents_[root(parents_, corner(t, i))] = a;
  }
  sums_.assign(pointCount, {});
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const Vec3f a = welded.points[corner(t, 0)];
    const Vec3f n = cross(welded.points[corner(t, 1)] - a, welded.points[corner(t, 2)] - a);
    const double third = static_cast<double>(std::sqrt(dot(n, n))) / 6;
    Sums& sums = sums_[root(parents_, corner(t, 0))];
    for (std::size_t i = 0; i < 3; ++i) {
      const Zone zone = pointZones[corner(t, i)];
      if (zone != Zone::occluded) sums.exposed += third;
      if (zone == Zone::cosmetic) sums.covered += third;
    }
  }

  zones.resize(vertexCount);
  uvs.resize(2 * vertexCount);
  distances.resize(vertexCount);
  triangles.resize(vertexCount);
  segments.resize(vertexCount);
  cosmeticTriangles.resize(triangleCount);
  for (std::size_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t i = welded.ofVertex[v];
    segments[v] = root(parents_, i);
    const Sums& sums = sums_[segments[v]];
    const bool culled = sums.covered < 0.5 * sums.exposed;
    zones[v] = culled && pointZones[i] == Zone::cosmetic ? Zone::culled : pointZones[i];
    uvs[2 * v] = pointUvs[2 * i];
    uvs[2 * v + 1] = pointUvs[2 * i + 1];
    distances[v] = pointDistances[i];
    triangles[v] = pointTriangles[i];
  }
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const auto cosmetic = [&](std::size_t i) { return zones[target.indices[3 * t + i]] == Zone::cosmetic; };
    cosmeticTriangles[t] = cosmetic(0) && cosmetic(1) && cosmetic(2);
  }
}

}  // namespace cagecast::bench
