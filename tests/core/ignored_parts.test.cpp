// Parts that are ignored are not there: the rest is as if they had been taken out.

#include <algorithm>
#include <map>
#include <vector>

#include "checks.hpp"
#include "variants.hpp"

using namespace cagecast;

namespace {

/// A mesh without the vertices of a group, and where each of those that are left was.
struct Rest {
  scenes::Mesh mesh;
  std::vector<std::uint32_t> vertices, triangles;
};

Rest restOf(const scenes::Mesh& mesh, std::uint32_t group) {
  Rest out;
  std::map<std::uint32_t, std::uint32_t> places;
  for (std::uint32_t v = 0; v < mesh.groups.size(); ++v) {
    if (mesh.groups[v] == group) continue;
    places[v] = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.push_back(v);
    const float* p = &mesh.positions[3 * v];
    out.mesh.positions.insert(out.mesh.positions.end(), p, p + 3);
    out.mesh.groups.push_back(mesh.groups[v]);
  }
  for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const std::uint32_t* corners = &mesh.indices[3 * t];
    if (!std::all_of(corners, corners + 3, [&](std::uint32_t v) { return places.contains(v); })) continue;
    out.triangles.push_back(t);
    for (int k = 0; k < 3; ++k) out.mesh.indices.push_back(places[corners[k]]);
  }
  return out;
}

template <typename T>
std::vector<T> at(const std::vector<std::uint32_t>& places, const Array<T>& values) {
  std::vector<T> out;
  for (const std::uint32_t place : places) out.push_back(values[place]);
  return out;
}

}  // namespace

TEST_CASE("what is left of a target is transferred to as if it were all of it", "[parts]") {
  scenes::Random random(firstSeed());
  INFO("seed " << firstSeed());
  for (int i = 0; i < 40; ++i) {
    scenes::Scene scene = scenes::patchwork(random.next());
    scenes::Mesh& target = scene.target;
    target.groups.resize(target.positions.size() / 3, 0);
    // A shell around all of it, which hides it, and a part far away, by which it would be small.
    const auto count = static_cast<std::uint32_t>(target.groups.size());
    append(target, scenes::box({}, {9, 9, 9}, 2));
    append(target, scenes::box({500, 0, 0}, {1, 1, 1}, 1));
    std::fill(target.groups.begin() + count, target.groups.end(), 77u);
    const Rest rest = restOf(target, 77);
    TransferOptions options = anyOptions(random);
    const TransferResult expected = transferred(scene.cage.view(), rest.mesh.view(), options);
    const std::uint32_t ignored[] = {77};
    options.parts.ignore = ignored;
    const TransferResult result = transferred(scene.cage.view(), target.view(), options);
    CHECK(at(rest.vertices, result.zones.zones) == copied(expected.zones.zones));
    CHECK(at(rest.vertices, result.projection.distances) == copied(expected.projection.distances));
    CHECK(at(rest.vertices, result.projection.segments) == copied(expected.projection.segments));
    CHECK(at(rest.triangles, result.zones.cosmeticTriangles) == copied(expected.zones.cosmeticTriangles));
    for (std::uint32_t v = count; v < target.groups.size(); ++v) CHECK(result.zones.zones[v] == Zone::culled);
    const std::size_t painted = static_cast<std::size_t>(
        std::count(result.zones.cosmeticTriangles.begin(), result.zones.cosmeticTriangles.end(), 1));
    CHECK(painted == static_cast<std::size_t>(std::count(expected.zones.cosmeticTriangles.begin(),
                                                         expected.zones.cosmeticTriangles.end(), 1)));
    const SegmentStats& last = result.projection.segmentStats[result.projection.segmentStats.size() - 1];
    CHECK(last.culledBy == CulledBy::ignore);
    CHECK(last.points == 0);
    CHECK(last.area == 0);
  }
}
