#include "cage/uv_charts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/hash_index.hpp"
#include "base/union_find.hpp"

namespace cagecast {
namespace {

/// A UV as one number, equal where the UVs are.
using UvBits = std::uint64_t;

UvBits bitsOf(const float* uv) {
  const float place[2] = {uv[0] + 0.0f, uv[1] + 0.0f};  // Now −0 is 0.
  UvBits bits;
  std::memcpy(&bits, place, sizeof bits);
  return bits;
}

}  // namespace

bool findUvCharts(const Cage& cage, const HalfEdges& edges, Arena& arena, UvCharts& out) noexcept {
  const std::uint32_t sideCount = 3 * cage.count;
  out.nextSide = arena.allocate<std::uint32_t>(sideCount);
  out.beside = arena.allocate<Beside>(cage.count);
  out.islands = arena.allocate<std::uint32_t>(cage.count);
  out.stretch = arena.allocate<double>(cage.count);
  const Arena::Mark mark = arena.mark();
  auto* uvs = arena.allocate<UvBits>(sideCount);  // Where sides begin.
  HashIndex fans(sideCount, arena);               // Edges of three triangles and more.
  if (arena.failed()) return false;

  out.mostUv = 0;
  for (std::uint32_t t = 0; t < cage.count; ++t) {
    const CageTriangle& triangle = cage.triangles[t];
    const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
    double stretch = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3;
      uvs[3 * t + k] = bitsOf(triangle.uvs + 2 * k);
      const double du = static_cast<double>(triangle.uvs[2 * l]) - static_cast<double>(triangle.uvs[2 * k]);
      const double dv = static_cast<double>(triangle.uvs[2 * l + 1]) - static_cast<double>(triangle.uvs[2 * k + 1]);
      const Vec3 along = corners[l] - corners[k];
      stretch = std::max(stretch, (du * du + dv * dv) * (1 / dot(along, along)));
    }
    out.stretch[t] = std::sqrt(stretch);
    for (const float x : triangle.uvs) out.mostUv = std::max(out.mostUv, std::abs(x));
  }
  const std::uint32_t* starts = edges.starts;
  const auto isSame = [starts, uvs](std::uint32_t side, std::uint32_t other) {
    const std::uint32_t end = HalfEdges::after(side);
    std::uint32_t from = other, to = HalfEdges::after(other);
    if (starts[side] != starts[from]) std::swap(from, to);
    return starts[side] == starts[from] && starts[end] == starts[to] && uvs[side] == uvs[from] && uvs[end] == uvs[to];
  };
  const auto hash = [starts, uvs](std::uint32_t corner) {
    return HashIndex::mix(HashIndex::mix(0, starts[corner]), uvs[corner]);
  };
  for (std::uint32_t side = 0; side < sideCount; ++side) {
    std::uint32_t other = edges.next[side];
    out.nextSide[side] = side;
    if (edges.next[other] != side) {
      // There may be very many: none looks at all others.
      other = fans.firstEqual(side, hash(side) + hash(HalfEdges::after(side)),
                              [&](std::uint32_t known) { return isSame(side, known); });
      std::swap(out.nextSide[side], out.nextSide[other]);
    } else {
      if (!isSame(side, other)) other = side;
      out.nextSide[side] = other;
    }
  }
  UnionFind sets(out.islands, cage.count);
  for (std::uint32_t t = 0, side = 0; t < cage.count; ++t) {
    Beside& beside = out.beside[t];
    beside.isOnFan = 0;
    std::uint32_t next[3];
    for (std::uint32_t k = 0; k < 3; ++k, ++side) {
      const std::uint32_t other = out.nextSide[side];
      const bool isOnFan = out.nextSide[other] != side;
      next[k] = other / 3;
      beside.triangles[k] = isOnFan ? t : next[k];
      beside.isOnFan |= unsigned{isOnFan};
    }
    sets.join({t, next[0], next[1], next[2]});
  }
  sets.flatten(cage.count);
  arena.rewind(mark);
  return true;
}

}  // namespace cagecast
