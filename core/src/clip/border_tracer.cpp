#include "clip/border_tracer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cagecast {
namespace {

/// How often the polyline between two crossings may be halved.
constexpr int kMaxDepth = 6;
/// Parts of the wedge whose rays are checked against the straight line.
constexpr int kRays = 8;

/// Where a ray meets the straight line between two points in polar coordinates.
template <typename Polar>
double chordOnRay(Polar from, Polar to, double s) {
  const double dx = to.x() - from.x(), dy = to.y() - from.y();
  const double area = (1 - s) * dy - s * dx;
  return area == 0 ? from.r : std::clamp((from.x() * dy - from.y() * dx) / area, 0.0, 1.0);
}

double distanceToLine(Vec3 p, Vec3 start, Vec3 end) {
  const Vec3 along = end - start;
  const Vec3 normal = cross(p - start, along);
  return std::sqrt(dot(normal, normal) / dot(along, along));
}

}  // namespace

const List<TrianglePoint>& BorderTracer::trace(const TrianglePoint (&corners)[3], const TrianglePoint& from,
                                               const TrianglePoint& to) noexcept {
  const Wedge wedge{corners[0], corners[1], corners[2]};
  line_.truncate(0);
  if (from.vertex == to.vertex) return line_;
  const auto shareOf = [&](const TrianglePoint& point, const TrianglePoint& end) {
    return length(point.p - wedge.a.p) / length(end.p - wedge.a.p);
  };
  const Polar start{0, shareOf(from, wedge.b)}, end{1, shareOf(to, wedge.c)};
  follow(wedge, triangle_.nearby(), start, end, kMaxDepth);
  return line_;
}

/// Adds the bends of the border between two of its points.
/// @param nearby  Of a part that contains the border there.
void BorderTracer::follow(const Wedge& wedge, NearbyTriangles nearby, Polar from, Polar to, int depth) noexcept {
  BorderClassifier& classifier = triangle_.classifier;
  if (depth == 0 || classifier.failed() || length(wedge.at(to) - wedge.at(from)) <= triangle_.tolerances.straight)
    return;
  const std::size_t mark = classifier.mark();
  nearby = classifier.narrow(nearby, std::array{wedge.a.p, wedge.endOfRay(from.s), wedge.endOfRay(to.s)});
  double distance = 0;
  const Polar bend = farthestBend(wedge, nearby, from, to, distance);
  if (distance > triangle_.tolerances.straight) {
    follow(wedge, nearby, from, bend, depth - 1);
    TrianglePoint point = between(wedge.a, between(wedge.b, wedge.c, bend.s), bend.r);
    point.sample = wedge.a.sample;
    triangle_.addVertex(point, true);
    line_.add(point);
    follow(wedge, nearby, bend, to, depth - 1);
  }
  classifier.rewind(mark);
}

/// Finds where the border is farthest from the straight line between two of its points.
/// @param[in,out] distance  From the line; set only if one is found that is farther.
BorderTracer::Polar BorderTracer::farthestBend(const Wedge& wedge, NearbyTriangles nearby, Polar from, Polar to,
                                               double& distance) noexcept {
  BorderClassifier& classifier = triangle_.classifier;
  const double tolerance = triangle_.tolerances.straight;
  const Vec3 start = wedge.at(from), end = wedge.at(to);
  Polar worst{};
  const auto tryRay = [&](NearbyTriangles near, double s) {
    const Polar polar{s, borderOnRay(wedge, near, s)};
    const double apart = distanceToLine(wedge.at(polar), start, end);
    if (apart <= distance) return;
    distance = apart;
    worst = polar;
  };
  // First on some rays, where the border is not within the tolerance of the line.
  double width = (to.s - from.s) / kRays;
  for (int i = 1; i < kRays; ++i) {
    const double s = from.s + i * width;
    const double r = chordOnRay(from, to, s), step = tolerance / wedge.lengthOfRay(s);
    const auto isBefore = [&](double at) { return isOnFirstSide(wedge, classifier.sample(nearby, wedge.at({s, at}))); };
    if ((r - step > 0 && !isBefore(r - step)) || (r + step < 1 && isBefore(r + step))) tryRay(nearby, s);
  }
  if (distance <= tolerance) return worst;
  // Then ever closer to the farthest.
  while (width * length(wedge.c.p - wedge.b.p) > tolerance / 4) {
    width /= 2;
    const double s = worst.s;
    const NearbyTriangles near =
        classifier.narrow(nearby, std::array{wedge.a.p, wedge.endOfRay(s - width), wedge.endOfRay(s + width)});
    tryRay(near, s - width);
    tryRay(near, s + width);
  }
  return worst;
}

/// Finds how far along a ray the border is, by bisection.
double BorderTracer::borderOnRay(const Wedge& wedge, NearbyTriangles nearby, double s) noexcept {
  BorderClassifier& classifier = triangle_.classifier;
  const double rayLength = wedge.lengthOfRay(s);
  const std::size_t mark = classifier.mark();
  double low = 0, high = 1;
  for (std::uint32_t step = 0; (high - low) * rayLength > triangle_.tolerances.found; ++step) {
    if (step % 4 == 0 && nearby.count > 2)
      nearby = classifier.narrow(nearby, std::array{wedge.at({s, low}), wedge.at({s, high})});
    const double middle = (low + high) / 2;
    (isOnFirstSide(wedge, classifier.sample(nearby, wedge.at({s, middle}))) ? low : high) = middle;
  }
  classifier.rewind(mark);
  return (low + high) / 2;
}

/// Whether a point is on the same side of the border as the wedge's first corner.
bool BorderTracer::isOnFirstSide(const Wedge& wedge, const BorderSample& sample) const noexcept {
  const BorderSample& a = wedge.a.sample;
  const BorderSample& b = wedge.b.sample;
  if (sample.region != a.region || a.region != b.region) return sample.region == a.region;
  // The same chart on both sides: the side whose UVs are closer.
  const auto squaredInUv = [&](const BorderSample& other) {
    const double u = sample.uv.u - other.uv.u;
    const double v = sample.uv.v - other.uv.v;
    return u * u + v * v;
  };
  return squaredInUv(a) < squaredInUv(b);
}

}  // namespace cagecast
