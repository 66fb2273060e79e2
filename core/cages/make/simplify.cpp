#include "make/simplify.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace cagecast::cages {

namespace {

/// A loop keeps so many vertices at least and at most,
constexpr std::size_t kLeastLocks = 5;
constexpr std::size_t kMostLocks = 24;
/// and between these as many as it takes to stay this close to it, as a share of its size.
constexpr double kLoopError = 0.04;

/// Indices from which on one call does the rest: a few tens of milliseconds.
constexpr std::size_t kLastStep = std::size_t{3} * 15000;

double distanceToChord(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 chord = b - a;
  const double square = dot(chord, chord);
  const double share = square > 0 ? std::clamp(dot(p - a, chord) / square, 0.0, 1.0) : 0;
  return length(p - (a + share * chord));
}

/// The place in a loop that is farthest from a point.
std::size_t farthestFrom(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop, const Vec3& point) {
  std::size_t farthest = 0;
  double most = -1;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double distance = length(mesh.positions[loop[i]] - point);
    if (distance <= most) continue;
    most = distance;
    farthest = i;
  }
  return farthest;
}

/// Locks the vertices of a loop that keep its shape best: the one farthest from the polygon so far, again and again
/// (Ramer 1972; Douglas, Peucker 1973).
void lockLoop(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop, double tolerance,
              std::vector<unsigned char>& locks) {
  Vec3 middle{0, 0, 0};
  for (const std::uint32_t v : loop) middle = middle + 1 / static_cast<double>(loop.size()) * mesh.positions[v];
  const auto at = [&](std::size_t i) -> const Vec3& { return mesh.positions[loop[i % loop.size()]]; };
  std::vector<std::size_t> chosen = {farthestFrom(mesh, loop, middle)};
  chosen.push_back(farthestFrom(mesh, loop, at(chosen[0])));
  const double size = length(at(chosen[0]) - at(chosen[1]));
  while (chosen.size() < std::min(kMostLocks, loop.size())) {
    std::sort(chosen.begin(), chosen.end());
    double most = -1;
    std::size_t next = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const std::size_t from = chosen[k], to = k + 1 < chosen.size() ? chosen[k + 1] : chosen[0] + loop.size();
      for (std::size_t i = from + 1; i < to; ++i) {
        const double distance = distanceToChord(at(i), at(from), at(to));
        if (distance <= most) continue;
        most = distance;
        next = i % loop.size();
      }
    }
    if (chosen.size() >= kLeastLocks && most < std::min(tolerance, kLoopError * size)) break;
    chosen.push_back(next);
  }
  for (const std::size_t i : chosen) locks[loop[i]] = 1;
}

/// Removes pairs of triangles with the same corners, which collapses leave behind as flaps on an edge.
void removeFlaps(std::vector<Triangle3>& triangles) {
  std::vector<std::pair<Triangle3, std::size_t>> sorted;
  sorted.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle3 corners = triangles[t];
    std::sort(corners.begin(), corners.end());
    sorted.emplace_back(corners, t);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> isFlap(triangles.size(), false);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i].first == sorted[i - 1].first) isFlap[sorted[i].second] = isFlap[sorted[i - 1].second] = true;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!isFlap[t]) triangles[kept++] = triangles[t];
  triangles.resize(kept);
}

float stageDone(std::size_t indices, std::size_t goal, std::size_t all) {
  return 1 - static_cast<float>(indices - goal) / static_cast<float>(all);
}

}  // namespace

bool simplify(const TriangleMesh& mesh, const SimplifyOptions& options, const Progress& progress, TriangleMesh& out) {
  const auto [triangles, tolerance] = options;
  std::vector<unsigned char> locks(mesh.positions.size(), 0);
  for (const auto& loop : boundaryLoops(mesh)) lockLoop(mesh, loop, tolerance, locks);
  std::vector<float> positions;
  positions.reserve(3 * mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const std::size_t goal = std::size_t{3} * triangles;
  for (std::size_t target = indices.size(); target > goal && indices.size() > goal;) {
    if (progress && !progress(stageDone(indices.size(), goal, 3 * mesh.triangles.size()), "simplify")) return false;
    // In steps, to be able to stop in between. The last one is left enough to choose from.
    target = indices.size() > kLastStep ? std::max(indices.size() / 9 * 3, kLastStep) : goal;
    std::vector<unsigned> result(indices.size());
    constexpr float kAnyError = 1;  // The count decides.
    const std::size_t count = meshopt_simplifyWithAttributes(
        result.data(), indices.data(), indices.size(), positions.data(), mesh.positions.size(), 3 * sizeof(float),
        nullptr, 0, nullptr, 0, locks.data(), target, kAnyError, 0, nullptr);
    result.resize(count);
    const bool isStuck = count == indices.size() && target != goal;
    indices.swap(result);
    if (isStuck) break;
  }
  TriangleMesh simple;
  simple.positions = mesh.positions;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    simple.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  removeFlaps(simple.triangles);
  out = subset(simple, std::vector<bool>(simple.triangles.size(), true));
  return true;
}

}  // namespace cagecast::cages
