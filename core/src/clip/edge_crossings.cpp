#include "clip/edge_crossings.hpp"

#include <algorithm>

namespace cagecast {

EdgeCrossings::EdgeCrossings(TargetTriangle& triangle, Arena& arena) noexcept
    : triangle_(triangle),
      ranges_(arena.allocate<CrossingRange>(triangle.input.target.indices.size())),
      edges_(triangle.input.target.indices.size(), arena) {}

/// The two vertices of an edge, in either direction, as one number.
std::uint64_t EdgeCrossings::endsOf(std::uint32_t halfEdge) const noexcept {
  const std::span<const std::uint32_t> indices = triangle_.input.target.indices;
  const std::uint32_t v = indices[halfEdge];
  const std::uint32_t w = indices[HalfEdges::after(halfEdge)];
  return std::uint64_t{std::min(v, w)} << 32 | std::max(v, w);
}

CrossingRange EdgeCrossings::ofHalfEdge(std::uint32_t halfEdge, const TrianglePoint& from,
                                        const TrianglePoint& to) noexcept {
  const std::uint64_t ends = endsOf(halfEdge);
  const std::uint32_t first =
      edges_.firstEqual(halfEdge, HashIndex::mix(0, ends), [&](std::uint32_t other) { return endsOf(other) == ends; });
  CrossingRange& range = ranges_[first];
  if (first != halfEdge) return range;
  const auto begin = static_cast<std::uint32_t>(onEdges.size());
  search(from, to, onEdges);
  range = {begin, static_cast<std::uint32_t>(onEdges.size()) - begin};
  for (std::uint32_t i = begin; i < begin + range.count && !triangle_.failed(); ++i) {
    Crossing& crossing = onEdges[i];
    if (snap(crossing, from, to)) continue;
    crossing.vertex = triangle_.addVertex({from.vertex, to.vertex, from.vertex}, crossing.t, 0, crossing.isBorder);
  }
  return range;
}

void EdgeCrossings::search(const TrianglePoint& from, const TrianglePoint& to) noexcept { search(from, to, inside); }

CrossingRange EdgeCrossings::addVertices(std::size_t first, const TrianglePoint& from,
                                         const TrianglePoint& to) noexcept {
  for (std::size_t i = first; i < inside.size() && !triangle_.failed(); ++i) {
    Crossing& crossing = inside[i];
    if (snap(crossing, from, to)) continue;
    TrianglePoint point = between(from, to, crossing.t);
    triangle_.addVertex(point, crossing.isBorder);
    crossing.vertex = point.vertex;
  }
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(inside.size() - first)};
}

void EdgeCrossings::search(const TrianglePoint& from, const TrianglePoint& to, List<Crossing>& crossings) noexcept {
  Edge edge{from, to, length(to.p - from.p), crossings};
  searchPart(edge, {}, {0, from.sample}, {1, to.sample});
  triangle_.forgetLists();
}

/// Finds the borders between two points of an edge.
/// @param nearby  Of a part that contains them; empty if that is the whole edge.
void EdgeCrossings::searchPart(Edge& edge, NearbyTriangles nearby, const EdgePoint& from,
                               const EdgePoint& to) noexcept {
  BorderClassifier& classifier = triangle_.classifier;
  if (classifier.failed()) return;
  const double apart = (to.t - from.t) * edge.length;
  const bool isSeparated = classifier.separates(from.sample, to.sample);
  if (!isSeparated && apart <= triangle_.tolerances.feature) return;
  const Vec3 ends[2] = {edge.at(from.t), edge.at(to.t)};
  if (!isSeparated && classifier.clearance(from.sample, ends[0]) + classifier.clearance(to.sample, ends[1]) >= apart)
    return;
  nearby = classifier.narrow(nearby.count == 0 ? triangle_.nearby() : nearby, ends);
  if (!isSeparated && classifier.isSurelyWhole(from.sample.region, nearby, ends)) return;
  if (apart <= triangle_.tolerances.feature) return locateBorder(edge, nearby, from, to);
  const double t = (from.t + to.t) / 2;
  const EdgePoint middle{t, classifier.sample(nearby, edge.at(t))};
  searchPart(edge, nearby, from, middle);
  searchPart(edge, nearby, middle, to);
}

/// Finds the border between two points of an edge that are close to each other, by bisection.
void EdgeCrossings::locateBorder(Edge& edge, NearbyTriangles nearby, const EdgePoint& from,
                                 const EdgePoint& to) noexcept {
  BorderClassifier& classifier = triangle_.classifier;
  EdgePoint low = from, high = to;
  while ((high.t - low.t) * edge.length > triangle_.tolerances.found) {
    const double t = (low.t + high.t) / 2;
    const EdgePoint middle{t, classifier.sample(nearby, edge.at(t))};
    if (classifier.separates(low.sample, middle.sample)) {
      high = middle;
    } else if (classifier.separates(middle.sample, high.sample)) {
      low = middle;
    } else {
      return;  // The texture changes fast here, but steadily: there is no border.
    }
  }
  const double t = (low.t + high.t) / 2;
  if (edge.lastBorder >= 0) {
    const double middle = (edge.lastBorder + t) / 2;
    const BorderSample sample = classifier.sample(triangle_.nearby(), edge.at(middle));
    edge.crossings.add({middle, sample, false});
  }
  edge.crossings.add({t, low.sample, true});
  edge.lastBorder = t;
}

/// Moves a border to an end of its edge if it is close to that.
/// @return Whether it is: then it needs no vertex of its own.
bool EdgeCrossings::snap(Crossing& crossing, const TrianglePoint& from, const TrianglePoint& to) noexcept {
  const double apart = length(to.p - from.p);
  const bool isAtStart = crossing.t * apart < triangle_.tolerances.snap;
  if (!crossing.isBorder || (!isAtStart && !((1 - crossing.t) * apart < triangle_.tolerances.snap))) return false;
  crossing.t = isAtStart ? 0 : 1;
  crossing.vertex = isAtStart ? from.vertex : to.vertex;
  triangle_.out.onBorder[crossing.vertex] = 1;
  return true;
}

}  // namespace cagecast
