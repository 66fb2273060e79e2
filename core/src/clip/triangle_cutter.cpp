#include "clip/triangle_cutter.hpp"

#include <algorithm>
#include <initializer_list>

#include "clip/border_tracer.hpp"
#include "clip/edge_crossings.hpp"
#include "clip/enclosed_search.hpp"
#include "clip/piece_builder.hpp"
#include "clip/piece_merger.hpp"

namespace cagecast {
namespace {

/// How often a triangle is divided around a point inside, at most,
constexpr int kMaxDivisions = 2048;
/// and how deep these divisions are nested.
constexpr int kMaxNesting = 48;
/// Areas below this, as shares of the triangle's, count as none.
constexpr double kFlat = 1e-12;

/// A corner of a polygon inside the triangle that is being cut.
struct PolygonCorner {
  TrianglePoint point;
  TrianglePoint border;  ///< The crossing on the way to the next corner, if there is one.
  bool isCrossed;
};

bool isBefore(Vec3 a, Vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

/// Cuts one triangle after the other.
///
/// A triangle becomes a polygon, as points between two borders on an edge are corners too. The polygon is divided until
/// there are triangles with at most one border on each edge, which are cut along these.
class TriangleCutter {
 public:
  TriangleCutter(const ClipInput& input, BorderClassifier& classifier, Arena& arena, ClippedTriangles& out) noexcept
      : triangle_(input, classifier, out, arena),
        crossings_(triangle_, arena),
        tracer_(triangle_),
        builder_(triangle_),
        merger_(triangle_),
        enclosed_(triangle_) {}

  void cutAll() noexcept {
    const auto count = static_cast<std::uint32_t>(triangle_.input.target.indices.size() / 3);
    for (std::uint32_t t = 0; t < count && !failed(); ++t) cut(t);
  }

  [[nodiscard]] bool failed() const noexcept {
    return triangle_.failed() || crossings_.failed() || tracer_.failed() || builder_.failed() || merger_.failed() ||
           enclosed_.failed() || spokes_.failed() || polygons_.failed() || hull_.failed();
  }

 private:
  void cut(std::uint32_t t) noexcept {
    triangle_.begin(t);
    builder_.forget();
    polygons_.truncate(0);
    crossings_.inside.truncate(0);
    const TrianglePoint corners[3] = {triangle_.corner(0), triangle_.corner(1), triangle_.corner(2)};
    const std::uint32_t* v = triangle_.vertices();
    // A triangle with two equal corners is no more than an edge, and stays.
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return builder_.add(corners, 0);
    const auto takesPart = [&](const TrianglePoint& corner) { return triangle_.input.takesPart[corner.vertex] != 0; };
    for (std::uint32_t k = 0; k < 3; ++k) {
      const TrianglePoint& from = corners[k];
      const TrianglePoint& to = corners[(k + 1) % 3];
      const bool isForward = isBefore(from.p, to.p);
      CrossingRange range;
      if (takesPart(from) && takesPart(to) && (isForward || isBefore(to.p, from.p)))
        range = crossings_.ofHalfEdge(3 * t + k, isForward ? from : to, isForward ? to : from);
      addEdge({from, to}, crossings_.onEdges, range, isForward);
    }
    if (failed()) return;
    const Vec3 normal = cross(corners[1].p - corners[0].p, corners[2].p - corners[0].p);
    if (std::all_of(corners, corners + 3, takesPart) && dot(normal, normal) > 0) {
      divisions_ = kMaxDivisions;
      merger_.start();
      divide(0, polygons_.size());
      if (!failed()) merger_.merge();
    } else {
      // It only gets what its neighbours need: the vertices on its edges.
      addUndivided(0, polygons_.size());
    }
  }

  // Polygons are ranges of `polygons_`. One that is divided further is the last there.

  /// The corners of an edge.
  struct Edge {
    TrianglePoint from, to;
  };

  /// Adds the first corner of an edge to the polygon, and what divides the edge: points between borders become corners.
  /// @param isForward  Whether the crossings are in the direction of the edge.
  void addEdge(const Edge& edge, const List<Crossing>& crossings, CrossingRange range, bool isForward) noexcept {
    polygons_.add({edge.from, {}, false});
    for (std::uint32_t i = 0; i < range.count && !failed(); ++i) {
      const Crossing& crossing = crossings[isForward ? range.first + i : range.first + range.count - 1 - i];
      TrianglePoint point =
          isForward ? between(edge.from, edge.to, crossing.t) : between(edge.to, edge.from, crossing.t);
      point.sample = crossing.sample;
      point.vertex = crossing.vertex;
      if (crossing.isBorder) {
        polygons_[polygons_.size() - 1].border = point;
        polygons_[polygons_.size() - 1].isCrossed = true;
      } else {
        polygons_.add({point, {}, false});
      }
    }
  }

  /// Cuts a convex polygon, and removes it from `polygons_`.
  void divide(std::size_t first, std::size_t count) noexcept {
    const NearbyTriangles before = triangle_.nearbyIfListed();
    hull_.truncate(0);
    for (std::size_t i = first; i < first + count; ++i) hull_.add(polygons_[i].point.p);
    if (!failed()) {
      triangle_.narrow({&hull_[0], count});
      if (count == 3)
        divideTriangle(first);
      else
        divideAcross(first, count);
    }
    polygons_.truncate(first);
    triangle_.restore(before);
  }

  /// Divides a polygon along the shortest line between two corners that have half of the others on either side.
  void divideAcross(std::size_t first, std::size_t count) noexcept {
    const std::size_t half = count / 2, none = first + count;
    std::size_t from = none;
    double shortest = 0;
    for (std::size_t i = first; i + half < none; ++i) {
      const double apart = length(polygons_[i + half].point.p - polygons_[i].point.p);
      if ((from < none && apart >= shortest) || !dividesArea(first, count, i, i + half)) continue;
      shortest = apart;
      from = i;
    }
    if (from == none) return addUndivided(first, count);  // All corners are on one line.
    const std::size_t to = from + half;
    const TrianglePoint start = polygons_[from].point, end = polygons_[to].point;
    const std::size_t begin = crossings_.inside.size();
    crossings_.search(start, end);
    // Points between borders become corners of both parts: there must be fewer than the other part takes away.
    if (crossings_.inside.size() - begin > 2 * half - 3) {
      crossings_.inside.truncate(begin);
      if (mayDivideAround() && !isThin(first, count)) return divideAround(first, count, centroid(first, count));
    }
    const CrossingRange range = crossings_.addVertices(begin, start, end);
    const std::size_t near = polygons_.size();
    for (std::size_t i = from; i < to; ++i) polygons_.add(PolygonCorner(polygons_[i]));
    addEdge({end, start}, crossings_.inside, range, false);
    const std::size_t far = polygons_.size();
    for (std::size_t i = to; i < from + count; ++i)
      polygons_.add(PolygonCorner(polygons_[first + (i - first) % count]));
    addEdge({start, end}, crossings_.inside, range, true);
    divide(far, polygons_.size() - far);
    divide(near, polygons_.size() - near);
    crossings_.inside.truncate(begin);
  }

  /// The mean of a polygon's corners. Everything between it and them is smaller than the polygon.
  [[nodiscard]] TrianglePoint centroid(std::size_t first, std::size_t count) noexcept {
    TrianglePoint centre = polygons_[first].point;
    for (std::size_t i = 1; i < count; ++i)
      centre = between(centre, polygons_[first + i].point, 1.0 / static_cast<double>(i + 1));
    centre.sample = triangle_.classifier.sample(triangle_.nearby(), centre.p);
    return centre;
  }

  /// Whether a polygon is too thin to be divided around its centre.
  [[nodiscard]] bool isThin(std::size_t first, std::size_t count) const noexcept {
    double doubleArea = 0, longest = 0;
    for (std::size_t i = first + 1; i < first + count; ++i) {
      const Vec3 along = polygons_[i].point.p - polygons_[first].point.p;
      const Vec3 before = polygons_[i - 1].point.p - polygons_[first].point.p;
      doubleArea += length(cross(before, along));
      longest = std::max(longest, length(along));
    }
    return doubleArea <= triangle_.tolerances.thin * longest;
  }

  /// Whether a line between two corners of a polygon divides its area.
  [[nodiscard]] bool dividesArea(std::size_t first, std::size_t count, std::size_t i, std::size_t j) const noexcept {
    double least = 0, most = 0;
    for (std::size_t k = first; k < first + count; ++k) {
      const double area = signedArea(polygons_[i].point, polygons_[j].point, polygons_[k].point);
      least = std::min(least, area);
      most = std::max(most, area);
    }
    return least < -kFlat && most > kFlat;
  }

  /// Cuts a triangle, and divides it instead if that misses something inside.
  void divideTriangle(std::size_t first) noexcept {
    const std::size_t vertices = triangle_.out.onBorder.size(), triangles = triangle_.out.origins.size();
    const std::size_t kept = merger_.mark();
    const PolygonCorner corners[3] = {polygons_[first], polygons_[first + 1], polygons_[first + 2]};
    TrianglePoint missed{};
    if (cutSimple(corners, missed) || !mayDivideAround()) return;
    forget(vertices, triangles);
    merger_.rewind(kept);
    divideAround(first, 3, missed);
  }

  [[nodiscard]] bool mayDivideAround() const noexcept { return divisions_ > 0 && depth_ < kMaxNesting; }

  /// Divides a polygon along the lines between its corners and a point inside.
  void divideAround(std::size_t first, std::size_t count, TrianglePoint centre) noexcept {
    --divisions_;
    ++depth_;
    triangle_.addVertex(centre, false);
    const std::size_t begin = crossings_.inside.size(), firstSpoke = spokes_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const TrianglePoint corner = polygons_[first + i].point;
      const std::size_t start = crossings_.inside.size();
      crossings_.search(corner, centre);
      spokes_.add(crossings_.addVertices(start, corner, centre));
    }
    for (std::size_t i = 0; i < count && !failed(); ++i) {
      const std::size_t next = (i + 1) % count;
      const std::size_t part = polygons_.size();
      polygons_.add(PolygonCorner(polygons_[first + i]));
      addEdge({polygons_[first + next].point, centre}, crossings_.inside, spokes_[firstSpoke + next], true);
      addEdge({centre, polygons_[first + i].point}, crossings_.inside, spokes_[firstSpoke + i], false);
      divide(part, polygons_.size() - part);
    }
    spokes_.truncate(firstSpoke);
    crossings_.inside.truncate(begin);
    --depth_;
  }

  /// Removes the vertices and triangles that were added last.
  void forget(std::size_t vertices, std::size_t triangles) noexcept {
    ClippedTriangles& out = triangle_.out;
    out.sources.truncate(3 * (vertices - triangle_.vertexCount()));
    out.weights.truncate(3 * (vertices - triangle_.vertexCount()));
    out.onBorder.truncate(vertices);
    out.indices.truncate(3 * triangles);
    out.origins.truncate(triangles);
    out.regions.truncate(triangles);
  }

  /// Triangulates a polygon as it is.
  void addUndivided(std::size_t first, std::size_t count) noexcept {
    builder_.startPolygon();
    for (std::size_t i = first; i < first + count; ++i) {
      builder_.addCorner(polygons_[i].point);
      if (polygons_[i].isCrossed) builder_.addCorner(polygons_[i].border);
    }
    builder_.finishPolygon(polygons_[first].point.sample.region);
  }

  /// Cuts a triangle with at most one border on each edge.
  /// @return false if that misses a region: then `missed` is a point in it.
  bool cutSimple(const PolygonCorner (&polygon)[3], TrianglePoint& missed) noexcept {
    builder_.forget();
    const TrianglePoint corners[3] = {polygon[0].point, polygon[1].point, polygon[2].point};
    const int crossed = polygon[0].isCrossed + polygon[1].isCrossed + polygon[2].isCrossed;
    if (crossed == 0) {
      addPolygon(corners[0].sample.region, {corners[0], corners[1], corners[2]});
      return isClear(corners) || !enclosed_.find(builder_.pieces(), missed);
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3, m = (k + 2) % 3;
      if (crossed == 1 && polygon[k].isCrossed) {
        cutToCorner({corners[k], corners[l], corners[m]}, polygon[k].border);
        return !enclosed_.find(builder_.pieces(), missed);
      }
      if (crossed == 2 && !polygon[l].isCrossed) {
        cutOffCorner({corners[k], corners[l], corners[m]}, polygon[k].border, polygon[m].border);
        return !enclosed_.find(builder_.pieces(), missed);
      }
    }
    // Three borders that meet.
    TrianglePoint meeting{};
    const bool isSimple = findMeeting(corners, meeting);
    if (!isSimple) missed = meeting;
    triangle_.addVertex(meeting, true);
    for (std::uint32_t k = 0; k < 3; ++k)
      cutOffCorner({corners[k], corners[(k + 1) % 3], meeting}, polygon[k].border, meeting);
    return isSimple && !enclosed_.find(builder_.pieces(), missed);
  }

  void addPolygon(std::uint32_t region, std::initializer_list<TrianglePoint> corners) noexcept {
    builder_.startPolygon();
    for (const TrianglePoint& corner : corners) builder_.addCorner(corner);
    builder_.finishPolygon(region);
  }

  /// Whether surely no point of a triangle is closest to a boundary loop: each is within the clearance of a corner.
  [[nodiscard]] bool isClear(const TrianglePoint (&corners)[3]) noexcept {
    // No point is farther from all corners than this share of the longest edge: 1 / √3 where all edges are equal, and
    // less elsewhere.
    constexpr double kFarthest = 0.58;
    const double enough = kFarthest * longestEdge(corners);
    return std::all_of(corners, corners + 3, [&](const TrianglePoint& corner) {
      return triangle_.classifier.clearance(corner.sample, corner.p) >= enough;
    });
  }

  /// Cuts a triangle from a border on its first edge, which ends inside, to the opposite corner.
  void cutToCorner(const TrianglePoint (&corners)[3], const TrianglePoint& border) noexcept {
    const auto& [a, b, c] = corners;
    const auto regionBeside = [&, &opposite = c](const TrianglePoint& corner) {
      return (border.vertex == corner.vertex ? opposite : corner).sample.region;
    };
    addPolygon(regionBeside(a), {a, border, c});
    addPolygon(regionBeside(b), {border, b, c});
  }

  /// Cuts a triangle along the border between its first corner and the other two.
  /// @param from,to  Where that border meets the two edges; `to` may be the last corner.
  void cutOffCorner(const TrianglePoint (&corners)[3], const TrianglePoint& from, const TrianglePoint& to) noexcept {
    const auto& [a, b, c] = corners;
    const List<TrianglePoint>& line = tracer_.trace(corners, from, to);
    if (a.sample.region == b.sample.region) {
      merger_.keep(from.vertex);
      merger_.keep(to.vertex);
      for (std::size_t i = 0; i < line.size(); ++i) merger_.keep(line[i].vertex);
    }
    builder_.startPolygon();
    builder_.addCorner(a);
    builder_.addCorner(from);
    for (std::size_t i = 0; i < line.size(); ++i) builder_.addCorner(line[i]);
    builder_.addCorner(to);
    builder_.finishPolygon(a.sample.region);
    builder_.startPolygon();
    for (const TrianglePoint* corner : {&from, &b, &c, &to}) builder_.addCorner(*corner);
    for (std::size_t i = line.size(); i-- > 0;) builder_.addCorner(line[i]);
    builder_.finishPolygon(b.sample.region);
  }

  /// Finds where the borders between the regions of a triangle's three corners meet, in ever smaller quarters.
  /// @return false if they do not simply meet: then `meeting` is a point inside, in another region than both corners of
  /// its edge.
  bool findMeeting(const TrianglePoint (&corners)[3], TrianglePoint& meeting) noexcept {
    TrianglePoint t[6] = {corners[0], corners[1], corners[2]};
    const auto areSeparated = [&](const TrianglePoint& a, const TrianglePoint& b) {
      return triangle_.classifier.separates(a.sample, b.sample);
    };
    while (longestEdge(t) > triangle_.tolerances.found) {
      triangle_.addMidpoints(t, triangle_.nearby());
      const auto* quarter = std::find_if(std::begin(kQuarters), std::end(kQuarters), [&](const int(&q)[3]) {
        return areSeparated(t[q[0]], t[q[1]]) && areSeparated(t[q[1]], t[q[2]]) && areSeparated(t[q[2]], t[q[0]]);
      });
      if (quarter == std::end(kQuarters)) {
        for (int k = 0; k < 3; ++k) {
          const TrianglePoint& midpoint = t[3 + k];
          if (areSeparated(midpoint, t[k]) && areSeparated(midpoint, t[(k + 1) % 3]) &&
              triangle_.isWellInside(midpoint.p, corners)) {
            meeting = midpoint;
            return false;
          }
        }
        break;
      }
      const TrianglePoint smaller[3] = {t[(*quarter)[0]], t[(*quarter)[1]], t[(*quarter)[2]]};
      std::copy(smaller, smaller + 3, t);
    }
    meeting = between(between(t[0], t[1], 0.5), t[2], 1.0 / 3);
    meeting.sample = t[0].sample;
    return true;
  }

  TargetTriangle triangle_;
  EdgeCrossings crossings_;
  BorderTracer tracer_;
  PieceBuilder builder_;
  PieceMerger merger_;
  EnclosedSearch enclosed_;
  List<PolygonCorner> polygons_;
  List<Vec3> hull_;             ///< The corners of the polygon at hand.
  List<CrossingRange> spokes_;  ///< Of lines between the corners and the centre of a polygon.
  int divisions_ = 0;           ///< How often the triangle may still be divided around a point.
  int depth_ = 0;               ///< How deep the part at hand is nested in such divisions.
};

}  // namespace

bool cutTriangles(const ClipInput& input, BorderClassifier& classifier, Arena& arena, ClippedTriangles& out) noexcept {
  TriangleCutter cutter(input, classifier, arena, out);
  if (arena.failed()) return false;
  cutter.cutAll();
  return !cutter.failed();
}

}  // namespace cagecast
