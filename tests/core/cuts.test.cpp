#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "cuts.hpp"

// What holds for every cut mesh, tested on triangles and their edges, and cuts of one large triangle below a fine cage.
// `borders.test.cpp` tests points and lengths.
using namespace cagecast;

namespace {

/// Scenes that have little in common, for one seed.
std::vector<std::pair<scenes::Scene, TransferOptions>> scenesOf(std::uint64_t seed) {
  TransferOptions all = cutting(seed % 2 == 0 ? Seams::vertex : Seams::corner);
  TransferOptions loose = all;
  loose.steps.floor = false;
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

/// The corner of a quad of a flat cage: the quad's column and row, and its own.
struct SheetCorner {
  int i, j, column, row;
};

/// A flat cage of `quads` × `quads` quads, somewhat larger than the triangle below it, whose UVs are made quad by quad.
template <typename MakeUv>
scenes::Mesh sheet(int quads, float from, float to, MakeUv makeUv) {
  scenes::Mesh cage;
  const float step = (to - from) / static_cast<float>(quads);
  for (int j = 0; j < quads; ++j)
    for (int i = 0; i < quads; ++i) {
      const auto add = [&](int column, int row) {
        const float x = from + step * static_cast<float>(column), y = from + step * static_cast<float>(row);
        const std::array<float, 2> uv = makeUv(SheetCorner{i, j, column, row});
        return cage.addVertex({x, y, 0.1f}, 0.1f + 0.3f * (x + 0.2f) + uv[0], 0.1f + 0.3f * (y + 0.2f) + uv[1]);
      };
      const std::uint32_t a = add(i, j), b = add(i + 1, j), c = add(i + 1, j + 1), d = add(i, j + 1);
      cage.addTriangle(a, b, c);
      cage.addTriangle(a, c, d);
    }
  return cage;
}

scenes::Mesh oneTriangle() {
  scenes::Mesh mesh;
  mesh.addVertex({0, 0, 0});
  mesh.addVertex({1, 0, 0});
  mesh.addVertex({0, 1, 0});
  mesh.addTriangle(0, 1, 2);
  return mesh;
}

/// Cuts at whatever the cage has.
TransferOptions cuttingAll() {
  TransferOptions options = cutting();
  options.threshold = 0;
  options.steps.floor = false;
  return options;
}

/// A slit from the lower edge of a sheet up to a row, that opens to the right and closes within some columns.
float slit(SheetCorner at, int column, int row, int columns, float width) {
  if (at.i < column || at.column >= column + columns || at.row >= row) return 0;
  return width * static_cast<float>((row - at.row) * (column + columns - at.column)) /
         static_cast<float>(row * columns);
}

}  // namespace

TEST_CASE("an island is cut out also where a slit ends in the same triangle", "[borders]") {
  const auto uvOf = [](SheetCorner at) {
    const bool isIsland = at.i >= 14 && at.i < 16 && at.j >= 8 && at.j < 10;
    return std::array{slit(at, 10, 11, 6, 0.12f) + (isIsland ? 0.5f : 0), 0.0f};
  };
  const scenes::Mesh cage = sheet(28, -0.2f, 1.2f, uvOf), target = oneTriangle();
  const CutTarget cut = cutOf(cage.view(), target.view(), cuttingAll());
  const scenes::Mesh mesh = meshOf(target.view(), cut);
  double ofIsland = 0;
  for (std::size_t t = 0; t < cut.origins.size(); ++t) {
    const float* uvs = cut.cornerUvs.data() + 6 * t;
    if (std::min({uvs[0], uvs[2], uvs[4]}) > 0.6f) ofIsland += length(areaOf(mesh.view(), t));
  }
  CHECK(ofIsland == Approx(0.01).epsilon(0.05));
}

TEST_CASE("dozens of islands of a fine cage are not too complex for one triangle", "[borders]") {
  const auto uvOf = [](SheetCorner at) {
    const bool isIsland = at.i % 2 == 1 && at.j == 3;
    return std::array{isIsland ? 1 + 0.1f * static_cast<float>((7 * at.i + 39) % 97) : 0, 0.0f};
  };
  const scenes::Mesh cage = sheet(60, -0.05f, 1.05f, uvOf), target = oneTriangle();
  CHECK(cutOf(cage.view(), target.view(), cuttingAll()).origins.size() > 300);
}

TEST_CASE("what is given up for a finer division keeps no vertex from being removed", "[borders]") {
  scenes::Random random(9);
  std::vector<std::uint8_t> islands(56 * 56);
  for (int n = 0; n < 56 * 56; ++n) {
    const int i = n % 56, j = n / 56;
    const bool isChosen = random.below(100) < 5;
    islands[static_cast<std::size_t>(n)] = isChosen && (i < 18 || i > 22) && i % 2 == 1 && j % 2 == 1;
  }
  const auto uvOf = [&](SheetCorner at) {
    const bool isIsland = islands[static_cast<std::size_t>(56 * at.j + at.i)] != 0;
    return std::array{slit(at, 20, 44, 30, 0.2f) + (isIsland ? 1.5f : 0), 0.0f};
  };
  const scenes::Mesh cage = sheet(56, -0.2f, 1.2f, uvOf), target = oneTriangle();
  // 272 with vertices that were kept for pieces that are not there.
  CHECK(cutOf(cage.view(), target.view(), cuttingAll()).origins.size() <= 250);
}

TEST_CASE("a tolerance for welding does not join the new vertices of a cut", "[borders]") {
  const scenes::Scene scene = scenes::head(8);
  TransferOptions options = cutting();
  const CutTarget exact = cutOf(scene.cage.view(), scene.target.view(), options);
  options.weldTolerance = 1e-3f;
  const CutTarget welded = cutOf(scene.cage.view(), scene.target.view(), options);
  REQUIRE(welded.cornerUvs.size() == exact.cornerUvs.size());
  float most = 0;
  for (std::size_t i = 0; i < exact.cornerUvs.size(); ++i)
    most = std::max(most, std::abs(welded.cornerUvs[i] - exact.cornerUvs[i]));
  CHECK(most < 0.01f);
  CHECK(std::equal(exact.cosmeticTriangles.begin(), exact.cosmeticTriangles.end(), welded.cosmeticTriangles.begin()));
}

TEST_CASE("triangles without area do not change what a cut leaves unpainted", "[borders]") {
  const scenes::Scene scene = scenes::head(16);
  scenes::Mesh strips = scene.target;
  // As strips leave behind.
  for (std::size_t i = 0; i < scene.target.indices.size(); i += 3)
    strips.addTriangle(scene.target.indices[i], scene.target.indices[i + 1], scene.target.indices[i]);
  const TransferOptions options = cutting(Seams::vertex);
  const CutTarget cut = cutOf(scene.cage.view(), scene.target.view(), options);
  const CutTarget other = cutOf(scene.cage.view(), strips.view(), options);
  CHECK(std::equal(cut.zones.begin(), cut.zones.begin() + scene.target.vertexCount(), other.zones.begin()));
}

TEST_CASE("an edge is cut alike for all triangles on it; pieces fit without a gap, and use all vertices", "[borders]") {
  std::size_t flat = 0, all = 0;
  eachCut(10, [&](const scenes::Scene& scene, const TransferOptions&, const CutTarget& cut, const scenes::Mesh& mesh) {
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

    const std::set<std::uint32_t> used(cut.indices.begin(), cut.indices.end());
    std::size_t lost = 0;
    for (const std::uint32_t v : scene.target.indices) lost += used.count(v) == 0;
    for (std::uint32_t v = static_cast<std::uint32_t>(scene.target.vertexCount()); v < mesh.vertexCount(); ++v)
      lost += used.count(v) == 0;
    CHECK(lost == 0);
    for (std::size_t t = 0; t < cut.origins.size(); ++t, ++all)
      flat += length(areaOf(scene.target.view(), cut.origins[t])) > 0 && length(areaOf(mesh.view(), t)) == 0;
  });
  // Hardly a triangle without area: where borders meet at a vertex, another may be made in the same place.
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
