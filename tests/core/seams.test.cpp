#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <tuple>

#include "cagecast/split.hpp"
#include "checks.hpp"
#include "cuts.hpp"
#ifdef CAGECAST_GLTF
#include "assets.hpp"
#endif

using namespace cagecast;

namespace {

TransferResult withCorners(const MeshView& cage, const MeshView& target, float weldTolerance = 0) {
  TransferOptions options = TransferOptions::paper();
  options.seams = Seams::corner;
  options.weldTolerance = weldTolerance;
  return transferred(cage, target, options);
}

struct Found {
  std::size_t triangles = 0;
  std::size_t unstable = 0;     ///< Those whose patch rounding decides.
  std::size_t reprojected = 0;  ///< Those whose corners do not have the UVs of their vertices.
  std::size_t different = 0;    ///< Stable ones whose UVs are not the reference's.
};

/// Compares the UVs of all corners with the reference's.
Found compareCorners(const std::string& name, const MeshView& cage, const MeshView& target, float weldTolerance = 0) {
  constexpr float kTolerance = 1e-5f;
  const TransferResult product = withCorners(cage, target, weldTolerance);
  reference::Options options = reference::Options::paper();
  options.seams = true;
  options.stability = false;  // Of zones, which are not looked at here.
  options.weldTolerance = static_cast<double>(weldTolerance);
  const reference::Result expected = reference::transfer(cage, target, options);
  const Array<float>& got = product.projection.cornerUvs;
  REQUIRE(got.size() == 2 * target.indices.size());
  REQUIRE(got.size() == expected.cornerUvs.size());
  Found found;
  found.triangles = target.indices.size() / 3;
  std::string details;
  for (std::size_t t = 0; t < found.triangles; ++t) {
    bool isReprojected = false, isOther = false;
    for (std::size_t i = 6 * t; i < 6 * t + 6; ++i) {
      const float want = expected.cornerUvs[i];
      isReprojected = isReprojected || got[i] != product.projection.uvs[target.indices[i / 2] * std::size_t{2} + i % 2];
      isOther = isOther || !(std::abs(got[i] - want) <= kTolerance * std::max(1.0f, std::abs(want)));
    }
    found.reprojected += isReprojected;
    if (expected.stableCorners[t] == 0) {
      ++found.unstable;
    } else if (isOther) {
      if (found.different++ < 10) details += " " + std::to_string(t);
    }
  }
  INFO(name << ": other UVs at triangles" << details);
  CHECK(found.different == 0);
  return found;
}

/// A tube around the y axis whose texture is one chart, cut open along one line; u goes around.
scenes::Mesh tube(float radius, int around, int along) {
  // A square blown up to a circle, so that no sine is needed.
  const auto onCircle = [&](int i) {
    const int quarter = around / 4;
    const float share = 2 * static_cast<float>(i % quarter) / static_cast<float>(quarter) - 1;
    const scenes::Point sides[4] = {{1, 0, share}, {-share, 0, 1}, {-1, 0, -share}, {share, 0, -1}};
    const scenes::Point p = sides[i / quarter % 4];
    const float size = radius / std::sqrt(p[0] * p[0] + p[2] * p[2]);
    return scenes::Point{p[0] * size, 0, p[2] * size};
  };
  scenes::Mesh mesh;
  const auto row = static_cast<std::uint32_t>(around + 1);
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i <= around; ++i) {
      scenes::Point p = onCircle(i);
      const float v = static_cast<float>(j) / static_cast<float>(along);
      p[1] = 4 * v - 2;
      mesh.addVertex(p, static_cast<float>(i) / static_cast<float>(around), v);
    }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(along); ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = j * row + i, b = a + 1, c = b + row, d = a + row;
      mesh.addTriangle(a, c, b);
      mesh.addTriangle(a, d, c);
    }
  return mesh;
}

double lengthOf(const MeshView& mesh, std::uint32_t v, std::uint32_t w) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = static_cast<double>(mesh.positions[v * std::size_t{3} + k]) -
                     static_cast<double>(mesh.positions[w * std::size_t{3} + k]);
    sum += d * d;
  }
  return std::sqrt(sum);
}

double apart(const float* a, const float* b) {
  return std::hypot(static_cast<double>(a[0]) - static_cast<double>(b[0]),
                    static_cast<double>(a[1]) - static_cast<double>(b[1]));
}

struct Smear {
  double vertex = 0, corner = 0;  ///< Shares of the painted area.
};

/// How much of what is painted is smeared: has an edge whose UV length is more than four times what the cage triangles
/// under its ends explain.
Smear smearOf(const MeshView& cage, const MeshView& target, const TransferResult& result) {
  std::vector<double> stretch(cage.indices.size() / 3);
  for (std::size_t i = 0; i < cage.indices.size(); ++i) {
    const std::size_t t = i / 3;
    const std::uint32_t v = cage.indices[i], w = cage.indices[3 * t + (i + 1) % 3];
    const double edge = lengthOf(cage, v, w);
    if (edge > 0)
      stretch[t] = std::max(stretch[t], apart(&cage.uvs[v * std::size_t{2}], &cage.uvs[w * std::size_t{2}]) / edge);
  }
  double painted = 0;
  Smear smear;
  for (std::size_t t = 0; t < target.indices.size() / 3; ++t) {
    if (result.zones.cosmeticTriangles[t] == 0) continue;
    bool byVertex = false, byCorner = false;
    double edges[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = 3 * t + k, j = 3 * t + (k + 1) % 3;
      const std::uint32_t v = target.indices[i], w = target.indices[j];
      const Projection& projection = result.projection;
      edges[k] = lengthOf(target, v, w);
      const double path = edges[k] + std::abs(static_cast<double>(projection.distances[v]) -
                                              static_cast<double>(projection.distances[w]));
      const double limit =
          4 * std::max(stretch[projection.triangles[v]], stretch[projection.triangles[w]]) * path + 0.005;
      byVertex = byVertex || apart(&projection.uvs[v * std::size_t{2}], &projection.uvs[w * std::size_t{2}]) > limit;
      byCorner = byCorner || apart(&projection.cornerUvs[2 * i], &projection.cornerUvs[2 * j]) > limit;
    }
    const double half = (edges[0] + edges[1] + edges[2]) / 2;
    const double area = std::sqrt(std::max(0.0, half * (half - edges[0]) * (half - edges[1]) * (half - edges[2])));
    painted += area;
    if (byVertex) smear.vertex += area;
    if (byCorner) smear.corner += area;
  }
  if (painted > 0) smear = {smear.vertex / painted, smear.corner / painted};
  return smear;
}

/// Checks that a split mesh is the mesh, with the UVs of its corners.
void requireSameCorners(const MeshView& target, const Array<float>& cornerUvs, const SplitVertices& split) {
  REQUIRE(split.indices.size() == target.indices.size());
  REQUIRE(split.uvs.size() == 2 * split.sources.size());
  std::size_t elsewhere = 0, otherUvs = 0, notInOrder = 0;
  std::uint32_t met = 0;
  std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> known;
  for (std::size_t i = 0; i < split.indices.size(); ++i) {
    const std::uint32_t v = split.indices[i];
    REQUIRE(v < split.sources.size());
    notInOrder += v > met;
    met = std::max(met, v + 1);
    elsewhere += split.sources[v] != target.indices[i];
    for (std::size_t k = 0; k < 2; ++k) otherUvs += split.uvs[v * std::size_t{2} + k] != cornerUvs[2 * i + k];
    known.try_emplace({target.indices[i], cornerUvs[2 * i], cornerUvs[2 * i + 1]}, v);
  }
  CHECK(elsewhere == 0);
  CHECK(otherUvs == 0);
  CHECK(notInOrder == 0);
  CHECK(met == split.sources.size());           // Every new vertex is used,
  CHECK(known.size() == split.sources.size());  // and no two are the same.
}

}  // namespace

TEST_CASE("corners get the reference's UVs in cages of six charts", "[seams]") {
  std::size_t reprojected = 0;
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 15; ++seed) {
    const scenes::Scene scene = scenes::strewn(seed, seed % 3 == 0 ? 800 : 60);
    INFO("CAGECAST_SEED=" << seed);
    const Found found = compareCorners(scene.name, scene.cage.view(), scene.target.view());
    CHECK(found.unstable * 50 <= found.triangles);
    reprojected += found.reprojected;
  }
  CHECK(reprojected > 100);
}

TEST_CASE("corners get the reference's UVs where everything lies on a grid", "[seams]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 10; ++seed) {
    const scenes::Scene scene = scenes::gridded(seed, 200);
    INFO("CAGECAST_SEED=" << seed);
    compareCorners(scene.name, scene.cage.view(), scene.target.view());
    const std::array<int, 4> turn{3, 1, -2, 1};
    compareCorners(scene.name + " rotated", rotated(scene.cage, turn).view(), rotated(scene.target, turn).view());
  }
}

TEST_CASE("corners get the reference's UVs on a head, and on all fixed scenes", "[seams]") {
  for (const int cells : {8, 20, 31}) {
    const scenes::Scene scene = scenes::head(cells);
    const Found found = compareCorners(scene.name, scene.cage.view(), scene.target.view());
    CHECK(found.reprojected > 10);
    CHECK(found.unstable * 100 <= found.triangles);
  }
  for (const scenes::Scene& scene : scenes::golden())
    compareCorners(scene.name, scene.cage.view(), scene.target.view());
}

TEST_CASE("corners get the reference's UVs where places tie, as on cuts", "[seams]") {
  for (const scenes::Scene& scene : scenes::goldenBorders()) {
    scenes::Mesh pieces = meshOf(scene.target.view(), cutOf(scene.cage.view(), scene.target.view(), cutting()));
    pieces.uvs.clear();  // The target's own are none of ours.
    CHECK(compareCorners(scene.name + ", cut", scene.cage.view(), pieces.view()).reprojected > 10);
  }
}

TEST_CASE("corners get the reference's UVs where a chart meets itself along its cut", "[seams]") {
  const scenes::Mesh ball = scenes::ellipsoid({}, {1, 1.5f, 1}, 14);
  for (const int around : {8, 24, 60}) {
    const scenes::Mesh cage = tube(1.2f, around, around / 2);
    const Found found = compareCorners("tube of " + std::to_string(around), cage.view(), ball.view());
    CHECK(found.reprojected > 10);
    CHECK(found.unstable * 50 <= found.triangles);
    CHECK(smearOf(cage.view(), ball.view(), withCorners(cage.view(), ball.view())).vertex > 0.01);
    CHECK(smearOf(cage.view(), ball.view(), withCorners(cage.view(), ball.view())).corner < 0.001);
  }
}

TEST_CASE("a target is cut where a chart meets itself along its cut, either way up", "[seams][borders]") {
  const scenes::Mesh ball = scenes::rotated(scenes::ellipsoid({}, {1, 1, 1}, 14), {3, 1, -2, 1});
  scenes::Mesh cage = tube(1.2f, 24, 12);
  const bool isTurned = GENERATE(false, true);
  for (std::size_t i = 0; i < cage.uvs.size() && isTurned; i += 2) std::swap(cage.uvs[i], cage.uvs[i + 1]);
  const scenes::Mesh pieces = meshOf(ball.view(), cutOf(cage.view(), ball.view(), cutting()));
  // The tube is open along x = -z, where x is positive.
  std::size_t near = 0, across = 0;
  for (std::size_t t = 0; t < pieces.triangleCount(); ++t) {
    float low = 1, high = -1;
    bool isNear = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const scenes::Point p = pieces.vertex(pieces.indices[3 * t + k]);
      isNear = isNear && p[0] > 0.2f && p[2] < -0.2f;
      low = std::min(low, p[0] + p[2]);
      high = std::max(high, p[0] + p[2]);
    }
    near += isNear;
    across += isNear && low < -1e-3f && high > 1e-3f;
  }
  CHECK(near > 100);
  CHECK(across == 0);
}

TEST_CASE("corners get the reference's UVs in any cage", "[seams]") {
  const scenes::Mesh ball = scenes::ellipsoid({0.02f, -0.03f, 0.01f}, {1, 1, 0.9f}, 9);
  const scenes::Scene strewn = scenes::strewn(firstSeed(), 200);
  SECTION("denser than the target") {
    compareCorners("dense", scenes::ellipsoid({}, {1.1f, 1.1f, 1.1f}, 30).view(),
                   scenes::ellipsoid({}, {1, 1, 1}, 3).view());
  }
  SECTION("coarser than the target") {
    compareCorners("coarse", scenes::box({}, {1.5f, 1.4f, 1.6f}, 1).view(), ball.view());
  }
  SECTION("each triangle a chart") {
    scenes::Mesh apart;
    for (const std::uint32_t index : strewn.cage.indices) {
      const auto number = static_cast<float>(apart.vertexCount());
      apart.addVertex(strewn.cage.vertex(index), number / 1000, number / 500);
    }
    for (std::uint32_t i = 0; i < apart.vertexCount(); i += 3) apart.addTriangle(i, i + 1, i + 2);
    CHECK(compareCorners("apart", apart.view(), ball.view()).reprojected > 50);
    compareCorners("apart", apart.view(), strewn.target.view());
  }
  SECTION("its triangles stacked on each other: edges of many triangles") {
    scenes::Mesh stacked = strewn.cage;
    for (int copy = 0; copy < 3; ++copy)
      stacked.indices.insert(stacked.indices.end(), strewn.cage.indices.begin(), strewn.cage.indices.end());
    compareCorners("stacked", stacked.view(), ball.view());
  }
  SECTION("more equally near triangles than can be listed at once") {
    const scenes::Mesh once = tube(1.5f, 4, 2);
    scenes::Mesh stacked = once;
    for (int copy = 1; copy < 200; ++copy)
      stacked.indices.insert(stacked.indices.end(), once.indices.begin(), once.indices.end());
    const scenes::Mesh fine = scenes::ellipsoid({0.02f, -0.03f, 0.01f}, {1, 1.5f, 0.9f}, 40);
    CHECK(compareCorners("once", once.view(), fine.view()).reprojected > 100);
    CHECK(copied(withCorners(stacked.view(), fine.view()).projection.cornerUvs) ==
          copied(withCorners(once.view(), fine.view()).projection.cornerUvs));
  }
  SECTION("edges of many triangles, of which some are one in the texture") {
    // Of two to four copies of each triangle two have UVs that meet, the others their own. Which is first, and so the
    // nearest, changes.
    const scenes::Mesh shell = scenes::ellipsoid({}, {1.1f, 1.1f, 1.1f}, 5);
    scenes::Mesh mixed;
    const auto add = [&](std::size_t triangle, float shift) {
      const auto first = static_cast<std::uint32_t>(mixed.vertexCount());
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t index = shell.indices[3 * triangle + k];
        mixed.addVertex(shell.vertex(index), shell.uvs[index * std::size_t{2}] + shift,
                        shell.uvs[index * std::size_t{2} + 1]);
      }
      mixed.addTriangle(first, first + 1, first + 2);
    };
    for (std::size_t t = 0; t < shell.indices.size() / 3; ++t) {
      const bool isFirst = t / 7 % 2 == 0;
      add(t, isFirst ? 0.0f : 3.0f);
      add(t, isFirst ? 3.0f : 0.0f);
      if (t % 3 == 0) add(t, 0);
      if (t % 5 == 0) add(t, 5.0f + static_cast<float>(t));
    }
    CHECK(compareCorners("mixed", mixed.view(), ball.view()).reprojected > 50);
  }
  SECTION("vertices split, or equal up to the sign of zero, hold together all the same") {
    scenes::Mesh split;
    for (const std::uint32_t index : strewn.cage.indices) {
      scenes::Point p = strewn.cage.vertex(index);
      for (float& x : p)
        if (x == 0 && split.vertexCount() % 2 == 0) x = -0.0f;
      split.addVertex(p, strewn.cage.uvs[index * std::size_t{2}], strewn.cage.uvs[index * std::size_t{2} + 1]);
    }
    for (std::uint32_t i = 0; i < split.vertexCount(); i += 3) split.addTriangle(i, i + 1, i + 2);
    compareCorners("split", split.view(), ball.view());
    CHECK(copied(withCorners(split.view(), ball.view()).projection.cornerUvs) ==
          copied(withCorners(strewn.cage.view(), ball.view()).projection.cornerUvs));
  }
  SECTION("UVs far from 0..1") {
    for (const float offset : {-3.0f, 1000.0f, 40000.0f, 1e7f}) {
      scenes::Mesh far = strewn.cage;
      for (float& x : far.uvs) x = 4 * x + offset;
      INFO("offset " << offset);
      compareCorners("far UVs", far.view(), ball.view());
    }
  }
  SECTION("all UVs the same") {
    scenes::Mesh flat = strewn.cage;
    std::fill(flat.uvs.begin(), flat.uvs.end(), 0.5f);
    CHECK(compareCorners("flat", flat.view(), ball.view()).reprojected == 0);
  }
  SECTION("far from the origin") {
    const auto move = [](scenes::Point p) { return scenes::Point{p[0] + 512, p[1] - 1024, p[2] + 256}; };
    compareCorners("moved", mapped(strewn.cage, move).view(), mapped(ball, move).view());
  }
}

TEST_CASE("corners get the reference's UVs when vertices are welded within a tolerance", "[seams]") {
  scenes::Scene scene = scenes::head(10);
  scenes::Random random(firstSeed());
  for (float& x : scene.target.positions) x += random.between(-1e-6f, 1e-6f);
  INFO("CAGECAST_SEED=" << firstSeed());
  CHECK(compareCorners(scene.name, scene.cage.view(), scene.target.view(), 1e-4f).reprojected > 10);
}

TEST_CASE("corner UVs do not depend on the order of the target's vertices and triangles, nor on the unit", "[seams]") {
  using Corners = std::array<float, 15>;  // Positions and UVs of a triangle.
  const auto cornersOf = [](const scenes::Mesh& mesh, const Array<float>& uvs) {
    std::vector<Corners> all;
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
      Corners corners{};
      for (std::size_t c = 0; c < 3; ++c) {
        const scenes::Point p = mesh.vertex(mesh.indices[3 * t + c]);
        std::copy(p.begin(), p.end(), corners.begin() + static_cast<std::ptrdiff_t>(5 * c));
        for (std::size_t k = 0; k < 2; ++k) corners[5 * c + 3 + k] = uvs[6 * t + 2 * c + k];
      }
      all.push_back(corners);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    for (const scenes::Scene& scene : {scenes::strewn(seed, 400), scenes::head(14)}) {
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      scenes::Random random(seed);
      std::vector<std::uint32_t> order;
      const scenes::Mesh target = scenes::shuffled(scene.target, random, order);
      const TransferResult before = withCorners(scene.cage.view(), scene.target.view());
      CHECK(cornersOf(target, withCorners(scene.cage.view(), target.view()).projection.cornerUvs) ==
            cornersOf(scene.target, before.projection.cornerUvs));
      const auto scale = [](scenes::Point p) { return scenes::Point{p[0] * 0.125f, p[1] * 0.125f, p[2] * 0.125f}; };
      CHECK(copied(withCorners(mapped(scene.cage, scale).view(), mapped(scene.target, scale).view())
                       .projection.cornerUvs) == copied(before.projection.cornerUvs));
    }
  }
}

TEST_CASE("corners of whole triangles, and of those without an area, have the UVs of their vertices", "[seams]") {
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 2);
  scenes::Mesh target;
  target.addVertex({-0.5f, -0.5f, 1});
  target.addVertex({0.5f, -0.5f, 1});
  target.addVertex({0, 0.5f, 1});
  target.addVertex({0.9f, 0, -1});
  target.addTriangle(0, 1, 2);  // Under one face of the cage.
  target.addTriangle(0, 3, 3);  // Across two of them, if it had an area.
  target.addTriangle(0, 1, 3);  // Across two of them.
  const TransferResult result = withCorners(cage.view(), target.view());
  const auto isAsVertices = [&](std::size_t t) {
    for (std::size_t i = 6 * t; i < 6 * t + 6; ++i)
      if (result.projection.cornerUvs[i] != result.projection.uvs[target.indices[i / 2] * std::size_t{2} + i % 2])
        return false;
    return true;
  };
  CHECK(isAsVertices(0));
  CHECK(isAsVertices(1));
  CHECK_FALSE(isAsVertices(2));
}

TEST_CASE("there are corner UVs only with seams: corner and nearestPoint", "[seams]") {
  const scenes::Scene scene = scenes::head(8);
  TransferOptions options = TransferOptions::paper();
  TransferResult result;
  options.seams = Seams::corner;
  REQUIRE(transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result).ok());
  CHECK(result.projection.cornerUvs.size() == 2 * scene.target.indices.size());
  options.seams = Seams::vertex;
  REQUIRE(transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result)
              .ok());  // The same result, used again.
  CHECK(result.projection.cornerUvs.empty());
  options.seams = Seams::corner;
  options.steps.projection = ProjectionMode::nearestVertex;
  REQUIRE(transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result).ok());
  CHECK(result.projection.cornerUvs.empty());
}

TEST_CASE("splitting vertices gives every corner its UV and moves none", "[seams]") {
  for (std::uint64_t seed = firstSeed(); seed < firstSeed() + 5; ++seed) {
    for (const scenes::Scene& scene : {scenes::strewn(seed, 400), scenes::head(14)}) {
      INFO(scene.name << ", CAGECAST_SEED=" << seed);
      const TransferResult result = withCorners(scene.cage.view(), scene.target.view());
      SplitVertices split;
      const auto vertexCount = static_cast<std::uint32_t>(scene.target.vertexCount());
      REQUIRE(splitVertices(scene.target.indices, result.projection.cornerUvs, vertexCount, split).ok());
      requireSameCorners(scene.target.view(), result.projection.cornerUvs, split);
    }
  }
}

TEST_CASE("splitting leaves one vertex where corners agree, and none where no triangle is", "[seams]") {
  const std::vector<std::uint32_t> indices{4, 2, 1, 1, 2, 3};
  // Vertex 2 has two UVs; those of vertex 1 differ in the sign of a zero.
  const std::vector<float> cornerUvs{0.5f, 0.5f, 0.25f, 0, 0, 1, -0.0f, 1, 0.75f, 0, 1, 1};
  SplitVertices split;
  REQUIRE(splitVertices(indices, cornerUvs, 6, split).ok());
  CHECK(copied(split.sources) == std::vector<std::uint32_t>{4, 2, 1, 2, 3});
  CHECK(copied(split.indices) == std::vector<std::uint32_t>{0, 1, 2, 2, 3, 4});
  CHECK(copied(split.uvs) == std::vector<float>{0.5f, 0.5f, 0.25f, 0, 0, 1, 0.75f, 0, 1, 1});
  // Into what it is split from: every corner by itself.
  const std::vector<float> others{0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5};
  SplitVertices apart;
  REQUIRE(splitVertices(split.indices, others, 5, apart).ok());
  REQUIRE(splitVertices(split.indices, others, 5, split).ok());
  CHECK(copied(split.sources) == copied(apart.sources));
  CHECK(copied(split.indices) == copied(apart.indices));
  REQUIRE(splitVertices({}, {}, 6, split).ok());
  CHECK(split.sources.empty());
  CHECK(split.indices.empty());
  CHECK(split.uvs.empty());
}

TEST_CASE("splitting says what is wrong with its arrays", "[seams]") {
  SplitVertices split;
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 5};
  const std::vector<float> uvs(12);
  const MeshView mesh{{}, indices};
  const Status stray = splitVertices(indices, uvs, 5, split);
  CHECK(stray.code == Code::indexOutOfRange);
  CHECK(stray.at == 5);
  CHECK_THAT(describe(stray, {}, mesh), Catch::Matchers::Contains("target.indices[5] = 5 is out of range"));
  CHECK(describe(stray, {}, {}) == "target.indices[5] is out of range");
  const Status uneven = splitVertices(std::span(indices).first(4), uvs, 6, split);
  CHECK(uneven.code == Code::indicesNotTriples);
  const Status few = splitVertices(indices, std::span(uvs).first(11), 6, split);
  CHECK(few.code == Code::cornerUvCountMismatch);
  CHECK(codeName(few.code) == std::string("cornerUvCountMismatch"));
  CHECK_THAT(describe(few, {}, mesh), Catch::Matchers::Contains("cornerUvs") && Catch::Matchers::Contains("6 indices"));
}

#ifdef CAGECAST_GLTF
TEST_CASE("on real models corners get the reference's UVs, and at most a hundredth is smeared", "[seams][assets]") {
  for (const std::filesystem::path& folder : assetFolders()) {
    const gltf::Model target = readAsset(folder / "target.glb"), cage = readAsset(folder / "cage.glb");
    const std::string name = folder.filename().string();
    const Found found = compareCorners(name, cage.view(), target.view());
    const TransferResult result = withCorners(cage.view(), target.view());
    const Smear smear = smearOf(cage.view(), target.view(), result);
    SplitVertices split;
    const auto vertexCount = static_cast<std::uint32_t>(target.positions.size() / 3);
    REQUIRE(splitVertices(target.indices, result.projection.cornerUvs, vertexCount, split).ok());
    requireSameCorners(target.view(), result.projection.cornerUvs, split);
    std::cout << name << ": " << found.different << " differences at " << found.triangles << " triangles, "
              << found.unstable << " unstable, " << found.reprojected << " reprojected; smeared: " << 100 * smear.vertex
              << " % by vertex, " << 100 * smear.corner << " % by corner; " << vertexCount << " vertices become "
              << split.sources.size() << '\n';
    INFO(name);
    CHECK(found.unstable * 100 <= found.triangles);
    CHECK(smear.corner <= 0.01);
    CHECK(smear.corner <= smear.vertex);
  }
}
#endif

TEST_CASE("UVs of 0 and -0 are one place, where no seam runs", "[seams]") {
  // A square of two triangles with vertices of their own; their UVs at one end of the shared edge are 0 and -0.
  for (const auto& [u, v] : {std::pair{-0.0f, 0.0f}, {0.0f, -0.0f}}) {
    scenes::Mesh cage;
    cage.addVertex({0, 0, 1}, 0, 0), cage.addVertex({4, 0, 1}, 1, 0), cage.addVertex({4, 4, 1}, 1, 1);
    cage.addVertex({0, 0, 1}, u, v), cage.addVertex({4, 4, 1}, 1, 1), cage.addVertex({0, 4, 1}, 0, 1);
    cage.addTriangle(0, 1, 2), cage.addTriangle(3, 4, 5);
    scenes::Mesh target;
    target.addVertex({1, 2, 0}), target.addVertex({2, 1, 0}), target.addVertex({3, 3, 0});
    target.addTriangle(0, 1, 2);
    TransferOptions options;
    options.seams = Seams::corner;
    const TransferResult result = transferred(cage.view(), target.view(), options);
    CHECK(copied(result.projection.cornerUvs) == std::vector<float>{0.25f, 0.5f, 0.5f, 0.25f, 0.75f, 0.75f});
  }
}

TEST_CASE("UVs that are a hair apart are two places, between which a seam runs", "[seams]") {
  // As before, with a corner whose UV differs by less than numbers near 1 can tell.
  const float hair = 1e-9f;
  for (const auto& [u, v] : {std::pair{hair, 0.0f}, {0.0f, hair}}) {
    scenes::Mesh cage;
    cage.addVertex({0, 0, 1}, 0, 0), cage.addVertex({4, 0, 1}, 1, 0), cage.addVertex({4, 4, 1}, 1, 1);
    cage.addVertex({0, 0, 1}, u, v), cage.addVertex({4, 4, 1}, 1, 1), cage.addVertex({0, 4, 1}, 0, 1);
    cage.addTriangle(0, 1, 2), cage.addTriangle(3, 4, 5);
    // Its edges in the texture are long, or shorter than what counts as smeared.
    for (const float size : {1.0f, 0.005f}) {
      scenes::Mesh target;
      target.addVertex({2 - 1.5f * size, 2, 0}), target.addVertex({2, 2 - size, 0});
      target.addVertex({2 + size, 2 + 1.5f * size, 0});
      target.addTriangle(0, 1, 2);
      CHECK(compareCorners("a hair apart", cage.view(), target.view()).reprojected == 1);
    }
  }
}
