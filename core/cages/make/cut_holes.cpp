#include "make/steps.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace cagecast::cages {

namespace {

/// Where the field has this value a hole begins: a little outside of what is marked, which ends at ½.
constexpr double kBorderValue = 0.4;
/// The border keeps this share of an edge away from its ends, so that no triangle is a sliver.
constexpr double kCutFromEnds = 0.15;
/// Pieces that the cuts leave are dropped if they have less than this share of the area: gums between two teeth.
constexpr double kMinPiece = 0.01;

TriangleMesh withoutSplinters(const TriangleMesh& mesh) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> pieces = connectedPieces(mesh, count);
  std::vector<double> areas(count, 0);
  double total = 0;
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    const double area = length(areaNormal(mesh, mesh.triangles[t]));
    areas[pieces[t]] += area;
    total += area;
  }
  std::vector<bool> isKept(pieces.size());
  for (std::size_t t = 0; t < pieces.size(); ++t) isKept[t] = areas[pieces[t]] >= kMinPiece * total;
  return subset(mesh, isKept);
}

}  // namespace

TriangleMesh cutHoles(const TriangleMesh& mesh, const std::vector<double>& field) {
  TriangleMesh out;
  std::vector<std::uint32_t> kept(mesh.positions.size(), kNone);
  std::unordered_map<std::uint64_t, std::uint32_t> cuts;
  const auto keep = [&](std::uint32_t v) {
    if (kept[v] == kNone) {
      kept[v] = static_cast<std::uint32_t>(out.positions.size());
      out.positions.push_back(mesh.positions[v]);
    }
    return kept[v];
  };
  const auto cut = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, isNew] = cuts.try_emplace(edgeKey(a, b), static_cast<std::uint32_t>(out.positions.size()));
    if (isNew) {
      const std::uint32_t from = std::min(a, b), to = std::max(a, b);
      const double share =
          std::clamp((kBorderValue - field[from]) / (field[to] - field[from]), kCutFromEnds, 1 - kCutFromEnds);
      out.positions.push_back(mesh.positions[from] + share * (mesh.positions[to] - mesh.positions[from]));
    }
    return found->second;
  };
  for (const Triangle3& t : mesh.triangles) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t corners = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const bool isIn = field[a] < kBorderValue;
      if (isIn) polygon[corners++] = keep(a);
      if (isIn != (field[b] < kBorderValue)) polygon[corners++] = cut(a, b);
    }
    for (std::size_t i = 1; i + 1 < corners; ++i) out.triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
  }
  return withoutSplinters(out);
}

}  // namespace cagecast::cages
