// Step 12: UVs per corner, and meshes made of them.

#include <algorithm>
#include <map>
#include <tuple>

#include "cagecast/split.hpp"
#include "cuts.hpp"

using namespace cagecast;
using scenes::Mesh;
using scenes::Point;
using scenes::Scene;

namespace {

TransferOptions withCorners() {
  TransferOptions options = TransferOptions::paper();
  options.seams = Seams::corner;
  return options;
}

Array<float> cornersOf(const Mesh& cage, const Mesh& target) {
  return std::move(transferred(cage.view(), target.view(), withCorners()).projection.cornerUvs);
}

/// How many triangles have corners with other UVs than their vertices.
std::size_t tornOf(const MeshView& target, const Projection& projection) {
  std::size_t torn = 0;
  for (std::size_t t = 0; t < target.indices.size() / 3; ++t) {
    const auto isOther = [&](std::size_t i) {
      return projection.cornerUvs[i] != projection.uvs[std::size_t{2} * target.indices[i / 2] + i % 2];
    };
    std::size_t others = 0;
    for (std::size_t i = 6 * t; i < 6 * t + 6; ++i) others += isOther(i);
    torn += others > 0;
  }
  return torn;
}

/// Requires the reference's UVs at all firm corners, some of them torn.
void requireSameCorners(const Scene& scene, std::size_t minTorn = 1) {
  const MeshView cage = scene.cage.view(), target = scene.target.view();
  requireSameAsReference(scene.name, cage, target, withCorners());
  INFO(scene.name);
  CHECK(tornOf(target, transferred(cage, target, withCorners()).projection) >= minTorn);
}

/// A tube around the y axis whose texture is one chart, cut open along one line; u goes around.
Mesh tube(float radius, int around, int along) {
  // A square blown up to a circle, so that no sine is needed.
  const auto onCircle = [&](int i) {
    const int quarter = around / 4;
    const float share = 2 * static_cast<float>(i % quarter) / static_cast<float>(quarter) - 1;
    const Point sides[4] = {{1, 0, share}, {-share, 0, 1}, {-1, 0, -share}, {share, 0, -1}};
    const Point p = sides[i / quarter % 4];
    const float size = radius / std::sqrt(p[0] * p[0] + p[2] * p[2]);
    return Point{p[0] * size, 0, p[2] * size};
  };
  Mesh mesh;
  const auto row = static_cast<std::uint32_t>(around + 1);
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i <= around; ++i) {
      Point p = onCircle(i);
      const float v = static_cast<float>(j) / static_cast<float>(along);
      p[1] = 4 * v - 2;
      mesh.addVertex(p, static_cast<float>(i) / static_cast<float>(around), v);
    }
  for (std::uint32_t a = 0; a + row + 1 < mesh.vertexCount(); ++a) {
    if (a % row + 1 == row) continue;
    mesh.addTriangle(a, a + row + 1, a + 1);
    mesh.addTriangle(a, a + row, a + row + 1);
  }
  return mesh;
}

/// The same triangles with vertices of their own, whose UVs a function of vertex and corner makes.
template <typename MakeUv>
Mesh apart(const Mesh& mesh, MakeUv makeUv) {
  Mesh out;
  for (const std::uint32_t v : mesh.indices) {
    const std::array<float, 2> uv = makeUv(v, out.vertexCount());
    out.addVertex(mesh.vertex(v), uv[0], uv[1]);
  }
  for (std::uint32_t i = 0; i < out.vertexCount(); i += 3) out.addTriangle(i, i + 1, i + 2);
  return out;
}

Mesh stacked(const Mesh& mesh, int copies) {
  Mesh out = mesh;
  for (int copy = 1; copy < copies; ++copy)
    out.indices.insert(out.indices.end(), mesh.indices.begin(), mesh.indices.end());
  return out;
}

/// Of two to four copies of each triangle two have UVs that meet, the others their own. Which is first, and so the
/// nearest, changes.
Mesh mixed() {
  const Mesh shell = scenes::ellipsoid({}, {1.1f, 1.1f, 1.1f}, 5);
  Mesh out;
  const auto add = [&](std::size_t triangle, float shift) {
    const auto first = static_cast<std::uint32_t>(out.vertexCount());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = shell.indices[3 * triangle + k];
      out.addVertex(shell.vertex(v), shell.uvs[std::size_t{2} * v] + shift, shell.uvs[std::size_t{2} * v + 1]);
    }
    out.addTriangle(first, first + 1, first + 2);
  };
  for (std::size_t t = 0; t < shell.triangleCount(); ++t) {
    const bool isFirst = t / 7 % 2 == 0;
    add(t, isFirst ? 0.0f : 3.0f);
    add(t, isFirst ? 3.0f : 0.0f);
    if (t % 3 == 0) add(t, 0);
    if (t % 5 == 0) add(t, 5.0f + static_cast<float>(t));
  }
  return out;
}

}  // namespace

TEST_CASE("corners get the reference's UVs in any cage", "[seams]") {
  const Mesh ball = scenes::ellipsoid({0.02f, -0.03f, 0.01f}, {1, 1, 0.9f}, 9);
  const Mesh tall = scenes::ellipsoid({}, {1, 1.5f, 1}, 14);
  const Scene strewn = scenes::strewn(firstSeed(), 200);
  INFO("CAGECAST_SEED=" << firstSeed());
  const auto uvOf = [&](std::uint32_t v) {
    return std::array{strewn.cage.uvs[std::size_t{2} * v], strewn.cage.uvs[std::size_t{2} * v + 1]};
  };
  const Mesh eachItsOwn = apart(strewn.cage, [](std::uint32_t, std::size_t i) {
    return std::array{static_cast<float>(i) / 1000, static_cast<float>(i) / 500};
  });
  requireSameCorners({"a chart that meets itself, coarse", tube(1.2f, 8, 4), tall}, 10);
  requireSameCorners({"a chart that meets itself, fine", tube(1.2f, 60, 30), tall}, 10);
  requireSameCorners(
      {"denser than the target", scenes::ellipsoid({}, {1.1f, 1.1f, 1.1f}, 30), scenes::ellipsoid({}, {1, 1, 1}, 3)});
  requireSameCorners({"coarser than the target", scenes::box({}, {1.5f, 1.4f, 1.6f}, 1), ball});
  requireSameCorners({"each triangle a chart", eachItsOwn, ball}, 50);
  requireSameCorners({"each triangle a chart, strewn", eachItsOwn, strewn.target}, 50);
  requireSameCorners({"its triangles stacked on each other", stacked(strewn.cage, 4), ball});
  requireSameCorners({"edges of many triangles, of which some are one in the texture", mixed(), ball}, 50);
  for (const float offset : {-3.0f, 40000.0f, 1e7f}) {
    Mesh far = strewn.cage;
    for (float& x : far.uvs) x = 4 * x + offset;
    requireSameCorners({"UVs far from 0 to 1", far, ball}, 0);
  }
  Mesh flat = strewn.cage;
  std::fill(flat.uvs.begin(), flat.uvs.end(), 0.5f);
  CHECK(tornOf(ball.view(), transferred(flat.view(), ball.view(), withCorners()).projection) == 0);
  // Vertices split, or equal up to the sign of zero, hold together all the same.
  Mesh split = apart(strewn.cage, [&](std::uint32_t v, std::size_t) { return uvOf(v); });
  for (std::size_t i = 0; i < split.positions.size(); ++i)
    if (split.positions[i] == 0 && i / 3 % 2 == 0) split.positions[i] = -0.0f;
  CHECK(copied(cornersOf(split, ball)) == copied(cornersOf(strewn.cage, ball)));
  // More equally near triangles than can be listed at once.
  const Mesh once = tube(1.5f, 4, 2), fine = scenes::ellipsoid({0.02f, -0.03f, 0.01f}, {1, 1.5f, 0.9f}, 30);
  CHECK(copied(cornersOf(stacked(once, 200), fine)) == copied(cornersOf(once, fine)));
}

TEST_CASE("corners get the reference's UVs where places tie, as on cuts", "[seams]") {
  for (const Scene& scene : scenes::goldenBorders()) {
    Mesh pieces = meshOf(scene.target.view(), cutOf(scene.cage.view(), scene.target.view(), {}));
    pieces.uvs.clear();  // The target's own are none of ours.
    requireSameCorners({scene.name + ", cut", scene.cage, pieces}, 10);
  }
}

TEST_CASE("a target is cut where a chart meets itself along its cut, either way up", "[seams][borders]") {
  const Mesh ball = scenes::rotated(scenes::ellipsoid({}, {1, 1, 1}, 14), {3, 1, -2, 1});
  for (const bool isTurned : {false, true}) {
    Mesh cage = tube(1.2f, 24, 12);
    for (std::size_t i = 0; i < cage.uvs.size() && isTurned; i += 2) std::swap(cage.uvs[i], cage.uvs[i + 1]);
    const Mesh pieces = meshOf(ball.view(), cutOf(cage.view(), ball.view(), {}));
    // The tube is open along x = -z, where x is positive.
    std::size_t near = 0, across = 0;
    for (std::size_t t = 0; t < pieces.triangleCount(); ++t) {
      float low = 1, high = -1;
      bool isNear = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point p = pieces.vertex(pieces.indices[3 * t + k]);
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
}

TEST_CASE("corner UVs do not depend on the order of the target's vertices and triangles", "[seams]") {
  using Corners = std::array<float, 15>;  // Positions and UVs of a triangle.
  const auto sorted = [](const Mesh& mesh, const Array<float>& uvs) {
    std::vector<Corners> all;
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
      Corners corners{};
      for (std::size_t c = 0; c < 3; ++c) {
        const Point p = mesh.vertex(mesh.indices[3 * t + c]);
        std::copy(p.begin(), p.end(), corners.begin() + static_cast<std::ptrdiff_t>(5 * c));
        for (std::size_t k = 0; k < 2; ++k) corners[5 * c + 3 + k] = uvs[6 * t + 2 * c + k];
      }
      all.push_back(corners);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  for (const Scene& scene : {scenes::strewn(firstSeed(), 400), scenes::head(14)}) {
    INFO(scene.name << ", CAGECAST_SEED=" << firstSeed());
    scenes::Random random(firstSeed());
    std::vector<std::uint32_t> order;
    const Mesh target = scenes::shuffled(scene.target, random, order);
    CHECK(sorted(target, cornersOf(scene.cage, target)) == sorted(scene.target, cornersOf(scene.cage, scene.target)));
  }
}

TEST_CASE("corners of whole triangles, and of those without an area, have the UVs of their vertices", "[seams]") {
  const Mesh cage = scenes::box({}, {2, 2, 2}, 2);
  Mesh target;
  for (const Point p : {Point{-0.5f, -0.5f, 1}, {0.5f, -0.5f, 1}, {0, 0.5f, 1}, {0.9f, 0, -1}}) target.addVertex(p);
  const auto tornWith = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    target.indices = {a, b, c, 0, 1, 2};  // The other under one face of the cage.
    return tornOf(target.view(), transferred(cage.view(), target.view(), withCorners()).projection);
  };
  CHECK(tornWith(0, 3, 3) == 0);
  CHECK(tornWith(0, 1, 3) == 1);  // Across two faces.
}

TEST_CASE("there are corner UVs only with seams: corner and nearestPoint", "[seams]") {
  const Scene scene = scenes::head(8);
  TransferResult result;  // Used again.
  for (const Seams seams : {Seams::corner, Seams::vertex}) {
    for (const ProjectionMode mode : {ProjectionMode::nearestPoint, ProjectionMode::nearestVertex}) {
      TransferOptions options;
      options.seams = seams;
      options.steps.projection = mode;
      REQUIRE(transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result).ok());
      const bool hasCorners = seams == Seams::corner && mode == ProjectionMode::nearestPoint;
      CHECK(result.projection.cornerUvs.size() == (hasCorners ? 2 * scene.target.indices.size() : 0));
    }
  }
}

TEST_CASE("UVs of 0 and -0 are one place; those a hair apart are two, between which a seam runs", "[seams]") {
  // A square of two triangles with vertices of their own; their UVs at one end of the shared edge are almost equal.
  const float hair = 1e-9f;  // Less than numbers near 1 can tell.
  for (const auto& [u, v, hasSeam] :
       {std::tuple{-0.0f, 0.0f, false}, {0.0f, -0.0f, false}, {hair, 0.0f, true}, {0.0f, hair, true}}) {
    Mesh cage;
    cage.addVertex({0, 0, 1}, 0, 0), cage.addVertex({4, 0, 1}, 1, 0), cage.addVertex({4, 4, 1}, 1, 1);
    cage.addVertex({0, 0, 1}, u, v), cage.addVertex({4, 4, 1}, 1, 1), cage.addVertex({0, 4, 1}, 0, 1);
    cage.addTriangle(0, 1, 2), cage.addTriangle(3, 4, 5);
    // Its edges in the texture are long, or shorter than what counts as smeared.
    for (const float size : {1.0f, 0.005f}) {
      Mesh target;
      target.addVertex({2 - 1.5f * size, 2, 0}), target.addVertex({2, 2 - size, 0});
      target.addVertex({2 + size, 2 + 1.5f * size, 0});
      target.addTriangle(0, 1, 2);
      requireSameAsReference("a hair apart", cage.view(), target.view(), withCorners());
      const Projection projection = transferred(cage.view(), target.view(), withCorners()).projection;
      CHECK(tornOf(target.view(), projection) == (hasSeam ? 1 : 0));
    }
  }
}

TEST_CASE("splitting vertices gives every corner its UV and moves none", "[seams]") {
  for (const Scene& scene : {scenes::strewn(firstSeed(), 400), scenes::head(14)}) {
    INFO(scene.name << ", CAGECAST_SEED=" << firstSeed());
    const Array<float> uvs = cornersOf(scene.cage, scene.target);
    const std::vector<std::uint32_t>& indices = scene.target.indices;
    SplitVertices split;
    REQUIRE(splitVertices(indices, uvs, static_cast<std::uint32_t>(scene.target.vertexCount()), split).ok());
    REQUIRE(split.indices.size() == indices.size());
    REQUIRE(split.uvs.size() == 2 * split.sources.size());
    std::size_t elsewhere = 0, otherUvs = 0, notInOrder = 0;
    std::uint32_t met = 0;
    std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> known;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::uint32_t v = split.indices[i];
      REQUIRE(v < split.sources.size());
      notInOrder += v > met;
      met = std::max(met, v + 1);
      elsewhere += split.sources[v] != indices[i];
      for (std::size_t k = 0; k < 2; ++k) otherUvs += split.uvs[std::size_t{2} * v + k] != uvs[2 * i + k];
      known.try_emplace({indices[i], uvs[2 * i], uvs[2 * i + 1]}, v);
    }
    CHECK(elsewhere + otherUvs + notInOrder == 0);
    CHECK(met == split.sources.size());           // Every new vertex is used,
    CHECK(known.size() == split.sources.size());  // and no two are the same.
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
  REQUIRE(splitVertices(split.indices, others, 5, split).ok());
  CHECK(copied(split.sources) == std::vector<std::uint32_t>{0, 1, 2, 2, 3, 4});
  CHECK(copied(split.indices) == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  REQUIRE(splitVertices({}, {}, 6, split).ok());
  CHECK(split.sources.empty());
  CHECK(split.indices.empty());
  CHECK(split.uvs.empty());
}
