#include "clip/triangle_cutter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/hash_index.hpp"

namespace cagecast {
namespace {

/// docs/method.md, step 10; all are shares of the diagonal. What is smaller than this may be overlooked.
constexpr double kFeature = 5e-4;
/// How far a border may be from what is cut for it.
constexpr double kStraight = 2.5e-4;
/// How well a place on a border is found,
constexpr double kFound = 1e-7;
/// and how near to a vertex it may be before it is taken to be there: no triangle is cut so thin.
constexpr double kSnap = 1e-5;
/// A polygon no wider than this is not divided around its middle: its parts would be ever thinner, and never simpler.
constexpr double kThin = 1e-4;
/// How often a triangle is divided because something lies inside it, at most,
constexpr int kMostDivisions = 2048;
/// and how often one part inside another.
constexpr int kDeepest = 128;
constexpr std::uint32_t kNone = UINT32_MAX;

/// A place on the triangle that is being cut.
struct Spot {
  Vec3 p;       ///< Scaled.
  double v, w;  ///< Weights of the triangle's second and third corner.
  Look look;
  std::uint32_t vertex = kNone;
};

/// A place between two others.
Vec3 between(Vec3 a, Vec3 b, double t) { return a + t * (b - a); }
Spot between(const Spot& a, const Spot& b, double t) {
  Spot out{};
  out.p = between(a.p, b.p, t);
  out.v = a.v + t * (b.v - a.v);
  out.w = a.w + t * (b.w - a.w);
  return out;
}

/// Where an edge is cut.
struct Stop {
  double t;  ///< Between its ends: 0..1.
  Look look;
  bool isBorder;  ///< Else it lies between two borders, so that there is but one on either side of it.
  std::uint32_t vertex = kNone;
};

/// A triangle's parts, by fours: of its corners 0, 1, 2 and the middles of its sides 3, 4, 5.
constexpr int kQuarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

/// Some of a list.
struct Range {
  std::uint32_t first = 0, count = 0;
};

/// A corner of a polygon inside the triangle that is being cut, and the border, if any, on the way to the next.
struct Node {
  Spot spot, border;
  bool isCrossed;
};

/// Twice the area, in weights, of a triangle: greater than 0 if it is turned as the one that is being cut.
double side(const Spot& a, const Spot& b, const Spot& c) {
  return (b.v - a.v) * (c.w - a.w) - (b.w - a.w) * (c.v - a.v);
}
/// Less than this is none.
constexpr double kFlat = 1e-12;

class Cutter {
 public:
  Cutter(const MeshView& target, double scale, double diagonal, const std::uint8_t* takesPart,
         BorderClassifier& classifier, Arena& arena, CutTriangles& out) noexcept
      : target_(target),
        takesPart_(takesPart),
        classifier_(classifier),
        out_(out),
        vertexCount_(static_cast<std::uint32_t>(target.positions.size() / 3)),
        scale_(scale),
        feature_(kFeature * diagonal),
        straight_(kStraight * diagonal),
        found_(kFound * diagonal),
        snap_(kSnap * diagonal),
        thin_(kThin * diagonal),
        looks_(arena.allocate<Look>(vertexCount_)),
        rangeOfSide_(arena.allocate<Range>(target.indices.size())),
        sides_(target.indices.size(), arena) {}

  void cut() noexcept {
    for (std::uint32_t v = 0; v < vertexCount_; ++v) {
      looks_[v] = takesPart_[v] != 0 ? classifier_.at(positionOf(v)) : Look{};
      out_.onBorder.add(0);
    }
    const auto count = static_cast<std::uint32_t>(target_.indices.size() / 3);
    for (triangle_ = 0; triangle_ < count && !failed(); ++triangle_) cutTriangle();
  }

  [[nodiscard]] bool failed() const noexcept {
    return out_.failed() || classifier_.failed() || edgeStops_.failed() || inner_.failed() || spokes_.failed() ||
           nodes_.failed() || pieces_.failed() || parts_.failed() || line_.failed() || polygon_.failed();
  }

 private:
  [[nodiscard]] Vec3 positionOf(std::uint32_t v) const noexcept {
    return scale_ * Vec3::from(target_.positions.data() + std::size_t{3} * v);
  }

  /// What is near the triangle that is being cut: found when it is first asked for, and the first to be listed.
  Nearby nearTriangle() noexcept {
    if (near_.count > 0) return near_;
    Vec3 corners[3];
    double least = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = target_.indices[3 * triangle_ + k];
      corners[k] = positionOf(v);
      if (takesPart_[v] != 0) least = length(corners[k] - looks_[v].q);
    }
    // The middle is nearer to any corner than the corners are to each other.
    return near_ =
               classifier_.around(corners, least + length(corners[1] - corners[0]) + length(corners[2] - corners[1]));
  }

  std::uint32_t addVertex(const std::uint32_t (&sources)[3], double second, double third, bool isOnBorder) noexcept {
    const double w1 = std::round(second / kWeightUnit) * kWeightUnit;
    const double w2 = std::round(third / kWeightUnit) * kWeightUnit;
    for (const std::uint32_t source : sources) out_.sources.add(source);
    for (const double w : {1 - w1 - w2, w1, w2}) out_.weights.add(static_cast<float>(w));
    out_.onBorder.add(isOnBorder);
    return static_cast<std::uint32_t>(out_.onBorder.size() - 1);
  }

  /// Makes a vertex of a spot inside the triangle.
  void addVertex(Spot& spot, bool isOnBorder) noexcept {
    const std::uint32_t* index = target_.indices.data() + std::size_t{3} * triangle_;
    spot.vertex = addVertex({index[0], index[1], index[2]}, spot.v, spot.w, isOnBorder);
  }

  // ---- Edges. What is found on one depends on its ends alone, taken in an order that depends on their places alone,
  // so that it is the same, to the bit, for all triangles that share it.

  /// An edge that is being searched.
  struct Edge {
    const Spot& from;
    const Spot& to;
    double length;
    List<Stop>& stops;
    double lastBorder = -1;
    [[nodiscard]] Vec3 at(double t) const { return between(from.p, to.p, t); }
  };

  /// Finds the borders between two places on an edge.
  /// @param nearby  To some more of the edge; none if it is the whole.
  void search(Edge& edge, Nearby nearby, double t0, const Look& look0, double t1, const Look& look1) noexcept {
    const double apart = (t1 - t0) * edge.length;
    const bool isBetween = classifier_.isBetween(look0, look1);
    if (!isBetween && apart <= feature_) return;
    const Vec3 ends[2] = {edge.at(t0), edge.at(t1)};
    if (!isBetween && classifier_.clearance(look0, ends[0]) + classifier_.clearance(look1, ends[1]) >= apart) return;
    nearby = classifier_.within(nearby.count == 0 ? nearTriangle() : nearby, ends);
    if (!isBetween && classifier_.isWhole(look0.side, nearby, ends)) return;
    if (apart > feature_) {
      const double middle = (t0 + t1) / 2;
      const Look look = classifier_.at(nearby, edge.at(middle));
      search(edge, nearby, t0, look0, middle, look);
      search(edge, nearby, middle, look, t1, look1);
      return;
    }
    double low = t0, high = t1;
    Look below = look0, above = look1;
    while ((high - low) * edge.length > found_) {
      const double middle = (low + high) / 2;
      const Look look = classifier_.at(nearby, edge.at(middle));
      if (classifier_.isBetween(below, look)) {
        high = middle;
        above = look;
      } else if (classifier_.isBetween(look, above)) {
        low = middle;
        below = look;
      } else {
        return;  // The texture changes quickly here, but it is not torn.
      }
    }
    const double t = (low + high) / 2;
    if (edge.lastBorder >= 0) {
      const double middle = (edge.lastBorder + t) / 2;
      const Look look = classifier_.at(nearTriangle(), edge.at(middle));
      edge.stops.add({middle, look, false});
    }
    edge.stops.add({t, below, true});
    edge.lastBorder = t;
  }

  /// Finds all borders on an edge.
  void searchAll(const Spot& from, const Spot& to, List<Stop>& stops) noexcept {
    Edge edge{from, to, length(to.p - from.p), stops};
    search(edge, {}, 0, from.look, 1, to.look);
    classifier_.rewind(near_.first + near_.count);
  }

  /// Makes a vertex of a stop; at an end of its edge, that is one already.
  /// @param add  Adds a vertex for a stop inside the edge.
  template <typename Add>
  void makeVertex(Stop& stop, const Spot& from, const Spot& to, Add add) noexcept {
    const double apart = length(to.p - from.p);
    const bool isAtStart = stop.t * apart < snap_;
    if (stop.isBorder && (isAtStart || (1 - stop.t) * apart < snap_)) {
      stop.t = isAtStart ? 0 : 1;
      stop.vertex = isAtStart ? from.vertex : to.vertex;
      out_.onBorder[stop.vertex] = 1;
    } else {
      stop.vertex = add(stop);
    }
  }

  [[nodiscard]] static bool isBefore(Vec3 a, Vec3 b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  }

  /// The stops of a side of the triangle, in the order of its ends' places.
  Range stopsOfSide(std::uint32_t side, const Spot& first, const Spot& second) noexcept {
    const auto endsOf = [&](std::uint32_t s) {
      const std::uint32_t v = target_.indices[s];
      const std::uint32_t w = target_.indices[s % 3 == 2 ? s - 2 : s + 1];
      return std::uint64_t{std::min(v, w)} << 32 | std::max(v, w);
    };
    const std::uint64_t ends = endsOf(side);
    const std::uint32_t met =
        sides_.firstEqual(side, HashIndex::mix(0, ends), [&](std::uint32_t s) { return endsOf(s) == ends; });
    Range& known = rangeOfSide_[met];
    if (met == side) {
      const auto begin = static_cast<std::uint32_t>(edgeStops_.size());
      searchAll(first, second, edgeStops_);
      known = {begin, static_cast<std::uint32_t>(edgeStops_.size()) - begin};
      for (std::uint32_t i = begin; i < begin + known.count && !failed(); ++i) {
        makeVertex(edgeStops_[i], first, second, [&](const Stop& stop) {
          return addVertex({first.vertex, second.vertex, first.vertex}, stop.t, 0, stop.isBorder);
        });
      }
    }
    return known;
  }

  /// Adds a corner and what is on the side from there to the next: the places between borders become corners too.
  void addSide(const Spot& from, const Spot& to, const List<Stop>& stops, Range range, bool isForward) noexcept {
    nodes_.add({from, {}, false});
    for (std::uint32_t i = 0; i < range.count && !failed(); ++i) {
      const Stop& stop = stops[isForward ? range.first + i : range.first + range.count - 1 - i];
      Spot spot = isForward ? between(from, to, stop.t) : between(to, from, stop.t);
      spot.look = stop.look;
      spot.vertex = stop.vertex;
      if (stop.isBorder) {
        nodes_[nodes_.size() - 1].border = spot;
        nodes_[nodes_.size() - 1].isCrossed = true;
      } else {
        nodes_.add({spot, {}, false});
      }
    }
  }

  /// Makes vertices of the stops between two spots inside the triangle, which are the last of `inner_`.
  Range makeVertices(std::size_t begin, const Spot& from, const Spot& to) noexcept {
    for (std::size_t i = begin; i < inner_.size() && !failed(); ++i) {
      makeVertex(inner_[i], from, to, [&](const Stop& stop) {
        Spot spot = between(from, to, stop.t);
        addVertex(spot, stop.isBorder);
        return spot.vertex;
      });
    }
    return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(inner_.size() - begin)};
  }

  // ---- Triangles.

  void cutTriangle() noexcept {
    const std::uint32_t* index = target_.indices.data() + std::size_t{3} * triangle_;
    Spot corners[3];
    bool takesPart = true;
    for (int k = 0; k < 3; ++k) {
      corners[k] = {positionOf(index[k]), static_cast<double>(k == 1), static_cast<double>(k == 2), looks_[index[k]],
                    index[k]};
      takesPart = takesPart && takesPart_[index[k]] != 0;
    }
    pieces_.cut(0);
    if (index[0] == index[1] || index[1] == index[2] || index[2] == index[0])
      return emit(corners, {});  // No more than an edge: it stays.
    nodes_.cut(0);
    inner_.cut(0);
    near_ = {};
    classifier_.rewind(0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Spot& from = corners[k];
      const Spot& to = corners[(k + 1) % 3];
      const bool isForward = isBefore(from.p, to.p);
      Range range;
      if (takesPart_[from.vertex] != 0 && takesPart_[to.vertex] != 0 && (isForward || isBefore(to.p, from.p))) {
        range = stopsOfSide(3 * triangle_ + k, isForward ? from : to, isForward ? to : from);
      }
      addSide(from, to, edgeStops_, range, isForward);
    }
    const Vec3 normal = cross(corners[1].p - corners[0].p, corners[2].p - corners[0].p);
    if (takesPart && dot(normal, normal) > 0) {
      divisions_ = kMostDivisions;
      divide(0, nodes_.size());
      return;
    }
    // Nothing of it is painted, or there is nothing of it: it only has what its neighbours have on its edges.
    emitPolygon(0, nodes_.size());
  }

  /// Divides a convex polygon until there are triangles with at most one border on each side, and none inside that does
  /// not come from there.
  /// @param first,count  Its corners, the last of `nodes_`, which are taken away.
  void divide(std::size_t first, std::size_t count) noexcept {
    const Nearby before = near_;
    if (count == 3 && !failed()) {
      near_ = classifier_.within(near_,
                                 std::array{nodes_[first].spot.p, nodes_[first + 1].spot.p, nodes_[first + 2].spot.p});
      divideTriangle(first);
    }
    if (count > 3 && !failed()) divideAcross(first, count);
    nodes_.cut(first);
    if (before.count == 0) return;
    near_ = before;
    classifier_.rewind(before.first + before.count);
  }

  /// Divides a polygon of more than three corners along the shortest line between two of them with half of the others
  /// on either side.
  void divideAcross(std::size_t first, std::size_t count) noexcept {
    const std::size_t half = count / 2;
    std::size_t from = first + count;
    double shortest = 0;
    for (std::size_t i = first; i + half < first + count; ++i) {
      const double apart = length(nodes_[i + half].spot.p - nodes_[i].spot.p);
      if ((from < first + count && apart >= shortest) || !dividesArea(first, count, i, i + half)) continue;
      shortest = apart;
      from = i;
    }
    if (from == first + count) return emitPolygon(first, count);  // All corners are on one line.
    const std::size_t to = from + half;
    const Spot start = nodes_[from].spot, end = nodes_[to].spot;
    const std::size_t begin = inner_.size();
    searchAll(start, end, inner_);
    // The places between borders become corners of both parts: there must be fewer than the other part takes away.
    if (inner_.size() - begin > 2 * half - 3) {
      inner_.cut(begin);
      if (mayDivide() && !isThin(first, count)) {
        // What is between the corners and the middle is smaller.
        Spot middle = nodes_[first].spot;
        for (std::size_t i = 1; i < count; ++i)
          middle = between(middle, nodes_[first + i].spot, 1.0 / static_cast<double>(i + 1));
        middle.look = classifier_.at(nearTriangle(), middle.p);
        return divideAround(first, count, middle);
      }
    }
    const Range range = makeVertices(begin, start, end);
    const std::size_t near = nodes_.size();
    for (std::size_t i = from; i < to; ++i) nodes_.add(Node(nodes_[i]));
    addSide(end, start, inner_, range, false);
    const std::size_t far = nodes_.size();
    for (std::size_t i = to; i < from + count; ++i) nodes_.add(Node(nodes_[first + (i - first) % count]));
    addSide(start, end, inner_, range, true);
    divide(far, nodes_.size() - far);
    divide(near, nodes_.size() - near);
    inner_.cut(begin);
  }

  /// Whether a polygon is too thin to be divided around its middle.
  [[nodiscard]] bool isThin(std::size_t first, std::size_t count) const noexcept {
    double doubleArea = 0, reach = 0;
    for (std::size_t i = first + 1; i < first + count; ++i) {
      const Vec3 along = nodes_[i].spot.p - nodes_[first].spot.p, before = nodes_[i - 1].spot.p - nodes_[first].spot.p;
      doubleArea += length(cross(before, along));
      reach = std::max(reach, length(along));
    }
    return doubleArea <= thin_ * reach;
  }

  /// Whether a line between two corners of a polygon divides its area.
  [[nodiscard]] bool dividesArea(std::size_t first, std::size_t count, std::size_t i, std::size_t j) const noexcept {
    double least = 0, most = 0;
    for (std::size_t k = first; k < first + count; ++k) {
      const double area = side(nodes_[i].spot, nodes_[j].spot, nodes_[k].spot);
      least = std::min(least, area);
      most = std::max(most, area);
    }
    return least < -kFlat && most > kFlat;
  }

  void divideTriangle(std::size_t first) noexcept {
    const std::size_t vertices = out_.onBorder.size(), triangles = out_.origins.size();
    const Node corners[3] = {nodes_[first], nodes_[first + 1], nodes_[first + 2]};
    Spot hidden;
    if (cutSimple(corners, hidden) || !mayDivide()) return;
    // Something else lies inside: once more, around it.
    forget(vertices, triangles);
    divideAround(first, 3, hidden);
  }

  [[nodiscard]] bool mayDivide() const noexcept { return divisions_ > 0 && depth_ < kDeepest; }

  /// Divides a polygon along the lines between its corners and a place inside.
  void divideAround(std::size_t first, std::size_t count, Spot centre) noexcept {
    --divisions_;
    ++depth_;
    addVertex(centre, false);
    const std::size_t begin = inner_.size(), firstSpoke = spokes_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Spot corner = nodes_[first + i].spot;
      const std::size_t start = inner_.size();
      searchAll(corner, centre, inner_);
      spokes_.add(makeVertices(start, corner, centre));
    }
    for (std::size_t i = 0; i < count && !failed(); ++i) {
      const std::size_t next = (i + 1) % count;
      const std::size_t part = nodes_.size();
      nodes_.add(Node(nodes_[first + i]));
      addSide(Spot(nodes_[first + next].spot), centre, inner_, spokes_[firstSpoke + next], true);
      addSide(centre, Spot(nodes_[first + i].spot), inner_, spokes_[firstSpoke + i], false);
      divide(part, nodes_.size() - part);
    }
    spokes_.cut(firstSpoke);
    inner_.cut(begin);
    --depth_;
  }

  void forget(std::size_t vertices, std::size_t triangles) noexcept {
    out_.sources.cut(3 * (vertices - vertexCount_));
    out_.weights.cut(3 * (vertices - vertexCount_));
    out_.onBorder.cut(vertices);
    out_.indices.cut(3 * triangles);
    out_.origins.cut(triangles);
    out_.sides.cut(triangles);
  }

  /// Makes triangles of a polygon as it is.
  void emitPolygon(std::size_t first, std::size_t count) noexcept {
    startPolygon();
    for (std::size_t i = first; i < first + count; ++i) {
      addCorner(nodes_[i].spot);
      if (nodes_[i].isCrossed) addCorner(nodes_[i].border);
    }
    fillPolygon(nodes_[first].spot.look);
  }

  /// Cuts a triangle with at most one border on each side.
  /// @return false if something else lies inside: then `hidden` is a place there.
  bool cutSimple(const Node (&nodes)[3], Spot& hidden) noexcept {
    pieces_.cut(0);
    const Spot corners[3] = {nodes[0].spot, nodes[1].spot, nodes[2].spot};
    const int crossed = nodes[0].isCrossed + nodes[1].isCrossed + nodes[2].isCrossed;
    if (crossed == 0) {
      startPolygon();
      for (const Spot& corner : corners) addCorner(corner);
      fillPolygon(corners[0].look);
      return isClear(corners) || !findHidden(hidden);
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3, m = (k + 2) % 3;
      if (crossed == 1 && nodes[k].isCrossed) {
        // A border that ends inside.
        const Spot& stop = nodes[k].border;
        startPolygon();
        addCorner(corners[k]), addCorner(stop), addCorner(corners[m]);
        fillPolygon(stop.vertex == corners[k].vertex ? corners[m].look : corners[k].look);
        startPolygon();
        addCorner(stop), addCorner(corners[l]), addCorner(corners[m]);
        fillPolygon(stop.vertex == corners[l].vertex ? corners[m].look : corners[l].look);
        return true;
      }
      if (crossed == 2 && !nodes[l].isCrossed) {
        cutOff({corners[k], corners[l], corners[m]}, nodes[k].border, nodes[m].border);
        return !findHidden(hidden);
      }
    }
    // Three borders that meet.
    Spot meeting;
    const bool isSimple = findMeeting(corners, meeting);
    if (!isSimple) hidden = meeting;
    addVertex(meeting, true);
    for (std::uint32_t k = 0; k < 3; ++k) cutOff({corners[k], corners[(k + 1) % 3], meeting}, nodes[k].border, meeting);
    return isSimple && !findHidden(hidden);
  }

  /// Whether, for sure, no loop is nearest to any place in a triangle: each is within this share of the longest side of
  /// a corner.
  [[nodiscard]] bool isClear(const Spot (&corners)[3]) noexcept {
    constexpr double kCovering = 0.58;  // 1 / √3, of the triangle with equal sides, and less of others.
    const double enough = kCovering * longestSide(corners);
    return std::all_of(corners, corners + 3,
                       [&](const Spot& spot) { return classifier_.clearance(spot.look, spot.p) >= enough; });
  }

  /// Looks at the middles of a triangle's sides.
  /// @param t  Its corners, and then these.
  void addMiddles(Spot (&t)[6], Nearby nearby) noexcept {
    for (int k = 0; k < 3; ++k) {
      t[3 + k] = between(t[k], t[(k + 1) % 3], 0.5);
      t[3 + k].look = classifier_.at(nearby, t[3 + k].p);
    }
  }

  /// Finds where three borders meet in a triangle whose corners are on three sides, by fours.
  /// @return false if the sides do not part so simply there: then `meeting` is a place that is on another side than it
  /// should be.
  bool findMeeting(const Spot (&corners)[3], Spot& meeting) noexcept {
    Spot t[6] = {corners[0], corners[1], corners[2]};
    const auto areApart = [&](const Spot& a, const Spot& b) { return classifier_.isBetween(a.look, b.look); };
    while (longestSide(t) > found_) {
      addMiddles(t, nearTriangle());
      const auto* part = std::find_if(std::begin(kQuarters), std::end(kQuarters), [&](const int(&p)[3]) {
        return areApart(t[p[0]], t[p[1]]) && areApart(t[p[1]], t[p[2]]) && areApart(t[p[2]], t[p[0]]);
      });
      if (part == std::end(kQuarters)) {
        const Spot* other = std::find_if(t + 3, t + 6, [&](const Spot& spot) {
          const auto k = &spot - (t + 3);
          return areApart(spot, t[k]) && areApart(spot, t[(k + 1) % 3]) && isWellInside(spot, corners);
        });
        if (other == t + 6) break;
        meeting = *other;
        return false;
      }
      const Spot quarter[3] = {t[(*part)[0]], t[(*part)[1]], t[(*part)[2]]};
      std::copy(quarter, quarter + 3, t);
    }
    meeting = between(between(t[0], t[1], 0.5), t[2], 1.0 / 3);
    meeting.look = t[0].look;
    return true;
  }

  // ---- A border through a triangle, from one side of a corner to the other.

  /// A place in the triangle of `cutOff`: on the ray from its first corner to the place `s` of the opposite side, `r`
  /// of the way.
  struct Polar {
    double s, r;
    [[nodiscard]] double x() const { return (1 - s) * r; }
    [[nodiscard]] double y() const { return s * r; }
  };

  /// The triangle that `cutOff` cuts.
  struct Wedge {
    Spot a, b, c;
    /// Where a ray ends.
    [[nodiscard]] Vec3 end(double s) const { return between(b.p, c.p, s); }
    [[nodiscard]] Vec3 at(Polar polar) const { return between(a.p, end(polar.s), polar.r); }
    [[nodiscard]] double lengthOf(double s) const { return length(end(s) - a.p); }
    /// The part between two rays.
    [[nodiscard]] std::array<Vec3, 3> sector(double s, double t) const { return {a.p, end(s), end(t)}; }
  };

  /// Whether a place is on the side of the wedge's first corner.
  [[nodiscard]] bool isWithFirst(const Wedge& wedge, const Look& look) const noexcept {
    const Look& a = wedge.a.look;
    const Look& b = wedge.b.look;
    if (look.side != a.side || a.side != b.side) return look.side == a.side;
    // One island on either side: what is nearer in the texture.
    const auto apart = [&](const Look& other) {
      const double u = look.uv.u - other.uv.u;
      const double v = look.uv.v - other.uv.v;
      return u * u + v * v;
    };
    return apart(a) < apart(b);
  }

  /// How far along a ray the border is.
  /// @param nearby  To some more of the wedge.
  double onRay(const Wedge& wedge, Nearby nearby, double s) noexcept {
    const double reach = wedge.lengthOf(s);
    const std::size_t mark = classifier_.mark();
    double low = 0, high = 1;
    for (std::uint32_t step = 0; (high - low) * reach > found_; ++step) {
      if (step % 4 == 0 && nearby.count > 2)
        nearby = classifier_.within(nearby, std::array{wedge.at({s, low}), wedge.at({s, high})});
      const double middle = (low + high) / 2;
      (isWithFirst(wedge, classifier_.at(nearby, wedge.at({s, middle}))) ? low : high) = middle;
    }
    classifier_.rewind(mark);
    return (low + high) / 2;
  }

  /// Where a ray meets the straight line between two places.
  static double chord(Polar from, Polar to, double s) {
    const double dx = to.x() - from.x(), dy = to.y() - from.y();
    const double side = (1 - s) * dy - s * dx;
    return side == 0 ? from.r : std::clamp((from.x() * dy - from.y() * dx) / side, 0.0, 1.0);
  }

  /// Adds the bends of the border between two places on it to `line_`.
  /// @param nearby  To some more of the wedge.
  void follow(const Wedge& wedge, Nearby nearby, Polar from, Polar to, int depth) noexcept {
    const Vec3 start = wedge.at(from), end = wedge.at(to);
    if (depth == 0 || length(end - start) <= straight_) return;
    const auto distance = [&](Polar polar) {
      const Vec3 along = end - start;
      const Vec3 beside = cross(wedge.at(polar) - start, along);
      return std::sqrt(dot(beside, beside) / dot(along, along));
    };
    const std::size_t mark = classifier_.mark();
    nearby = classifier_.within(nearby, wedge.sector(from.s, to.s));
    Polar worst{};
    double most = 0;
    const auto tryAt = [&](double s) {
      const Polar polar{s, onRay(wedge, nearby, s)};
      const double apart = distance(polar);
      if (apart <= most) return;
      most = apart;
      worst = polar;
    };
    // Where the border is not within a step of the line, on some rays.
    constexpr int kRays = 8;
    double width = (to.s - from.s) / kRays;
    for (int i = 1; i < kRays; ++i) {
      const double s = from.s + i * width;
      const double r = chord(from, to, s), step = straight_ / wedge.lengthOf(s);
      const auto isBefore = [&](double at) { return isWithFirst(wedge, classifier_.at(nearby, wedge.at({s, at}))); };
      if ((r - step > 0 && !isBefore(r - step)) || (r + step < 1 && isBefore(r + step))) tryAt(s);
    }
    if (most <= straight_) return classifier_.rewind(mark);
    const Nearby all = nearby;
    // The bend itself is where the border is farthest from the line.
    while (width * length(wedge.c.p - wedge.b.p) > straight_ / 4) {
      width /= 2;
      const double s = worst.s;
      nearby = classifier_.within(all, wedge.sector(s - width, s + width));
      tryAt(s - width);
      tryAt(s + width);
    }
    follow(wedge, all, from, worst, depth - 1);
    Spot bend = between(wedge.a, between(wedge.b, wedge.c, worst.s), worst.r);
    bend.look = wedge.a.look;
    addVertex(bend, true);
    line_.add(bend);
    follow(wedge, all, worst, to, depth - 1);
    classifier_.rewind(mark);
  }

  /// Cuts a triangle along the border between its first corner and the other two.
  /// @param from,to  Where that border meets the two sides; `to` may be the last corner.
  void cutOff(const Spot (&corners)[3], const Spot& from, const Spot& to) noexcept {
    const auto& [a, b, c] = corners;
    const Wedge wedge{a, b, c};
    constexpr int kMostBends = 6;  // Levels of them.
    line_.cut(0);
    if (from.vertex != to.vertex) {
      const auto share = [&first = a](const Spot& spot, const Spot& end) {
        return length(spot.p - first.p) / length(end.p - first.p);
      };
      follow(wedge, nearTriangle(), {0, share(from, b)}, {1, share(to, c)}, kMostBends);
    }
    startPolygon();
    addCorner(a), addCorner(from);
    for (std::size_t i = 0; i < line_.size(); ++i) addCorner(line_[i]);
    addCorner(to);
    fillPolygon(a.look);
    startPolygon();
    addCorner(from), addCorner(b), addCorner(c), addCorner(to);
    for (std::size_t i = line_.size(); i-- > 0;) addCorner(line_[i]);
    fillPolygon(b.look);
  }

  // ---- Polygons.

  void startPolygon() noexcept { polygon_.cut(0); }

  void addCorner(const Spot& spot) noexcept {
    if (polygon_.size() > 0 &&
        (polygon_[polygon_.size() - 1].vertex == spot.vertex || polygon_[0].vertex == spot.vertex))
      return;
    polygon_.add(spot);
  }

  /// Makes triangles of the polygon: the ear with the shortest cut first. In the weights of the corners it is flat,
  /// whatever its shape.
  /// @param look  Of a place on the side that it lies on.
  void fillPolygon(const Look& look) noexcept {
    while (polygon_.size() >= 3) {
      const std::size_t n = polygon_.size();
      std::size_t ear = n;
      double shortest = 0;
      for (std::size_t i = 0; i < n && n > 3; ++i) {
        const Spot& a = polygon_[(i + n - 1) % n];
        const Spot& b = polygon_[i];
        const Spot& c = polygon_[(i + 1) % n];
        const double cut = length(c.p - a.p);
        if (!(side(a, b, c) > 0) || (ear < n && cut >= shortest)) continue;
        bool isFree = true;
        for (std::size_t j = 0; j < n && isFree; ++j) {
          const Spot& p = polygon_[j];
          if (p.vertex == a.vertex || p.vertex == b.vertex || p.vertex == c.vertex) continue;
          isFree = side(a, b, p) < 0 || side(b, c, p) < 0 || side(c, a, p) < 0;
        }
        if (!isFree) continue;
        ear = i;
        shortest = cut;
      }
      if (ear == n) ear = 1;  // What is left has no area.
      emit({polygon_[(ear + n - 1) % n], polygon_[ear], polygon_[(ear + 1) % n]}, look);
      polygon_.remove(ear);
    }
  }

  void emit(const Spot (&corners)[3], const Look& look) noexcept {
    for (const Spot& corner : corners) out_.indices.add(corner.vertex);
    out_.origins.add(triangle_);
    out_.sides.add(look.side);
    pieces_.add({{corners[0], corners[1], corners[2]}, look});
  }

  /// A triangle that was made, and what is to be found everywhere inside it.
  struct Piece {
    Spot corners[3];
    Look look;
  };

  /// A part of a piece that is looked through.
  struct Part {
    Spot corners[3];
    std::uint32_t piece;
    Nearby nearby;
  };

  /// Finds a place well inside one of the triangles made last that is not on the side that they are on.
  bool findHidden(Spot& hidden) noexcept {
    const Nearby nearby = nearTriangle();
    const std::size_t mark = classifier_.mark();
    parts_.cut(0);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      const Spot(&corners)[3] = pieces_[i].corners;
      addPart({{corners[0], corners[1], corners[2]}, i, nearby});
    }
    bool isFound = false;
    // Part by part by fours.
    for (std::size_t next = 0; next < parts_.size() && !isFound && !failed(); ++next) {
      const Part whole = parts_[next];
      const Piece& piece = pieces_[whole.piece];
      Spot t[6] = {whole.corners[0], whole.corners[1], whole.corners[2]};
      addMiddles(t, whole.nearby);
      for (int k = 3; k < 6 && !isFound; ++k) {
        isFound = t[k].look.side != piece.look.side && isWellInside(t[k], piece.corners);
        if (isFound) hidden = t[k];
      }
      for (const auto& [a, b, c] : kQuarters) addPart({{t[a], t[b], t[c]}, whole.piece, whole.nearby});
    }
    classifier_.rewind(mark);
    return isFound;
  }

  /// Adds a part to those that are looked through, unless what is well inside of it is on the right side for sure.
  void addPart(Part part) noexcept {
    if (isSmall(part.corners)) return;
    const Piece& piece = pieces_[part.piece];
    // Well inside is what lies beyond three lines.
    Vec3 core[6] = {part.corners[0].p, part.corners[1].p, part.corners[2].p};
    std::uint32_t count = 3;
    for (int k = 0; k < 3; ++k) {
      Vec3 before[6];
      std::copy(core, core + count, before);
      const std::uint32_t beforeCount = std::exchange(count, 0);
      for (std::uint32_t i = 0; i < beforeCount; ++i) {
        const Vec3 p = before[i], q = before[(i + 1) % beforeCount];
        const double fromP = depthOf(p, piece.corners, k) - 1, fromQ = depthOf(q, piece.corners, k) - 1;
        if (fromP > 0) core[count++] = p;
        if ((fromP > 0) != (fromQ > 0)) core[count++] = p + fromP / (fromP - fromQ) * (q - p);
      }
    }
    if (count == 0) return;
    const std::size_t mark = classifier_.mark();
    const Hull hull(core, count);
    // What is near all of it is near its core too, and is listed for its parts anyway.
    const auto isSure = [&](Nearby nearby) { return classifier_.areAllOn(piece.look.side, nearby, hull); };
    bool isDone = isSure(part.nearby);
    if (!isDone) {
      part.nearby =
          classifier_.within(part.nearby, std::array{part.corners[0].p, part.corners[1].p, part.corners[2].p});
      isDone = isSure(part.nearby);
    }
    if (!isDone) {
      const std::size_t listed = classifier_.mark();
      isDone = isSure(classifier_.within(part.nearby, hull));
      classifier_.rewind(listed);
    }
    if (isDone) return classifier_.rewind(mark);
    parts_.add(part);
  }

  [[nodiscard]] static double longestSide(const Spot* t) {
    return std::max({length(t[1].p - t[0].p), length(t[2].p - t[1].p), length(t[0].p - t[2].p)});
  }
  [[nodiscard]] bool isSmall(const Spot (&corners)[3]) const noexcept { return longestSide(corners) <= feature_; }

  /// How far a place is inside side k of a triangle, as a share of what is well inside.
  [[nodiscard]] double depthOf(Vec3 p, const Spot (&t)[3], int k) const noexcept {
    const Vec3 along = t[(k + 1) % 3].p - t[k].p;
    const Vec3 beside = cross(along, p - t[k].p);
    return std::sqrt(dot(beside, beside) / dot(along, along)) / (feature_ / 2);
  }

  /// Whether a place is farther from the sides of a triangle than borders may be off.
  [[nodiscard]] bool isWellInside(const Spot& spot, const Spot (&t)[3]) const noexcept {
    return depthOf(spot.p, t, 0) > 1 && depthOf(spot.p, t, 1) > 1 && depthOf(spot.p, t, 2) > 1;
  }

  const MeshView& target_;
  const std::uint8_t* takesPart_;
  BorderClassifier& classifier_;
  CutTriangles& out_;
  std::uint32_t vertexCount_;
  double scale_;
  double feature_, straight_, found_, snap_, thin_;  ///< The constants above, scaled.
  Look* looks_;                                      ///< 1 per vertex that takes part.
  Range* rangeOfSide_;  ///< 1 per side of a triangle that is the first on its edge: in `edgeStops_`.
  HashIndex sides_;
  List<Stop> edgeStops_;  ///< In the order of the ends' places.
  std::uint32_t triangle_ = 0;
  List<Stop> inner_;    ///< Of an edge inside the triangle.
  List<Range> spokes_;  ///< In `inner_`.
  List<Node> nodes_;    ///< Polygons of the triangle that is being cut, those that are divided first at the end.
  int divisions_ = 0;   ///< How often it may still be divided.
  int depth_ = 0;       ///< How many divided parts the one at hand lies in.
  List<Spot> line_;
  List<Spot> polygon_;
  List<Piece> pieces_;
  List<Part> parts_;
  Nearby near_;  ///< See `nearTriangle`.
};

}  // namespace

bool cutTriangles(const MeshView& target, double scale, double diagonal, const std::uint8_t* takesPart,
                  BorderClassifier& classifier, Arena& arena, CutTriangles& out) noexcept {
  Cutter cutter(target, scale, diagonal, takesPart, classifier, arena, out);
  if (arena.failed()) return false;
  cutter.cut();
  return !cutter.failed();
}

}  // namespace cagecast
