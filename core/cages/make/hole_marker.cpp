#include "make/hole_marker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tolerances.hpp"
#include "make/steps.hpp"
#include "mesh/disjoint_sets.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

/// How often each vertex is averaged with its neighbours, which removes details of about two edges.
constexpr int kFieldSmoothings = 6;
/// What a ray meets farther away than this multiple of the distance to the nearest part is seen through a gap, as teeth
/// are between lips, and does not count.
constexpr double kStraightBelow = 1.5;
/// The hull is refined as far as this from the borders of the marks, in edges.
constexpr int kRefinedEdges = 3;
/// Gaps between marks narrower than twice this, in edges, are marked.
constexpr int kGapEdges = 3;
/// Fewer marked vertices next to each other than this are an error of the sampling, not a part.
constexpr std::size_t kMinMark = 4;
/// A part needs a wider hole if more than this share of its visible area is covered. From a half on, transfers paint
/// it.
constexpr double kMaxCovered = 0.35;
/// A point is hidden by what its ray meets in front of the cage, or up to this far behind it, in diagonals: the default
/// `occlusionReach` of transfers.
constexpr double kOcclusionReach = 0.03;
/// By how much farther its hole is widened each time, in edges.
constexpr int kWidening = 2;
/// Samples along the longest edge of a triangle at most.
constexpr double kMaxSamplesPerEdge = 64;
/// A needle is a triangle narrower than this share of the spacing of samples: one row of them does.
constexpr double kNeedleWidth = 0.25;
/// About the most samples on all needles together, of which there may be thousands side by side, and on all other
/// triangles.
constexpr double kNeedleSamples = 100'000, kTriangleSamples = 2'000'000;
/// Points or rays between two calls of the callback: 10 ms of work, on meshes of a million triangles 100 ms.
constexpr std::size_t kBatch = 4096;

/// A triangle as its longest edge and its third corner.
struct OnLongestEdge {
  Vec3 start, along, toThird;

  OnLongestEdge(const TriangleMesh& mesh, const Triangle3& triangle) {
    const auto at = [&](std::size_t k) { return mesh.positions[triangle[k % 3]]; };
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (length(at(k + 1) - at(k)) > length(at(longest + 1) - at(longest))) longest = k;
    start = at(longest);
    along = at(longest + 1) - start;
    toThird = at(longest + 2) - start;
  }
  /// Samples along the edge, about `spacing` apart.
  [[nodiscard]] double steps(double spacing) const {
    return std::clamp(std::ceil(length(along) / spacing), 1.0, kMaxSamplesPerEdge);
  }
  [[nodiscard]] bool isNeedle(double spacing) const {
    return length(cross(along, toThird)) < kNeedleWidth * spacing * length(along) && length(along) > spacing;
  }
};

/// The spacings of samples along needles and on other triangles, so that all of them together do not get too many.
struct Spacings {
  double needles, triangles;

  Spacings(const MarkedMesh& model, double spacing) {
    double alongNeedles = 0, onTriangles = 0;
    for (std::uint32_t t = 0; t < model.isMarked.size(); ++t) {
      if (!model.isMarked[t]) continue;
      const OnLongestEdge triangle(*model.mesh, model.mesh->triangles[t]);
      const double steps = triangle.steps(spacing);
      if (triangle.isNeedle(spacing))
        alongNeedles += steps;
      else
        onTriangles += steps * (steps + 1) / 2;
    }
    needles = spacing * std::max(1.0, alongNeedles / kNeedleSamples);
    triangles = spacing * std::sqrt(std::max(1.0, onTriangles / kTriangleSamples));
  }
};

/// Points all over the marked triangles, about `spacing` apart, with the triangles that they are on.
void sampleMarked(const MarkedMesh& model, double spacing, std::vector<Vec3>& samples,
                  std::vector<std::uint32_t>& triangles) {
  // Multiples of it, modulo 1, are spread evenly, however many there are.
  constexpr double kGoldenRatio = 0.6180339887498949;
  const Spacings spacings(model, spacing);
  for (std::uint32_t t = 0; t < model.isMarked.size(); ++t) {
    if (!model.isMarked[t]) continue;
    const OnLongestEdge triangle(*model.mesh, model.mesh->triangles[t]);
    const auto add = [&](double along, double toThird) {
      samples.push_back(triangle.start + along * triangle.along + toThird * triangle.toThird);
      triangles.push_back(t);
    };
    if (triangle.isNeedle(spacing)) {
      const double steps = triangle.steps(spacings.needles);
      // Needles side by side have their samples in different places.
      double shift = kGoldenRatio * t;
      shift -= std::floor(shift);
      for (double i = 0; i < steps; ++i) add(2.0 / 3 * (i + shift) / steps, 1.0 / 3);
      continue;
    }
    const double steps = triangle.steps(spacings.triangles);
    for (double i = 0; i < steps; ++i)
      for (double j = 0; i + j < steps; ++j) add((i + 1.0 / 3) / steps, (j + 1.0 / 3) / steps);
  }
}

/// The vertices with a neighbour that has another mark.
std::vector<bool> borderOf(const Neighbours& neighbours, const std::vector<bool>& marks) {
  std::vector<bool> border(marks.size());
  for (std::size_t v = 0; v < marks.size(); ++v)
    for (const std::uint32_t n : neighbours[v]) border[v] = border[v] || marks[n] != marks[v];
  return border;
}

void smooth(const Neighbours& neighbours, std::vector<double>& field) {
  std::vector<double> next(field.size());
  for (std::size_t v = 0; v < field.size(); ++v) {
    double sum = field[v];
    for (const std::uint32_t n : neighbours[v]) sum += field[n];
    next[v] = sum / (1 + static_cast<double>(neighbours[v].size()));
  }
  field.swap(next);
}

/// Sets the field to 1 again on connected marks that smoothing has removed.
void restoreVanished(const Neighbours& neighbours, const std::vector<bool>& marks, std::vector<double>& field) {
  DisjointSets sets(marks.size());
  for (std::uint32_t v = 0; v < marks.size(); ++v)
    for (const std::uint32_t n : neighbours[v])
      if (marks[v] && marks[n]) sets.join(v, n);
  std::vector<std::size_t> sizes(marks.size(), 0);
  std::vector<bool> remains(marks.size());
  for (std::uint32_t v = 0; v < marks.size(); ++v) {
    ++sizes[sets.find(v)];
    if (field[v] >= 0.5) remains[sets.find(v)] = true;
  }
  for (std::uint32_t v = 0; v < marks.size(); ++v)
    if (marks[v] && !remains[sets.find(v)] && sizes[sets.find(v)] >= kMinMark) field[v] = 1;
}

}  // namespace

std::vector<bool> FaceSkin::isBelow(std::span<const Vec3> points) const {
  std::vector<bool> out(points.size());
  if (!others) return out;
  const std::vector<SurfacePoint> nearest = others->closest(points);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = isSkin[triangleOf[nearest[i].triangle]];
  return out;
}

std::vector<bool> FaceSkin::isCoveredBy(std::span<const std::uint32_t> triangles, std::span<const Vec3> points) const {
  std::vector<bool> out(points.size());
  if (!others) return out;
  std::vector<std::size_t> covered;
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!isCover[triangles[i]]) continue;
    covered.push_back(i);
    places.push_back(points[i]);
  }
  const std::vector<bool> isFace = isBelow(places);
  for (std::size_t i = 0; i < covered.size(); ++i) out[covered[i]] = isFace[i];
  return out;
}

void HoleMarker::closeGaps(const Neighbours& neighbours, std::vector<bool>& marks) const {
  // Widens all of them, and takes the margin away again.
  std::vector<bool> closed = marks;
  grow(neighbours, closed, kGapEdges);
  closed.flip();
  grow(neighbours, closed, kGapEdges);
  closed.flip();
  std::vector<std::size_t> between;
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < marks.size(); ++v)
    if (closed[v] && !marks[v]) {
      between.push_back(v);
      places.push_back(hull_.positions[v]);
    }
  const std::vector<bool> isFace = model_.face.isBelow(places);
  for (std::size_t i = 0; i < between.size(); ++i) marks[between[i]] = !isFace[i];
}

HoleMarker::HoleMarker(const MarkedMesh& model, double depth, TriangleMesh& hull)
    : model_(model), depth_(depth), hull_(hull), parents_(hull.triangles.size()) {
  for (std::uint32_t t = 0; t < parents_.size(); ++t) parents_[t] = t;
}

bool HoleMarker::findSamples(const Progress& progress) {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> triangles;
  sampleMarked(model_, depth_ / 4, positions, triangles);
  std::vector<std::uint32_t> pieceOf(model_.isMarked.size(), 0);
  const std::vector<std::uint32_t> pieces = connectedPieces(subset(*model_.mesh, model_.isMarked), pieces_);
  for (std::size_t t = 0, k = 0; t < pieceOf.size(); ++t)
    if (model_.isMarked[t]) pieceOf[t] = pieces[k++];
  const Surface surface(hull_);
  for (std::size_t first = 0; first < positions.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, positions.size() - first);
    if (!report(progress, first, positions.size(), "holes")) return false;
    const std::vector<SurfacePoint> above = surface.closest({positions.data() + first, count});
    std::vector<SurfaceRay> rays;
    std::vector<Sample> candidates;
    for (std::size_t i = 0; i < count; ++i) {
      const SurfacePoint& point = above[i];
      if (point.distance > depth_ || !(point.distance > 0)) continue;
      const Vec3& position = positions[first + i];
      candidates.push_back({position, point.position, point.triangle, pieceOf[triangles[first + i]]});
      rays.push_back({point.position, 1 / point.distance * (position - point.position)});
    }
    const std::vector<RayHit> hits = model_.surface->trace(rays);
    std::vector<Vec3> places(candidates.size());
    std::vector<std::uint32_t> seen(candidates.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = candidates[i].position;
      seen[i] = hits[i].triangle;
    }
    const std::vector<bool> isOverFace = model_.face.isCoveredBy(seen, places);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const bool isSeen = std::isfinite(hits[i].distance) && model_.isMarked[seen[i]];
      if (isSeen && !isOverFace[i]) samples_.push_back(candidates[i]);
    }
  }
  return true;
}

bool HoleMarker::markBelow(std::size_t begin, const Progress& progress) {
  const std::vector<Vec3> normals = vertexNormals(hull_);
  below_.resize(hull_.positions.size(), false);
  const std::size_t end = hull_.positions.size();
  for (std::size_t first = begin; first < end; first += kBatch) {
    const std::size_t count = std::min(kBatch, end - first);
    if (!report(progress, first - begin, end - begin, "holes")) return false;
    std::vector<SurfaceRay> rays(count);
    for (std::size_t i = 0; i < count; ++i) rays[i] = {hull_.positions[first + i], -1 * normals[first + i]};
    const std::vector<RayHit> hits = model_.surface->trace(rays);
    const std::vector<SurfacePoint> nearest = model_.surface->closest({hull_.positions.data() + first, count});
    std::vector<std::uint32_t> below(count);
    for (std::size_t i = 0; i < count; ++i) {
      const bool isStraight = hits[i].distance < kStraightBelow * nearest[i].distance;
      below[i] = isStraight ? hits[i].triangle : nearest[i].triangle;
    }
    const std::vector<bool> isOverFace = model_.face.isCoveredBy(below, {hull_.positions.data() + first, count});
    for (std::size_t i = 0; i < count; ++i) {
      const bool isMarked = model_.isMarked[below[i]] && !isOverFace[i];
      below_[first + i] = isMarked || model_.eyes.isBefore(hull_.positions[first + i], normals[first + i]);
    }
  }
  return true;
}

std::vector<std::uint32_t> HoleMarker::verticesAbove() const {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(samples_.size());
  for (const Sample& sample : samples_) {
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = 0;
    const auto parts = std::equal_range(parents_.begin(), parents_.end(), sample.triangle);
    for (auto t = parts.first; t != parts.second; ++t)
      for (const std::uint32_t v : hull_.triangles[static_cast<std::size_t>(t - parents_.begin())]) {
        const double distance = length(hull_.positions[v] - sample.onHull);
        if (distance >= least) continue;
        least = distance;
        nearest = v;
      }
    vertices.push_back(nearest);
  }
  return vertices;
}

void HoleMarker::markSamples() {
  above_ = verticesAbove();
  sampled_.assign(hull_.positions.size(), false);
  for (const std::uint32_t v : above_) sampled_[v] = true;
}

std::vector<bool> HoleMarker::marks() const {
  std::vector<bool> marks = below_;
  for (std::size_t v = 0; v < marks.size(); ++v) marks[v] = marks[v] || sampled_[v];
  return marks;
}

bool HoleMarker::mark(int refinements, const Progress& progress) {
  if (!findSamples(partOf(progress, 0, 0.4f)) || !markBelow(0, partOf(progress, 0.4f, 0.8f))) return false;
  markSamples();
  for (int level = 0; level < refinements; ++level) {
    const Neighbours neighbours(hull_);
    const std::size_t before = hull_.positions.size();
    std::vector<bool> isNear = borderOf(neighbours, marks());
    grow(neighbours, isNear, kRefinedEdges);
    subdivide(isNear, hull_, parents_);
    if (!markBelow(before, partOf(progress, 0.8f, 0.8f))) return false;
    markSamples();
  }
  return report(progress, 1, "holes");
}

std::vector<double> HoleMarker::field() const {
  const Neighbours neighbours(hull_);
  std::vector<bool> marks = this->marks();
  closeGaps(neighbours, marks);
  std::vector<double> field(marks.begin(), marks.end());
  for (int i = 0; i < kFieldSmoothings; ++i) smooth(neighbours, field);
  restoreVanished(neighbours, marks, field);
  return field;
}

bool HoleMarker::widen(const TriangleMesh& cage, const Progress& progress, double& coveredShare) {
  const Surface surface(cage);
  const double diagonal = diagonalOf(*model_.mesh);
  std::vector<double> all(pieces_, 0), covered(pieces_, 0);
  std::vector<bool> isCovered(samples_.size(), false);
  for (std::size_t first = 0; first < samples_.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, samples_.size() - first);
    if (!report(progress, first, samples_.size(), "holes")) return false;
    std::vector<Vec3> positions(count);
    for (std::size_t i = 0; i < count; ++i) positions[i] = samples_[first + i].position;
    const std::vector<SurfacePoint> closest = surface.closest(positions);
    // As a transfer judges it: by a ray along the cage's normal that meets the cage before it meets the model.
    std::vector<SurfaceRay> rays(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 normal = areaNormal(cage, cage.triangles[closest[i].triangle]);
      rays[i] = {positions[i], 1 / length(normal) * normal};
    }
    const std::vector<double> onCage = surface.distances(rays);
    const std::vector<double> onModel = model_.surface->distances(rays, kRayStart * diagonal);
    for (std::size_t i = 0; i < count; ++i) {
      if (onModel[i] < onCage[i] + kOcclusionReach * diagonal) continue;
      const std::uint32_t piece = samples_[first + i].piece;
      isCovered[first + i] = std::isfinite(onCage[i]);
      all[piece] += 1;
      covered[piece] += isCovered[first + i] ? 1 : 0;
    }
  }
  std::vector<bool> isTooCovered(hull_.positions.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (!isCovered[i] || !(covered[samples_[i].piece] > kMaxCovered * all[samples_[i].piece])) continue;
    isTooCovered[above_[i]] = true;
    ++count;
  }
  coveredShare = samples_.empty() ? 0 : static_cast<double>(count) / static_cast<double>(samples_.size());
  widened_ += kWidening;
  grow(Neighbours(hull_), isTooCovered, widened_);
  for (std::size_t v = 0; v < below_.size(); ++v) below_[v] = below_[v] || isTooCovered[v];
  return true;
}

}  // namespace cagecast::cages
