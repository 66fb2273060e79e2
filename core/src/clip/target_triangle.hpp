#pragma once

#include <cstdint>

#include "base/list.hpp"
#include "clip/border_classifier.hpp"

namespace cagecast {

/// Weights are whole multiples of this, so that they add up to 1 exactly.
inline constexpr double kWeightUnit = 1.0 / (1 << 24);

/// The target of one pass of the clip step.
struct ClipInput {
  MeshView target;
  double scale;                   ///< Multiplies its positions.
  double diagonal;                ///< Of the target before any pass, scaled.
  const std::uint8_t* takesPart;  ///< 1 per vertex: an edge is cut if both its ends have 1 here.
};

/// A target whose triangles are cut. Its vertices keep their numbers, and new ones follow.
struct ClippedTriangles {
  List<std::uint32_t> sources;  ///< 3 per new vertex: the vertices that it blends.
  List<float> weights;          ///< 3 per new vertex.
  List<std::uint8_t> onBorder;  ///< 1 per vertex: 1 if it lies on a border.
  List<std::uint32_t> indices;  ///< 3 per triangle.
  List<std::uint32_t> origins;  ///< 1 per triangle: the triangle of the target that it is a part of.
  List<std::uint32_t> regions;  ///< 1 per triangle: `BorderSample::region`.

  [[nodiscard]] bool failed() const noexcept {
    return sources.failed() || weights.failed() || onBorder.failed() || indices.failed() || origins.failed() ||
           regions.failed();
  }
};

/// docs/borders.md: lengths, as shares of the diagonal.
struct ClipTolerances {
  double feature = 5e-4;     ///< What is smaller may be missed.
  double straight = 2.5e-4;  ///< How far a border may be from the cut that follows it.
  double found = 1e-7;       ///< How exactly a point on a border is found.
  double snap = 1e-5;        ///< A border this close to a vertex is moved there, so that no triangle gets thinner.
  double removed = 5e-5;     ///< How far a border may move in all where vertices on it are removed.
  /// A polygon no wider than this is not divided around its centre: its parts would get ever thinner.
  double thin = 1e-4;

  [[nodiscard]] ClipTolerances scaledBy(double diagonal) const noexcept {
    return {feature * diagonal, straight * diagonal, found * diagonal,
            snap * diagonal,    removed * diagonal,  thin * diagonal};
  }
};

inline constexpr std::uint32_t kNoVertex = UINT32_MAX;

/// A point on the target triangle that is being cut.
struct TrianglePoint {
  Vec3 p;       ///< Scaled.
  double v, w;  ///< Weights of the triangle's second and third corner.
  BorderSample sample;
  std::uint32_t vertex = kNoVertex;
};

/// The point between two others.
inline Vec3 between(Vec3 a, Vec3 b, double t) { return a + t * (b - a); }
inline TrianglePoint between(const TrianglePoint& a, const TrianglePoint& b, double t) {
  TrianglePoint out{};
  out.p = between(a.p, b.p, t);
  out.v = a.v + t * (b.v - a.v);
  out.w = a.w + t * (b.w - a.w);
  return out;
}

/// The area of a triangle as a share of the target triangle's; positive if both have the same orientation.
inline double signedArea(const TrianglePoint& a, const TrianglePoint& b, const TrianglePoint& c) {
  return (b.v - a.v) * (c.w - a.w) - (b.w - a.w) * (c.v - a.v);
}

double longestEdge(const TrianglePoint* corners) noexcept;

/// The four similar parts of a triangle, by its corners 0, 1, 2 and the midpoints 3, 4, 5 of its edges.
inline constexpr int kQuarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

/// The target triangle that is being cut, with what the parts of the clip step share.
class TargetTriangle {
 public:
  /// Classifies the vertices that take part. Allocates its memory from `arena`; check `arena.failed()` afterwards.
  TargetTriangle(const ClipInput& input, BorderClassifier& classifier, ClippedTriangles& out, Arena& arena) noexcept;

  /// Goes on to a triangle.
  void begin(std::uint32_t triangle) noexcept;
  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  /// Its three vertices.
  [[nodiscard]] const std::uint32_t* vertices() const noexcept {
    return input.target.indices.data() + std::size_t{3} * number_;
  }
  [[nodiscard]] TrianglePoint corner(int k) const noexcept;
  /// Number of vertices of the target.
  [[nodiscard]] std::uint32_t vertexCount() const noexcept { return vertexCount_; }

  /// The cage triangles near the part at hand, at first the whole triangle. They are listed on the first call, before
  /// anything else in the classifier's list.
  NearbyTriangles nearby() noexcept;
  /// The same, but empty if they were not listed yet.
  [[nodiscard]] NearbyTriangles nearbyIfListed() const noexcept { return nearby_; }
  /// Narrows them to a smaller part at hand.
  void narrow(Hull hull) noexcept { nearby_ = classifier.narrow(nearby_, hull); }
  /// Returns to the part that `nearbyIfListed` belonged to.
  void restore(NearbyTriangles before) noexcept;
  /// Forgets what the classifier listed since.
  void forgetLists() noexcept { classifier.rewind(nearby_.end()); }

  /// Adds a vertex.
  /// @param sources  The vertices that it blends.
  /// @param v,w      Weights of the second and the third one.
  std::uint32_t addVertex(const std::uint32_t (&sources)[3], double v, double w, bool isOnBorder) noexcept;
  /// Adds a vertex at a point inside the triangle.
  void addVertex(TrianglePoint& point, bool isOnBorder) noexcept;
  /// Adds the midpoints of a triangle's edges to its corners, and classifies them.
  void addMidpoints(TrianglePoint (&points)[6], NearbyTriangles near) noexcept;

  /// The distance of a point from edge k of a triangle, as a multiple of what borders may be off.
  [[nodiscard]] double depthInside(Vec3 p, const TrianglePoint (&corners)[3], int k) const noexcept;
  /// Whether a point is farther from all edges of a triangle than borders may be off.
  [[nodiscard]] bool isWellInside(Vec3 p, const TrianglePoint (&corners)[3]) const noexcept;

  [[nodiscard]] bool failed() const noexcept { return out.failed() || classifier.failed(); }

  const ClipInput input;
  const ClipTolerances tolerances;  ///< Scaled.
  BorderClassifier& classifier;
  ClippedTriangles& out;

 private:
  [[nodiscard]] Vec3 positionOf(std::uint32_t vertex) const noexcept {
    return input.scale * Vec3::from(input.target.positions.data() + std::size_t{3} * vertex);
  }

  std::uint32_t vertexCount_;
  BorderSample* samples_;  ///< 1 per vertex; only of those that take part.
  std::uint32_t number_ = 0;
  NearbyTriangles nearby_;
};

}  // namespace cagecast
