#include "make/steps.hpp"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "mesh/bounds.hpp"
#include "mesh/disjoint_sets.hpp"
#include "mesh/progress.hpp"

// Of this file alone: a program may have another version of meshoptimizer, and linkers mix what has one name.
#define MESHOPTIMIZER_API static
namespace {
#include <simplifier.cpp>
}

namespace cagecast::cages {

namespace {

/// A loop keeps so many vertices at least and at most,
constexpr std::size_t kMinLocks = 5;
constexpr std::size_t kMaxLocks = 24;
/// and between these as many as it takes to stay this close to it, as a share of its size.
constexpr double kLoopError = 0.04;

/// Triangles of a fin, at most.
constexpr std::uint32_t kFinTriangles = 8;

/// With at most so many indices, or twice as many as are to be left, one call does the rest, in a few tens of
/// milliseconds.
constexpr std::size_t kLastStepIndices = std::size_t{3} * 15000;

/// Locks the vertices of a loop that keep its shape best: the one farthest from the polygon so far, again and again
/// (Ramer 1972; Douglas, Peucker 1973).
void lockLoop(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop, double tolerance,
              std::vector<unsigned char>& locks) {
  const auto at = [&](std::size_t i) -> const Vec3& { return mesh.positions[loop[i % loop.size()]]; };
  const auto farthestFrom = [&](const Vec3& point) {
    const auto isNearer = [&](std::uint32_t a, std::uint32_t b) {
      return length(mesh.positions[a] - point) < length(mesh.positions[b] - point);
    };
    return static_cast<std::size_t>(std::max_element(loop.begin(), loop.end(), isNearer) - loop.begin());
  };
  std::vector<std::size_t> chosen = {farthestFrom(middleOf(mesh, loop))};
  chosen.push_back(farthestFrom(at(chosen[0])));
  const double size = length(at(chosen[0]) - at(chosen[1]));
  while (chosen.size() < std::min(kMaxLocks, loop.size())) {
    std::sort(chosen.begin(), chosen.end());
    double most = -1;
    std::size_t next = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const std::size_t from = chosen[k], to = k + 1 < chosen.size() ? chosen[k + 1] : chosen[0] + loop.size();
      for (std::size_t i = from + 1; i < to; ++i) {
        const double distance = distanceToSegment(at(i), at(from), at(to));
        if (distance <= most) continue;
        most = distance;
        next = i % loop.size();
      }
    }
    if (chosen.size() >= kMinLocks && most < std::min(tolerance, kLoopError * size)) break;
    chosen.push_back(next);
  }
  for (const std::size_t i : chosen) locks[loop[i]] = 1;
}

/// Removes triangles with the same corners, which collapses leave behind as flaps on an edge.
void removeFlaps(std::vector<Triangle3>& triangles) {
  std::map<Triangle3, int> counts;
  const auto count = [&](Triangle3 corners) -> int& {
    std::sort(corners.begin(), corners.end());
    return counts[corners];
  };
  for (const Triangle3& t : triangles) ++count(t);
  std::erase_if(triangles, [&](const Triangle3& t) { return count(t) > 1; });
}

/// Removes fins: double sheets, flattened spikes, which collapses leave behind on an edge that four triangles share.
void removeFins(TriangleMesh& mesh) {
  std::map<std::uint64_t, std::vector<std::uint32_t>> trianglesAt;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      trianglesAt[edgeKey(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3])].push_back(t);
  std::vector<std::uint32_t> sizes(mesh.triangles.size(), 0);
  DisjointSets pieces(mesh.triangles.size());
  for (const auto& [edge, triangles] : trianglesAt)
    if (triangles.size() == 2) pieces.join(triangles[0], triangles[1]);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) ++sizes[pieces.find(t)];
  std::vector<bool> isFin(mesh.triangles.size(), false), isKept(mesh.triangles.size());
  for (const auto& [edge, triangles] : trianglesAt) {
    for (const std::uint32_t t : triangles)
      if (triangles.size() > 2 && sizes[pieces.find(t)] <= kFinTriangles) isFin[pieces.find(t)] = true;
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) isKept[t] = !isFin[pieces.find(t)];
  mesh = subset(mesh, isKept);
}

/// Collapses can join a surface with itself at an edge, which four triangles then share. Two of them get the edge with
/// a new vertex in its middle.
void separateJoinedEdges(TriangleMesh& mesh) {
  struct Use {
    std::uint32_t from, to;
    std::size_t triangle;
    bool operator<(const Use& other) const {
      return std::tie(from, to, triangle) < std::tie(other.from, other.to, other.triangle);
    }
  };
  std::vector<Use> uses;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) uses.push_back({mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3], t});
  std::sort(uses.begin(), uses.end());
  std::vector<bool> isDone(mesh.triangles.size(), false);
  const auto split = [&](std::size_t t, std::uint32_t from, std::uint32_t middle) {
    Triangle3& corners = mesh.triangles[t];
    std::size_t i = 0;
    while (corners[i] != from) ++i;
    const std::uint32_t to = corners[(i + 1) % 3], third = corners[(i + 2) % 3];
    corners = {from, middle, third};
    mesh.triangles.push_back({middle, to, third});
    isDone[t] = true;
  };
  for (std::size_t i = 1; i < uses.size(); ++i) {
    const Use use = uses[i];
    if (use.from != uses[i - 1].from || use.to != uses[i - 1].to || isDone[use.triangle]) continue;
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(0.5 * (mesh.positions[use.from] + mesh.positions[use.to]));
    split(use.triangle, use.from, middle);
    // Its partner is the last one that runs the other way.
    const auto after = std::upper_bound(uses.begin(), uses.end(), Use{use.to, use.from, SIZE_MAX});
    if (after == uses.begin()) continue;
    const Use partner = *(after - 1);
    if (partner.from == use.to && partner.to == use.from && !isDone[partner.triangle])
      split(partner.triangle, partner.from, middle);
  }
}

/// What positions are taken from: the middle of a mesh that is far from the origin, where floats are too coarse.
Vec3 originFor(const TriangleMesh& mesh) {
  constexpr double kFar = 100;  ///< Diagonals: up to there, floats are exact to a hundred-thousandth of one.
  const Bounds bounds = boundsOf(mesh);
  return length(bounds.middle()) > kFar * bounds.diagonal() ? bounds.middle() : Vec3{0, 0, 0};
}

/// What meshoptimizer takes.
struct Arrays {
  std::vector<float> positions;
  std::vector<unsigned char> locks;

  [[nodiscard]] std::vector<unsigned> simplified(const std::vector<unsigned>& indices, std::size_t target) const {
    if (target >= indices.size()) return indices;
    std::vector<unsigned> result(indices.size());
    constexpr float kAnyError = 1;  // The count decides.
    result.resize(meshopt_simplifyWithAttributes(result.data(), indices.data(), indices.size(), positions.data(),
                                                 locks.size(), 3 * sizeof(float), nullptr, 0, nullptr, 0, locks.data(),
                                                 target, kAnyError, 0, nullptr));
    return result;
  }
};

}  // namespace

bool simplify(const TriangleMesh& mesh, const SimplifyOptions& options, const Progress& progress, TriangleMesh& out) {
  const auto [triangles, tolerance] = options;
  Arrays arrays;
  arrays.locks.assign(mesh.positions.size(), 0);
  for (const auto& loop : boundaryLoops(mesh)) lockLoop(mesh, loop, tolerance, arrays.locks);
  arrays.positions.reserve(3 * mesh.positions.size());
  const Vec3 origin = originFor(mesh);
  for (const Vec3& p : mesh.positions) append(arrays.positions, p - origin);
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());

  // In steps, to be able to stop in between. The last one is left enough to choose from.
  const std::size_t all = indices.size();
  const std::size_t lastStep = std::max(kLastStepIndices, std::size_t{6} * triangles);
  while (indices.size() > lastStep) {
    if (!report(progress, all - indices.size(), all, "simplify")) return false;
    std::vector<unsigned> fewer = arrays.simplified(indices, std::max(indices.size() / 9 * 3, lastStep));
    const bool isStuck = fewer.size() == indices.size();
    indices.swap(fewer);
    if (isStuck) break;
  }
  indices = arrays.simplified(indices, std::size_t{3} * triangles);
  TriangleMesh simple;
  simple.positions = mesh.positions;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    simple.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  removeFlaps(simple.triangles);
  out = subset(simple, std::vector<bool>(simple.triangles.size(), true));
  removeFins(out);
  separateJoinedEdges(out);
  return report(progress, 1, "simplify");
}

}  // namespace cagecast::cages
