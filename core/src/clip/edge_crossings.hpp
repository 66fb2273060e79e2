#pragma once

#include "base/hash_index.hpp"
#include "base/list.hpp"
#include "clip/target_triangle.hpp"

namespace cagecast {

/// Where an edge is divided.
struct Crossing {
  double t;             ///< From its start, 0, to its end, 1.
  BorderSample sample;  ///< Of the region before a border, or of the point itself.
  /// False for a point between two borders. It divides the edge into parts with one border each.
  bool isBorder;
  std::uint32_t vertex = kNoVertex;
};

/// A part of a list of crossings.
struct CrossingRange {
  std::uint32_t first = 0, count = 0;
};

/// Finds where borders cross edges.
///
/// What is found on an edge of the target depends on the two ends alone, in an order that depends on their positions
/// alone. So it is the same, to the bit, for all triangles that share the edge, also where its vertices are split.
class EdgeCrossings {
 public:
  /// Allocates its memory from `arena`; check `arena.failed()` afterwards.
  EdgeCrossings(TargetTriangle& triangle, Arena& arena) noexcept;

  /// Finds the crossings of an edge of the target, in `onEdges`, and adds their vertices. Each edge is searched once.
  /// @param halfEdge   3 · triangle + k.
  /// @param from,to    Its ends, ordered by position.
  CrossingRange ofHalfEdge(std::uint32_t halfEdge, const TrianglePoint& from, const TrianglePoint& to) noexcept;
  /// Adds the crossings of a line inside the triangle to the end of `inside`, without vertices.
  void search(const TrianglePoint& from, const TrianglePoint& to) noexcept;
  /// Adds the vertices of the crossings of a line inside the triangle.
  /// @param first  Of these in `inside`, up to its end.
  CrossingRange addVertices(std::size_t first, const TrianglePoint& from, const TrianglePoint& to) noexcept;

  [[nodiscard]] bool failed() const noexcept { return onEdges.failed() || inside.failed(); }

  List<Crossing> onEdges;  ///< Of edges of the target.
  List<Crossing> inside;   ///< Of lines inside the triangle.

 private:
  /// A point on the edge at hand.
  struct EdgePoint {
    double t;
    BorderSample sample;
  };
  /// The edge that is being searched.
  struct Edge {
    const TrianglePoint& from;
    const TrianglePoint& to;
    double length;
    List<Crossing>& crossings;
    double lastBorder = -1;
    [[nodiscard]] Vec3 at(double t) const { return between(from.p, to.p, t); }
  };

  void search(const TrianglePoint& from, const TrianglePoint& to, List<Crossing>& crossings) noexcept;
  void searchPart(Edge& edge, NearbyTriangles nearby, const EdgePoint& from, const EdgePoint& to) noexcept;
  void locateBorder(Edge& edge, NearbyTriangles nearby, const EdgePoint& from, const EdgePoint& to) noexcept;
  [[nodiscard]] bool snap(Crossing& crossing, const TrianglePoint& from, const TrianglePoint& to) noexcept;
  [[nodiscard]] std::uint64_t endsOf(std::uint32_t halfEdge) const noexcept;

  TargetTriangle& triangle_;
  CrossingRange* ranges_;  ///< 1 per half-edge of the target: in `onEdges`; only of the first half-edge of each edge.
  HashIndex edges_;
};

}  // namespace cagecast
