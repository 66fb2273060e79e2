#include "clip/clip_target.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/hash_index.hpp"
#include "clip/triangle_cutter.hpp"
#include "input/equal_positions.hpp"

namespace cagecast {
namespace {

/// How many comparisons with triangles of the cage a pass may take, and how many more for each triangle of the target
/// and each border edge of the cage. Real models take a quarter of that at most, as do single triangles that are cut
/// along thousands of edges.
constexpr std::uint64_t kComparisons = 4'000'000;
constexpr std::uint64_t kComparisonsPerTriangle = 20'000;
constexpr std::uint64_t kComparisonsPerBorderEdge = 100'000;

/// The number of edges of the cage along which a pass cuts.
std::uint32_t countBorderEdges(const ClipCage& cage, BorderKind kind) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t halfEdge = 0; halfEdge < 3 * cage.cage.count; ++halfEdge) {
    const std::uint32_t element = 6 * (halfEdge / 3) + halfEdge % 3;
    count += kind == BorderKind::loops ? cage.loops.loopOf[element] != BoundaryLoops::kNone
                                       : cage.charts->nextHalfEdge[halfEdge] == halfEdge;
  }
  return count;
}

/// Classifies the places of one pass, within the limit of comparisons.
struct PassClassifier {
  std::uint32_t borderEdges;
  BorderClassifier classifier;

  PassClassifier(const ClipCage& cage, const MeshView& target, BorderKind kind, Arena& arena) noexcept
      : borderEdges(countBorderEdges(cage, kind)), classifier(cage, kind, limit(target, borderEdges), arena) {}
  static std::uint64_t limit(const MeshView& target, std::uint32_t borderEdges) noexcept {
    return kComparisons + kComparisonsPerTriangle * (target.indices.size() / 3) +
           kComparisonsPerBorderEdge * borderEdges;
  }
  /// Why a pass ended early.
  [[nodiscard]] Status failure() const noexcept {
    return classifier.isOverLimit() ? Status{Code::bordersTooComplex, Argument::target, borderEdges} : kOutOfMemory;
  }
};

/// Lets vertices with equal positions take part if any of them does: their edges have to be cut alike.
/// @param[in,out] takesPart  1 per vertex.
/// @return false if memory ran out.
bool joinEqualPositions(std::span<const float> positions, Arena& arena, std::uint8_t* takesPart) noexcept {
  const auto count = static_cast<std::uint32_t>(positions.size() / 3);
  const Arena::Scope scope(arena);
  HashIndex index(count, arena);
  auto* first = arena.allocate<std::uint32_t>(count);
  if (arena.failed()) return false;
  findFirstAtPosition(positions, index, first);
  for (std::uint32_t v = 0; v < count; ++v) takesPart[first[v]] |= takesPart[v];
  for (std::uint32_t v = 0; v < count; ++v) takesPart[v] = takesPart[first[v]];
  return true;
}

/// A weighted mean of up to three vertices of the target.
class Blend {
 public:
  void add(std::uint32_t vertex, double weight) noexcept {
    int i = 0;
    while (i < count_ && vertices_[i] != vertex) ++i;
    if (i == count_) {
      // All that is inside a triangle is a blend of its corners: a fourth vertex has no weight but by rounding.
      if (count_ == 3) return;
      vertices_[count_] = vertex;
      weights_[count_++] = 0;
    }
    weights_[i] += weight;
  }

  void write(std::uint32_t* sources, float* weights) const noexcept {
    double rest = 1;
    for (int i = 2; i >= 0; --i) {
      const double weight = i >= count_ ? 0 : i == 0 ? rest : std::round(weights_[i] / kWeightUnit) * kWeightUnit;
      rest -= weight;
      sources[i] = vertices_[i < count_ ? i : 0];
      weights[i] = static_cast<float>(weight);
    }
  }

 private:
  std::uint32_t vertices_[3] = {};
  double weights_[3] = {};
  int count_ = 0;
};

/// Merges the result of a pass into the mesh of the passes before: new vertices, which blend vertices of that mesh,
/// become blends of vertices of the target.
/// @param[in,out] mesh  Empty before the first pass. Its sides are left alone.
/// @return false if memory ran out.
bool mergePass(const MeshView& target, const ClippedTriangles& pass, ClippedMesh& mesh) noexcept {
  const std::size_t targetCount = target.positions.size() / 3;
  const std::size_t newBefore = mesh.sources.size() / 3;
  const std::size_t newCount = newBefore + pass.sources.size() / 3;
  Array<std::uint32_t> sources, indices, origins;
  Array<float> weights, positions;
  if (!sources.reset(3 * newCount) || !weights.reset(3 * newCount) || !positions.reset(3 * (targetCount + newCount)) ||
      !pass.indices.copyTo(indices) || !pass.origins.copyTo(origins)) {
    return false;
  }
  std::copy(mesh.sources.begin(), mesh.sources.end(), sources.begin());
  std::copy(mesh.weights.begin(), mesh.weights.end(), weights.begin());
  std::copy(target.positions.begin(), target.positions.end(), positions.begin());
  std::copy(mesh.positions.begin(), mesh.positions.end(), positions.begin());
  for (std::size_t n = newBefore; n < newCount; ++n) {
    Blend blend;
    for (std::size_t i = 3 * (n - newBefore); i < 3 * (n - newBefore) + 3; ++i) {
      const std::size_t vertex = pass.sources[i];
      const auto weight = static_cast<double>(pass.weights[i]);
      if (weight == 0) continue;
      if (vertex < targetCount) {
        blend.add(pass.sources[i], weight);
        continue;
      }
      for (std::size_t j = 3 * (vertex - targetCount); j < 3 * (vertex - targetCount) + 3; ++j) {
        if (weights[j] > 0) blend.add(sources[j], weight * static_cast<double>(weights[j]));
      }
    }
    blend.write(sources.data() + 3 * n, weights.data() + 3 * n);
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t i = 3 * n; i < 3 * n + 3; ++i)
        sum += static_cast<double>(weights[i]) * static_cast<double>(target.positions[std::size_t{3} * sources[i] + k]);
      positions[3 * (targetCount + n) + k] = static_cast<float>(sum);
    }
  }
  if (mesh.origins.size() > 0) {
    for (std::uint32_t& origin : origins) origin = mesh.origins[origin];
  }
  mesh.sources = std::move(sources);
  mesh.weights = std::move(weights);
  mesh.positions = std::move(positions);
  mesh.indices = std::move(indices);
  mesh.origins = std::move(origins);
  return true;
}

/// Whether a triangle has an area; without, it is not cut, and is on all sides of what is cut beside it.
bool hasArea(const MeshView& mesh, const std::uint32_t* corners) noexcept {
  const auto at = [&](int k) { return Vec3::from(mesh.positions.data() + std::size_t{3} * corners[k]); };
  const Vec3 normal = cross(at(1) - at(0), at(2) - at(0));
  return dot(normal, normal) > 0;
}

/// The first pass.
Status clipAlongLoops(const ClipCage& cage, const MeshView& target, const std::uint8_t* takesPart, Arena& arena,
                      ClippedMesh& out) noexcept {
  const Arena::Scope scope(arena);
  PassClassifier own(cage, target, BorderKind::loops, arena);
  ClippedTriangles pass;
  const ClipInput input{target, static_cast<double>(cage.units.scale), cage.units.diagonal, takesPart};
  if (arena.failed()) return kOutOfMemory;
  if (!cutTriangles(input, own.classifier, arena, pass)) return own.failure();
  if (!mergePass(target, pass, out) || !out.loopSides.reset(pass.onBorder.size()) ||
      !out.areBeyond.reset(pass.regions.size())) {
    return kOutOfMemory;
  }
  // Two passes. First every vertex of a triangle beyond a loop is `beyond`. Then the vertices of triangles that were
  // cut and lie on the covered side become `covered` again: those lie on one side, others are only where their first
  // corner is.
  std::fill(out.loopSides.begin(), out.loopSides.end(), LoopSide::covered);
  for (std::size_t t = 0; t < pass.regions.size(); ++t) {
    out.areBeyond[t] = pass.regions[t] != 0;
    for (std::size_t i = 3 * t; i < 3 * t + 3 && pass.regions[t] != 0; ++i)
      out.loopSides[pass.indices[i]] = LoopSide::beyond;
  }
  for (std::size_t t = 0; t < pass.regions.size(); ++t) {
    const std::uint32_t* corners = target.indices.data() + std::size_t{3} * pass.origins[t];
    const bool wasCut = std::all_of(corners, corners + 3, [&](std::uint32_t v) { return takesPart[v] != 0; }) &&
                        hasArea(target, corners);
    for (std::size_t i = 3 * t; i < 3 * t + 3 && wasCut && pass.regions[t] == 0; ++i)
      out.loopSides[pass.indices[i]] = LoopSide::covered;
  }
  for (std::size_t v = 0; v < out.loopSides.size(); ++v) {
    if (pass.onBorder[v] != 0) out.loopSides[v] = LoopSide::onBorder;
  }
  return {};
}

/// The second pass. What is beyond a loop is not painted, so its seams do not matter.
/// @param[in,out] mesh  The result of the first pass.
Status clipAlongSeams(const ClipCage& cage, const MeshView& target, const std::uint8_t* takesPart, Arena& arena,
                      ClippedMesh& mesh) noexcept {
  const std::size_t targetCount = target.positions.size() / 3;
  const std::size_t count = mesh.loopSides.size();
  const Arena::Scope scope(arena);
  auto* mayBePainted = arena.allocate<std::uint8_t>(count);
  PassClassifier own(cage, target, BorderKind::seams, arena);
  if (arena.failed()) return kOutOfMemory;
  for (std::size_t v = 0; v < count; ++v) {
    const auto takes = [&](std::size_t i) { return takesPart[mesh.sources[3 * (v - targetCount) + i]] != 0; };
    mayBePainted[v] = mesh.loopSides[v] != LoopSide::beyond &&
                      (v < targetCount ? takesPart[v] != 0 : takes(0) && takes(1) && takes(2));
  }
  if (!joinEqualPositions(mesh.positions, arena, mayBePainted)) return kOutOfMemory;
  ClippedTriangles pass;
  const ClipInput input{
      {mesh.positions, mesh.indices}, static_cast<double>(cage.units.scale), cage.units.diagonal, mayBePainted};
  if (!cutTriangles(input, own.classifier, arena, pass)) return own.failure();
  Array<std::uint8_t> areBeyond;
  Array<LoopSide> sides;
  if (!areBeyond.reset(pass.origins.size()) || !sides.reset(pass.onBorder.size())) return kOutOfMemory;
  for (std::size_t t = 0; t < areBeyond.size(); ++t) areBeyond[t] = mesh.areBeyond[pass.origins[t]];
  std::copy(mesh.loopSides.begin(), mesh.loopSides.end(), sides.begin());
  for (std::size_t v = count; v < sides.size(); ++v) {
    // On the border if all vertices that it blends are, else like the first that is not.
    sides[v] = LoopSide::onBorder;
    for (std::size_t i = 3 * (v - count); i < 3 * (v - count) + 3; ++i) {
      if (pass.weights[i] > 0 && sides[v] == LoopSide::onBorder) sides[v] = mesh.loopSides[pass.sources[i]];
    }
  }
  if (!mergePass(target, pass, mesh)) return kOutOfMemory;
  mesh.areBeyond = std::move(areBeyond);
  mesh.loopSides = std::move(sides);
  return {};
}

}  // namespace

Status clipTarget(const ClipCage& cage, const MeshView& target, std::uint8_t* takesPart, Arena& arena,
                  ClippedMesh& out) noexcept {
  if (!joinEqualPositions(target.positions, arena, takesPart)) return kOutOfMemory;
  const Status status = clipAlongLoops(cage, target, takesPart, arena, out);
  if (!status.ok() || cage.charts == nullptr) return status;
  return clipAlongSeams(cage, target, takesPart, arena, out);
}

}  // namespace cagecast
