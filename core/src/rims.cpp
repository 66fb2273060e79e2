#include "rims.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "index_table.hpp"
#include "union_find.hpp"

namespace cagecast {
namespace {

/// A place within this share of the diagonal of an open edge is on it, so that rounding does not decide.
constexpr double kOnRim = 1e-6;

const float* cornerOf(const Cage& cage, std::uint32_t corner) {
  const CageTriangle& t = cage.triangles[corner / 3];
  return corner % 3 == 0 ? t.a : corner % 3 == 1 ? t.b : t.c;
}

}  // namespace

void Rims::Box::grow(Vec3 p) noexcept {
  const double at[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], at[k]);
    high[k] = std::max(high[k], at[k]);
  }
}

double Rims::Box::diagonal() const noexcept { return length({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }

std::uint32_t Rims::at(const CageTriangle& triangle, std::uint32_t slot, Vec3 q, double diagonal) const noexcept {
  if (!touches(slot)) return kNone;
  const std::uint32_t* sides = ofSides + std::size_t{6} * slot;
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  const double near = kOnRim * diagonal;
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    if (sides[k] != kNone && length(cross(edge, q - corners[k])) <= near * length(edge)) return sides[k];
  }
  for (int k = 0; k < 3; ++k) {
    if (sides[3 + k] != kNone && length(q - corners[k]) <= near) return sides[3 + k];
  }
  return kNone;
}

bool findRims(const Cage& cage, Scratch& scratch, Rims& out) noexcept {
  const std::uint32_t sideCount = 3 * cage.count;
  auto* ofSides = scratch.take<std::uint32_t>(std::size_t{2} * sideCount);
  auto* boxes = scratch.take<Rims::Box>(sideCount);
  const Scratch::Mark mark = scratch.mark();
  // A vertex is named by the first corner there, an edge by the first side there. Side i goes from corner i to the next.
  auto* vertexAt = scratch.take<std::uint32_t>(sideCount);
  auto* edges = scratch.take<std::uint64_t>(sideCount);
  auto* parents = scratch.take<std::uint32_t>(sideCount);
  auto* isShared = scratch.take<bool>(sideCount);
  auto* loopAt = scratch.take<std::uint32_t>(sideCount);
  IndexTable vertices(sideCount, scratch);
  IndexTable edgeTable(sideCount, scratch);
  if (scratch.failed()) return false;

  for (std::uint32_t i = 0; i < sideCount; ++i) {
    float p[3];
    for (int k = 0; k < 3; ++k) p[k] = cornerOf(cage, i)[k] + 0.0f;  // Now −0 is 0.
    std::uint32_t words[3];
    std::memcpy(words, p, sizeof words);
    vertexAt[i] = vertices.firstEqual(i, IndexTable::mix(IndexTable::mix(words[0], words[1]), words[2]), [&](std::uint32_t other) {
      const float* o = cornerOf(cage, other);
      return o[0] == p[0] && o[1] == p[1] && o[2] == p[2];
    });
  }
  std::fill(isShared, isShared + sideCount, false);
  for (std::uint32_t i = 0; i < sideCount; ++i) {
    const std::uint64_t a = vertexAt[i];
    const std::uint64_t b = vertexAt[i % 3 == 2 ? i - 2 : i + 1];
    edges[i] = std::min(a, b) << 32 | std::max(a, b);
    const std::uint32_t first =
        edgeTable.firstEqual(i, IndexTable::mix(0, edges[i]), [&](std::uint32_t other) { return edges[other] == edges[i]; });
    if (first != i) isShared[i] = isShared[first] = true;
  }
  UnionFind sets(parents, sideCount);
  for (std::uint32_t i = 0; i < sideCount; ++i) {
    if (!isShared[i]) sets.join(static_cast<std::uint32_t>(edges[i] >> 32), static_cast<std::uint32_t>(edges[i]));
  }
  // Only vertices of open edges have been joined with others, so each edge finds its rim at either end.
  std::fill(loopAt, loopAt + sideCount, Rims::kNone);
  out.count = 0;
  for (std::uint32_t i = 0; i < sideCount; ++i) {
    if (isShared[i]) continue;
    std::uint32_t& loop = loopAt[sets.find(vertexAt[i])];
    if (loop == Rims::kNone) {
      boxes[out.count] = {};
      loop = out.count++;
    }
    for (const std::uint32_t end : {static_cast<std::uint32_t>(edges[i] >> 32), static_cast<std::uint32_t>(edges[i])}) {
      boxes[loop].grow(Vec3::from(cornerOf(cage, end)));
      loopAt[end] = loop;
    }
  }
  for (std::uint32_t i = 0; i < sideCount; ++i) {
    std::uint32_t* sides = ofSides + std::size_t{6} * (i / 3);
    sides[3 + i % 3] = loopAt[vertexAt[i]];
    sides[i % 3] = isShared[i] ? Rims::kNone : loopAt[vertexAt[i]];
  }
  out.boxes = boxes;
  out.ofSides = ofSides;
  scratch.rewind(mark);
  return true;
}

}  // namespace cagecast
