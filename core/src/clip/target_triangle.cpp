#include "clip/target_triangle.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast {

double longestEdge(const TrianglePoint* corners) noexcept {
  return std::max(
      {length(corners[1].p - corners[0].p), length(corners[2].p - corners[1].p), length(corners[0].p - corners[2].p)});
}

TargetTriangle::TargetTriangle(const ClipInput& clipInput, BorderClassifier& borderClassifier,
                               ClippedTriangles& triangles, Arena& arena) noexcept
    : input(clipInput),
      tolerances(ClipTolerances{}.scaledBy(clipInput.diagonal)),
      classifier(borderClassifier),
      out(triangles),
      vertexCount_(static_cast<std::uint32_t>(clipInput.target.positions.size() / 3)),
      samples_(arena.allocate<BorderSample>(vertexCount_)) {
  if (arena.failed()) return;
  for (std::uint32_t v = 0; v < vertexCount_; ++v) {
    samples_[v] = input.takesPart[v] != 0 ? classifier.sample(positionOf(v)) : BorderSample{};
    out.onBorder.add(0);
  }
}

void TargetTriangle::begin(std::uint32_t triangle) noexcept {
  number_ = triangle;
  nearby_ = {};
  classifier.rewind(0);
}

TrianglePoint TargetTriangle::corner(int k) const noexcept {
  const std::uint32_t vertex = vertices()[k];
  return {positionOf(vertex), static_cast<double>(k == 1), static_cast<double>(k == 2), samples_[vertex], vertex};
}

NearbyTriangles TargetTriangle::nearby() noexcept {
  if (nearby_.count > 0) return nearby_;
  Vec3 corners[3];
  double distance = 0;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = vertices()[k];
    corners[k] = positionOf(v);
    if (input.takesPart[v] != 0) distance = length(corners[k] - samples_[v].closest);
  }
  // The centroid is closer to any corner than two edges are long together.
  distance += length(corners[1] - corners[0]);
  distance += length(corners[2] - corners[1]);
  return nearby_ = classifier.listNearby(corners, distance);
}

void TargetTriangle::restore(NearbyTriangles before) noexcept {
  // What was listed for the whole triangle meanwhile stays.
  if (before.count == 0) return;
  nearby_ = before;
  forgetLists();
}

std::uint32_t TargetTriangle::addVertex(const std::uint32_t (&sources)[3], double v, double w,
                                        bool isOnBorder) noexcept {
  const double second = std::round(v / kWeightUnit) * kWeightUnit;
  const double third = std::round(w / kWeightUnit) * kWeightUnit;
  for (const std::uint32_t source : sources) out.sources.add(source);
  for (const double weight : {1 - second - third, second, third}) out.weights.add(static_cast<float>(weight));
  out.onBorder.add(isOnBorder);
  return static_cast<std::uint32_t>(out.onBorder.size() - 1);
}

void TargetTriangle::addVertex(TrianglePoint& point, bool isOnBorder) noexcept {
  point.vertex = addVertex({vertices()[0], vertices()[1], vertices()[2]}, point.v, point.w, isOnBorder);
}

void TargetTriangle::addMidpoints(TrianglePoint (&points)[6], NearbyTriangles near) noexcept {
  for (int k = 0; k < 3; ++k) {
    points[3 + k] = between(points[k], points[(k + 1) % 3], 0.5);
    points[3 + k].sample = classifier.sample(near, points[3 + k].p);
  }
}

double TargetTriangle::depthInside(Vec3 p, const TrianglePoint (&corners)[3], int k) const noexcept {
  const Vec3 edge = corners[(k + 1) % 3].p - corners[k].p;
  const Vec3 normal = cross(edge, p - corners[k].p);
  return std::sqrt(dot(normal, normal) / dot(edge, edge)) / (tolerances.feature / 2);
}

bool TargetTriangle::isWellInside(Vec3 p, const TrianglePoint (&corners)[3]) const noexcept {
  return depthInside(p, corners, 0) > 1 && depthInside(p, corners, 1) > 1 && depthInside(p, corners, 2) > 1;
}

}  // namespace cagecast
