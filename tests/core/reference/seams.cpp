#include <algorithm>
#include <cmath>
#include <map>

#include "reference/scene.hpp"

namespace cagecast::reference {
namespace {

using Uv = std::array<double, 2>;

// What the cage explains of a UV edge is allowed to be this much too little, and this much (in UV) besides.
constexpr double kSmear = 4, kSmearSlack = 0.005;
// How far from a corner's place its patch reaches: this many longest edges, and this share of the diagonal besides.
constexpr double kPatchEdges = 1.5, kPatchSlack = 0.01;
// Sums of distances within this share of the diagonal are equal.
constexpr double kSumTie = 1e-7;
// What is nearer than this (relatively) to a limit may as well be on its other side.
constexpr double kUnsure = 1e-6;

double apart(Uv a, Uv b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

/// Which triangles of the cage hang together in the texture: over edges with equal position and UV at both ends.
struct UvCharts {
  std::vector<std::vector<std::uint32_t>> neighbours;  // Per usable triangle.
  std::vector<std::uint32_t> islands;                  // Per usable triangle.
  std::vector<double> stretch;                         // Per usable triangle: most UV per length of its edges.
};

UvCharts findUvCharts(const MeshView& cage, const Scene& scene) {
  const auto& triangles = scene.cage.triangles();
  UvCharts charts;
  charts.neighbours.resize(triangles.size());
  using End = std::array<double, 5>;
  std::map<std::pair<End, End>, std::vector<std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::array<End, 3> ends{};
    std::array<Uv, 3> uvs{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t corner = cage.indices[std::size_t{triangles[t].index} * 3 + c];
      uvs[c] = {static_cast<double>(cage.uvs[corner * 2]), static_cast<double>(cage.uvs[corner * 2 + 1])};
      const Vec p = triangles[t].corners[c];
      ends[c] = {p.x, p.y, p.z, uvs[c][0], uvs[c][1]};
    }
    double stretch = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      edges[std::minmax(ends[k], ends[l])].push_back(t);
      stretch = std::max(stretch, apart(uvs[k], uvs[l]) / length(triangles[t].corners[k] - triangles[t].corners[l]));
    }
    charts.stretch.push_back(stretch);
  }
  Sets sets(triangles.size());
  for (const auto& [ends, sharing] : edges)
    for (const std::uint32_t s : sharing)
      for (const std::uint32_t t : sharing) {
        if (s == t) continue;
        charts.neighbours[s].push_back(t);
        sets.join(s, t);
      }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) charts.islands.push_back(sets.find(t));
  return charts;
}

}  // namespace

std::vector<float> cornerUvs(const MeshView& cage, const MeshView& target, const Scene& scene,
                             const std::vector<ClosestPoint>& places, const std::vector<float>& uvs,
                             std::vector<std::uint8_t>& stable) {
  const UvCharts charts = findUvCharts(cage, scene);
  const Triangle* first = scene.cage.triangles().data();
  const auto number = [&](const ClosestPoint& place) { return static_cast<std::uint32_t>(place.triangle - first); };
  std::vector<float> result;
  for (const std::uint32_t v : target.indices) result.insert(result.end(), {uvs[v * 2], uvs[v * 2 + 1]});
  stable.assign(target.indices.size() / 3, 1);

  for (std::size_t i = 0; i < scene.corners.size(); ++i) {
    const Triangle& triangle = scene.target.triangles()[i];
    std::array<ClosestPoint, 3> own;
    for (std::size_t c = 0; c < 3; ++c) own[c] = places[scene.corners[i][c]];
    bool apartInTexture = false, smeared = false, unsure = false;
    double longest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3;
      const std::uint32_t s = number(own[c]), t = number(own[d]);
      apartInTexture = apartInTexture || charts.islands[s] != charts.islands[t];
      const double edge = length(triangle.corners[c] - triangle.corners[d]);
      longest = std::max(longest, edge);
      const double explained = std::max(charts.stretch[s], charts.stretch[t]) *
                               (edge + std::abs(own[c].nearest.distance - own[d].nearest.distance));
      const double limit = kSmear * explained + kSmearSlack, uvLength = apart(uvAt(cage, own[c]), uvAt(cage, own[d]));
      smeared = smeared || uvLength > limit;
      unsure = unsure || std::abs(uvLength - limit) <= kUnsure * limit;
    }
    if (!apartInTexture && unsure) stable[triangle.index] = 0;
    if (!apartInTexture && !smeared) continue;

    struct Choice {
      double sum = kInfinity;
      std::array<ClosestPoint, 3> places;
    };
    std::vector<Choice> choices;
    const double reach = kPatchEdges * longest + kPatchSlack * scene.diag;
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::any_of(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(k),
                      [&](const ClosestPoint& earlier) { return earlier.triangle == own[k].triangle; }))
        continue;
      // Flood the cage from the corner's triangle, over edges shared in the texture.
      const Vec q = own[k].position();
      std::vector<std::uint32_t> patch{number(own[k])};
      for (std::size_t next = 0; next < patch.size(); ++next)
        for (const std::uint32_t t : charts.neighbours[patch[next]]) {
          const double distance = nearestOn(first[t], q).distance;
          if (std::abs(distance - reach) <= kUnsure * reach) stable[triangle.index] = 0;
          if (distance <= reach && std::find(patch.begin(), patch.end(), t) == patch.end()) patch.push_back(t);
        }
      std::sort(patch.begin(), patch.end());
      std::vector<const Triangle*> triangles;
      for (const std::uint32_t t : patch) triangles.push_back(first + t);
      Choice choice{0, {}};
      for (std::size_t c = 0; c < 3; ++c) {
        // Projecting again finds what is nearest of the whole cage, but where a chain of places ties.
        const bool isOwn = std::binary_search(patch.begin(), patch.end(), number(own[c]));
        choice.places[c] = isOwn ? own[c] : project(triangles, triangle.corners[c], scene.diag);
        choice.sum += choice.places[c].nearest.distance;
      }
      choices.push_back(choice);
    }
    double least = kInfinity;
    for (const Choice& choice : choices) least = std::min(least, choice.sum);
    for (const Choice& choice : choices)
      if (std::abs(choice.sum - least - kSumTie * scene.diag) <= kSumTie / 2 * scene.diag) stable[triangle.index] = 0;
    const auto chosen = std::find_if(choices.begin(), choices.end(),
                                     [&](const Choice& choice) { return choice.sum <= least + kSumTie * scene.diag; });
    for (std::size_t c = 0; c < 3; ++c) {
      const Uv uv = uvAt(cage, chosen->places[c]);
      for (std::size_t k = 0; k < 2; ++k)
        result[(triangle.index * std::size_t{3} + c) * 2 + k] = static_cast<float>(uv[k]);
    }
  }
  return result;
}

}  // namespace cagecast::reference
