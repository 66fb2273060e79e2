#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "cuts.hpp"

// What holds for every cut mesh, tested on triangles and their edges. `borders.test.cpp` tests points and
// lengths.
using namespace cagecast;

namespace {

/// Scenes that have little in common, for one seed.
std::vector<std::pair<scenes::Scene, TransferOptions>> scenesOf(std::uint64_t seed) {
  TransferOptions all = cutting(seed % 2 == 0 ? Seams::vertex : Seams::corner);
  TransferOptions loose = all;
  loose.steps.floor = Floor::none;
  loose.threshold = 0;
  return {{scenes::patchwork(seed), all}, {scenes::strewn(seed, 40), loose}, {scenes::gridded(seed, 40), loose}};
}

/// Calls with each scene, its cut target, and that as a mesh.
template <typename Call>
void eachCut(std::uint64_t count, Call call) {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + count; ++seed) {
    for (const auto& [scene, options] : scenesOf(seed)) {
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      const CutTarget cut = cutOf(scene.cage.view(), scene.target.view(), options);
      call(scene, options, cut, meshOf(scene.target.view(), cut));
    }
  }
}

bool isEdge(const std::uint32_t* corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

/// The new vertices on a side of a triangle, from its first end to its second.
std::vector<std::uint32_t> stopsOn(const scenes::Mesh& target, const CutTarget& cut,
                                   const std::set<std::uint32_t>& vertices, std::uint32_t from, std::uint32_t to) {
  std::vector<std::pair<float, std::uint32_t>> stops;
  for (const std::uint32_t v : vertices) {
    if (v < target.vertexCount()) continue;
    const std::size_t first = 3 * (v - target.vertexCount());
    float ofFrom = 0, ofTo = 0;
    for (std::size_t i = first; i < first + 3; ++i) {
      if (cut.sources[i] == from) ofFrom += cut.weights[i];
      if (cut.sources[i] == to) ofTo += cut.weights[i];
    }
    if (ofFrom + ofTo == 1) stops.emplace_back(ofTo, v);
  }
  std::sort(stops.begin(), stops.end());
  std::vector<std::uint32_t> result;
  for (const auto& stop : stops) result.push_back(stop.second);
  return result;
}

}  // namespace

TEST_CASE("an edge is cut alike for all triangles on it, and pieces fit without a gap", "[borders]") {
  eachCut(10, [](const scenes::Scene& scene, const TransferOptions&, const CutTarget& cut, const scenes::Mesh& mesh) {
    const auto place = [&](std::uint32_t v) {
      const scenes::Point p = mesh.vertex(v);
      return scenes::Point{p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f};
    };
    std::map<std::pair<scenes::Point, scenes::Point>, std::set<std::set<scenes::Point>>> edges;
    std::size_t gaps = 0, torn = 0, piece = 0;
    for (std::uint32_t t = 0; t < scene.target.triangleCount(); ++t) {
      const std::uint32_t* corners = scene.target.indices.data() + std::size_t{3} * t;
      // What runs along an edge in one direction more often than in the other: of all pieces, that is the triangle's
      // own border.
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
      const auto use = [&](std::uint32_t a, std::uint32_t b, int times) {
        uses[{std::min(a, b), std::max(a, b)}] += a < b ? times : -times;
      };
      std::set<std::uint32_t> vertices;
      for (; piece < cut.origins.size() && cut.origins[piece] == t; ++piece) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = cut.indices[3 * piece + k];
          vertices.insert(a);
          use(a, cut.indices[3 * piece + (k + 1) % 3], 1);
        }
      }
      if (isEdge(corners)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
        std::uint32_t last = from;
        std::set<scenes::Point> places;
        for (const std::uint32_t v : stopsOn(scene.target, cut, vertices, from, to)) {
          use(last, v, -1);
          places.insert(place(v));
          last = v;
        }
        use(last, to, -1);
        edges[std::minmax(place(from), place(to))].insert(places);
      }
      for (const auto& [ends, times] : uses) gaps += times != 0;
    }
    for (const auto& [ends, ways] : edges) torn += ways.size() > 1;
    CHECK(piece == cut.origins.size());
    CHECK(gaps == 0);
    CHECK(torn == 0);
  });
}

TEST_CASE("a cut adds no vertex that nothing uses, and hardly a triangle without area", "[borders]") {
  std::size_t flat = 0, all = 0;
  eachCut(10, [&](const scenes::Scene& scene, const TransferOptions&, const CutTarget& cut, const scenes::Mesh& mesh) {
    std::set<std::uint32_t> used(cut.indices.begin(), cut.indices.end());
    std::size_t lost = 0;
    for (const std::uint32_t v : scene.target.indices) lost += used.count(v) == 0;
    for (std::size_t v = scene.target.vertexCount(); v < mesh.vertexCount(); ++v)
      lost += used.count(static_cast<std::uint32_t>(v)) == 0;
    CHECK(lost == 0);
    for (std::size_t t = 0; t < cut.origins.size(); ++t) {
      flat += length(areaOf(scene.target.view(), cut.origins[t])) > 0 && length(areaOf(mesh.view(), t)) == 0;
      ++all;
    }
  });
  // Where borders meet at a vertex, another may be made in the same place.
  CHECK(flat * 5000 <= all);
}

TEST_CASE("a cut does not depend on the order of triangles and vertices", "[borders]") {
  eachCut(6, [](const scenes::Scene& scene, const TransferOptions& options, const CutTarget& cut,
                const scenes::Mesh& mesh) {
    scenes::Random random(7);
    std::vector<std::uint32_t> order;
    const scenes::Mesh target = scenes::shuffled(scene.target, random, order);
    const CutTarget other = cutOf(scene.cage.view(), target.view(), options);
    // Triangles as the places of their corners, and whether they are painted.
    const auto pieces = [](const CutTarget& from, const scenes::Mesh& of) {
      std::vector<std::pair<std::array<scenes::Point, 3>, std::uint8_t>> all;
      for (std::size_t t = 0; t < from.origins.size(); ++t) {
        all.push_back(
            {{of.vertex(of.indices[3 * t]), of.vertex(of.indices[3 * t + 1]), of.vertex(of.indices[3 * t + 2])},
             from.cosmeticTriangles[t]});
      }
      std::sort(all.begin(), all.end());
      return all;
    };
    CHECK((pieces(cut, mesh) == pieces(other, meshOf(target.view(), other))));
  });
}
