#include "clip/clip_target.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/hash_index.hpp"
#include "clip/triangle_cutter.hpp"

namespace cagecast {
namespace {

/// Lets vertices in one place take part together if any does: they are the ends of edges that are cut alike.
/// @param[in,out] takesPart  1 per vertex.
/// @return false if memory ran out.
bool joinPlaces(std::span<const float> positions, Arena& arena, std::uint8_t* takesPart) noexcept {
  struct Site {
    float x, y, z;
    bool operator==(const Site& other) const { return std::memcmp(this, &other, sizeof(Site)) == 0; }
  };
  const auto count = static_cast<std::uint32_t>(positions.size() / 3);
  const auto siteOf = [&](std::uint32_t v) {
    const float* p = positions.data() + std::size_t{3} * v;
    return Site{p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f};  // Now −0 is 0.
  };
  const Arena::Mark mark = arena.mark();
  HashIndex places(count, arena);
  auto* first = arena.allocate<std::uint32_t>(count);
  if (arena.failed()) return false;
  for (std::uint32_t v = 0; v < count; ++v) {
    const Site site = siteOf(v);
    first[v] = places.firstEqual(v, HashIndex::hash(site), [&](std::uint32_t other) { return siteOf(other) == site; });
    takesPart[first[v]] |= takesPart[v];
  }
  for (std::uint32_t v = 0; v < count; ++v) takesPart[v] = takesPart[first[v]];
  arena.rewind(mark);
  return true;
}

/// A blend of up to three vertices of the target.
class Blend {
 public:
  void add(std::uint32_t vertex, double weight) noexcept {
    int i = 0;
    while (i < count_ && vertices_[i] != vertex) ++i;
    if (i == count_) {
      if (count_ == 3) return;  // Of no weight: all that is inside a triangle is a blend of its corners.
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
  std::uint32_t vertices_[3];
  double weights_[3];
  int count_ = 0;
};

/// Takes what was cut over: blends of vertices that are blends themselves become blends of vertices of the target.
bool takeOver(const MeshView& target, const CutTriangles& cut, CutMesh& out) noexcept {
  const std::size_t ownCount = target.positions.size() / 3;
  const std::size_t before = ownCount + out.sources.size() / 3;
  const std::size_t added = cut.sources.size() / 3;
  const std::size_t all = before + added;
  Array<std::uint32_t> sources, indices, origins;
  Array<float> weights, positions;
  if (!sources.reset(3 * (all - ownCount)) || !weights.reset(3 * (all - ownCount)) || !positions.reset(3 * all) ||
      !cut.indices.copyTo(indices) || !cut.origins.copyTo(origins)) {
    return false;
  }
  std::copy(out.sources.begin(), out.sources.end(), sources.begin());
  std::copy(out.weights.begin(), out.weights.end(), weights.begin());
  std::copy(target.positions.begin(), target.positions.end(), positions.begin());
  if (out.positions.size() > 0) std::copy(out.positions.begin(), out.positions.end(), positions.begin());
  for (std::size_t n = 0; n < added; ++n) {
    Blend blend;
    for (std::size_t i = 3 * n; i < 3 * n + 3; ++i) {
      const std::size_t vertex = cut.sources[i];
      const auto weight = static_cast<double>(cut.weights[i]);
      if (weight == 0) continue;
      if (vertex < ownCount) {
        blend.add(cut.sources[i], weight);
        continue;
      }
      for (std::size_t j = 3 * (vertex - ownCount); j < 3 * (vertex - ownCount) + 3; ++j) {
        if (weights[j] > 0) blend.add(sources[j], weight * static_cast<double>(weights[j]));
      }
    }
    const std::size_t to = before + n;
    blend.write(sources.data() + 3 * (to - ownCount), weights.data() + 3 * (to - ownCount));
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t i = 3 * (to - ownCount); i < 3 * (to - ownCount) + 3; ++i) {
        sum += static_cast<double>(weights[i]) * static_cast<double>(target.positions[std::size_t{3} * sources[i] + k]);
      }
      positions[3 * to + k] = static_cast<float>(sum);
    }
  }
  if (out.origins.size() > 0) {
    for (std::uint32_t& origin : origins) origin = out.origins[origin];
  }
  out.sources = std::move(sources);
  out.weights = std::move(weights);
  out.positions = std::move(positions);
  out.indices = std::move(indices);
  out.origins = std::move(origins);
  return true;
}

}  // namespace

bool cutTarget(const MeshView& cageMesh, const MeshView& target, const Cage& cage, const CageTree& tree,
               const BoundaryLoops& loops, const UvCharts* charts, const Units& units, std::uint8_t* takesPart,
               Arena& arena, CutMesh& out) noexcept {
  const auto scale = static_cast<double>(units.scale);
  const std::size_t ownCount = target.positions.size() / 3;
  if (!joinPlaces(target.positions, arena, takesPart)) return false;
  {
    const Arena::Mark mark = arena.mark();
    BorderClassifier classifier(cageMesh, cage, tree, loops, nullptr, units, arena);
    CutTriangles cut;
    if (arena.failed() || !cutTriangles(target, scale, units.diagonal, takesPart, classifier, arena, cut) ||
        !takeOver(target, cut, out) || !out.vertexSides.reset(cut.onBorder.size()) ||
        !out.areBeyond.reset(cut.sides.size())) {
      return false;
    }
    std::fill(out.vertexSides.begin(), out.vertexSides.end(), BoundarySide::inside);
    for (std::size_t t = 0; t < cut.sides.size(); ++t) {
      out.areBeyond[t] = cut.sides[t] != 0;
      for (std::size_t i = 3 * t; i < 3 * t + 3 && cut.sides[t] != 0; ++i)
        out.vertexSides[cut.indices[i]] = BoundarySide::beyond;
    }
    for (std::size_t t = 0; t < cut.sides.size(); ++t) {
      const std::uint32_t* corners = target.indices.data() + std::size_t{3} * cut.origins[t];
      const bool isPart = std::all_of(corners, corners + 3, [&](std::uint32_t v) { return takesPart[v] != 0; });
      for (std::size_t i = 3 * t; i < 3 * t + 3 && isPart && cut.sides[t] == 0; ++i)
        out.vertexSides[cut.indices[i]] = BoundarySide::inside;
    }
    for (std::size_t v = 0; v < out.vertexSides.size(); ++v) {
      if (cut.onBorder[v] != 0) out.vertexSides[v] = BoundarySide::onBorder;
    }
    arena.rewind(mark);
  }
  if (charts == nullptr) return true;

  // What is beyond a loop is not painted: its seams do not matter.
  const std::size_t count = out.vertexSides.size();
  auto* isPainted = arena.allocate<std::uint8_t>(count);
  BorderClassifier classifier(cageMesh, cage, tree, loops, charts, units, arena);
  if (arena.failed()) return false;
  for (std::size_t v = 0; v < count; ++v) {
    const auto takes = [&](std::size_t i) { return takesPart[out.sources[3 * (v - ownCount) + i]] != 0; };
    isPainted[v] = out.vertexSides[v] != BoundarySide::beyond &&
                   (v < ownCount ? takesPart[v] != 0 : takes(0) && takes(1) && takes(2));
  }
  if (!joinPlaces(out.positions, arena, isPainted)) return false;
  CutTriangles cut;
  Array<std::uint32_t> before;
  if (!before.reset(out.indices.size())) return false;
  std::copy(out.indices.begin(), out.indices.end(), before.begin());
  if (!cutTriangles({out.positions, before}, scale, units.diagonal, isPainted, classifier, arena, cut)) return false;
  Array<std::uint8_t> areBeyond;
  Array<BoundarySide> sides;
  if (!areBeyond.reset(cut.origins.size()) || !sides.reset(cut.onBorder.size())) return false;
  for (std::size_t t = 0; t < areBeyond.size(); ++t) areBeyond[t] = out.areBeyond[cut.origins[t]];
  std::copy(out.vertexSides.begin(), out.vertexSides.end(), sides.begin());
  for (std::size_t v = count; v < sides.size(); ++v) {
    // On a border if all that it is a blend of is.
    sides[v] = BoundarySide::onBorder;
    for (std::size_t i = 3 * (v - count); i < 3 * (v - count) + 3; ++i) {
      if (cut.weights[i] > 0 && sides[v] == BoundarySide::onBorder) sides[v] = out.vertexSides[cut.sources[i]];
    }
  }
  if (!takeOver(target, cut, out)) return false;
  out.areBeyond = std::move(areBeyond);
  out.vertexSides = std::move(sides);
  return true;
}

}  // namespace cagecast
