#include "clip/piece_merger.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cagecast {

void PieceMerger::start() noexcept {
  firstVertex_ = static_cast<std::uint32_t>(triangle_.out.onBorder.size());
  firstTriangle_ = triangle_.out.origins.size();
  kept_.truncate(0);
}

void PieceMerger::merge() noexcept {
  ClippedTriangles& out = triangle_.out;
  vertices_.truncate(0);
  nextCorners_.truncate(0);
  const std::size_t count = out.onBorder.size() - firstVertex_;
  for (std::size_t i = 0; i < count; ++i) vertices_.add({kNoCorner, false, false, 0, 0});
  for (std::size_t i = 3 * firstTriangle_; i < out.indices.size(); ++i) nextCorners_.add(kNoCorner);
  if (count == 0 || failed() || triangle_.failed()) return;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (isInside(kept_[i]) && kept_[i] - firstVertex_ < count) vertices_[kept_[i] - firstVertex_].stays = true;
  }
  for (std::size_t i = 3 * firstTriangle_; i < out.indices.size(); ++i) {
    if (!isInside(out.indices[i])) continue;
    const auto corner = static_cast<std::uint32_t>(i - 3 * firstTriangle_);
    nextCorners_[corner] = std::exchange(vertices_[out.indices[i] - firstVertex_].firstCorner, corner);
  }
  bool isDone = false;
  for (int round = 0; round < kMaxRounds && !isDone; ++round) {
    isDone = true;
    for (std::size_t i = 0; i < count && !failed(); ++i) {
      if (vertices_[i].stays || vertices_[i].isGone) continue;
      const auto vertex = static_cast<std::uint32_t>(firstVertex_ + i);
      const std::uint32_t neighbour = listAround(vertex) ? findNeighbour(vertex) : kNoVertex;
      if (neighbour == kNoVertex) continue;
      move(vertex, neighbour);
      vertices_[i].isGone = true;
      isDone = false;
    }
  }
  closeGaps();
}

/// The weights of a vertex inside the target triangle, on an edge or in a corner of it, and its place.
TrianglePoint PieceMerger::pointOf(std::uint32_t vertex) const noexcept {
  const std::uint32_t* corners = triangle_.vertices();
  double weights[3] = {};
  const auto add = [&](std::uint32_t source, double weight) {
    // Not among the first two: the third, as sources are corners of this triangle.
    weights[std::find(corners, corners + 2, source) - corners] += weight;
  };
  if (vertex < triangle_.vertexCount()) {
    add(vertex, 1);
  } else {
    const std::size_t first = std::size_t{3} * (vertex - triangle_.vertexCount());
    for (std::size_t i = first; i < first + 3; ++i)
      add(triangle_.out.sources[i], static_cast<double>(triangle_.out.weights[i]));
  }
  const Vec3 a = triangle_.corner(0).p;
  TrianglePoint point{};
  point.v = weights[1];
  point.w = weights[2];
  point.p = a + point.v * (triangle_.corner(1).p - a) + point.w * (triangle_.corner(2).p - a);
  point.vertex = vertex;
  return point;
}

/// The least height of a triangle; 0 or less if it is degenerate or turned over.
double PieceMerger::height(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
  const TrianglePoint corners[3] = {pointOf(a), pointOf(b), pointOf(c)};
  const Vec3 normal = cross(corners[1].p - corners[0].p, corners[2].p - corners[0].p);
  const double size = length(normal) / longestEdge(corners);
  return signedArea(corners[0], corners[1], corners[2]) > 0 ? size : -size;
}

/// Lists the triangles around a vertex, each after the one before it.
/// @return false if they do not close around it, or are too many.
bool PieceMerger::listAround(std::uint32_t vertex) noexcept {
  const List<std::uint32_t>& indices = triangle_.out.indices;
  around_.truncate(0);
  for (std::uint32_t corner = vertices_[vertex - firstVertex_].firstCorner; corner != kNoCorner;
       corner = nextCorners_[corner]) {
    const std::size_t first = 3 * firstTriangle_ + corner / 3 * 3;
    if (indices[first + corner % 3] != vertex) continue;  // `kNoVertex`: of a triangle that was taken away.
    around_.add({first / 3, indices[first + (corner + 1) % 3], indices[first + (corner + 2) % 3]});
    if (around_.size() > kMaxAround) return false;
  }
  if (around_.failed() || around_.size() < 3) return false;
  const std::size_t n = around_.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    std::size_t next = i + 1;
    while (next < n && around_[next].from != around_[i].to) ++next;
    if (next == n) return false;
    std::swap(around_[i + 1], around_[next]);
  }
  return around_[n - 1].to == around_[0].from;
}

/// Whether a vertex, whose triangles are listed, may be moved to one of its neighbours.
/// @param[in,out] thinnest  The least height of a triangle: first the allowed one, then the real one.
bool PieceMerger::mayMove(std::uint32_t vertex, std::uint32_t to, double& thinnest) const noexcept {
  const List<std::uint8_t>& onBorder = triangle_.out.onBorder;
  double least = triangle_.input.diagonal;
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const auto& [triangle, from, next] = around_[i];
    if (from == to || next == to) continue;
    // A triangle with all its corners on borders does not tell which region it is in.
    if (onBorder[vertex] == 0 && onBorder[from] != 0 && onBorder[next] != 0 && onBorder[to] != 0) return false;
    least = std::min(least, height(to, from, next));
  }
  if (least < thinnest || !(least > 0)) return false;
  thinnest = least;
  return true;
}

/// Finds the neighbour that a vertex, whose triangles are listed, is best moved to.
/// @return kNoVertex if the vertex is needed.
std::uint32_t PieceMerger::findNeighbour(std::uint32_t vertex) noexcept {
  const List<std::uint32_t>& regions = triangle_.out.regions;
  const std::size_t n = around_.size();
  std::uint32_t ends[2] = {};  // Of the two borders that meet here.
  int borders = 0;
  double thinnest = triangle_.input.diagonal;
  for (std::size_t i = 0; i < n; ++i) {
    thinnest = std::min(thinnest, height(vertex, around_[i].from, around_[i].to));
    // Beside a border within one region, larger pieces might get the texture of its other side.
    if (isInside(around_[i].from) && vertices_[around_[i].from - firstVertex_].stays) return kNoVertex;
    if (regions[around_[(i + n - 1) % n].triangle] == regions[around_[i].triangle]) continue;
    if (borders < 2) ends[borders] = around_[i].from;
    ++borders;
  }
  std::uint32_t best = kNoVertex;
  if (borders == 0 && triangle_.out.onBorder[vertex] == 0) {
    for (std::size_t i = 0; i < n; ++i) {
      if (mayMove(vertex, around_[i].from, thinnest)) best = around_[i].from;
    }
  }
  if (borders != 2) return best;
  const Vec3 start = pointOf(ends[0]).p, along = pointOf(ends[1]).p - start, offset = pointOf(vertex).p - start;
  const double share = std::clamp(dot(offset, along) / dot(along, along), 0.0, 1.0);
  const double moved = vertices_[vertex - firstVertex_].moved + length(offset - share * along);
  if (!(moved <= triangle_.tolerances.removed)) return kNoVertex;
  for (const std::uint32_t end : ends) {
    if (mayMove(vertex, end, thinnest)) best = end;
  }
  for (const std::uint32_t end : ends) {
    if (best == kNoVertex || !isInside(end)) continue;
    Inside& inside = vertices_[end - firstVertex_];
    inside.moved = std::max(inside.moved, moved);
  }
  return best;
}

/// Moves a vertex to a neighbour. The triangles between the two are taken away: their corners become `kNoVertex`.
void PieceMerger::move(std::uint32_t vertex, std::uint32_t to) noexcept {
  List<std::uint32_t>& indices = triangle_.out.indices;
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const auto& [triangle, from, next] = around_[i];
    for (std::size_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
      if (from == to || next == to) {
        indices[corner] = kNoVertex;
      } else if (indices[corner] == vertex) {
        indices[corner] = to;
        const auto local = static_cast<std::uint32_t>(corner - 3 * firstTriangle_);
        if (isInside(to)) nextCorners_[local] = std::exchange(vertices_[to - firstVertex_].firstCorner, local);
      }
    }
  }
}

/// Moves what is left together.
void PieceMerger::closeGaps() noexcept {
  ClippedTriangles& out = triangle_.out;
  std::uint32_t kept = firstVertex_;
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
    if (vertices_[i].isGone) continue;
    const std::size_t from = firstVertex_ + i;
    vertices_[i].number = kept;
    out.onBorder[kept] = out.onBorder[from];
    for (std::size_t k = 0; k < 3; ++k) {
      out.sources[3 * (kept - triangle_.vertexCount()) + k] = out.sources[3 * (from - triangle_.vertexCount()) + k];
      out.weights[3 * (kept - triangle_.vertexCount()) + k] = out.weights[3 * (from - triangle_.vertexCount()) + k];
    }
    ++kept;
  }
  std::size_t triangles = firstTriangle_;
  for (std::size_t t = firstTriangle_; t < out.origins.size(); ++t) {
    if (out.indices[3 * t] == kNoVertex) continue;
    out.origins[triangles] = out.origins[t];
    out.regions[triangles] = out.regions[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = out.indices[3 * t + k];
      out.indices[3 * triangles + k] = isInside(vertex) ? vertices_[vertex - firstVertex_].number : vertex;
    }
    ++triangles;
  }
  out.sources.truncate(std::size_t{3} * (kept - triangle_.vertexCount()));
  out.weights.truncate(std::size_t{3} * (kept - triangle_.vertexCount()));
  out.onBorder.truncate(kept);
  out.indices.truncate(3 * triangles);
  out.origins.truncate(triangles);
  out.regions.truncate(triangles);
}

}  // namespace cagecast
