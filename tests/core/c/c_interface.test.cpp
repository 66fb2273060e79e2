// C gets the same as C++, to the bit; out of memory, an error.

#include <cstring>

#include "c/c_mesh.hpp"
#include "cagecast/clip.hpp"
#include "cagecast/split.hpp"
#include "checks.hpp"

using namespace cagecast;

namespace {

template <typename C, typename T>
bool equal(const C* given, const Array<T>& expected) {
  static_assert(sizeof(C) == sizeof(T));
  return expected.empty() ? given == nullptr : std::memcmp(given, expected.data(), expected.size() * sizeof(T)) == 0;
}

}  // namespace

TEST_CASE("C gets what C++ gets", "[c]") {
  const int paper = GENERATE(0, 1);
  const scenes::Scene scene = scenes::head(6);
  TransferOptions options = paper != 0 ? TransferOptions::paper() : TransferOptions();
  options.threshold = 0.625f;
  std::vector<Mask> masks(scene.target.vertexCount(), Mask::automatic);
  masks[7] = Mask::never;
  options.masks.vertices = masks;
  const std::vector<std::uint32_t> ignored{1};
  options.parts.ignore = ignored;
  TransferResult result;
  REQUIRE(transfer(scene.cage.view(), scene.target.view(), options, testWorkspace(), result).ok());
  CutTarget cut;
  const DecidedTarget decided{scene.target.view(), result.zones.zones, result.projection.segments,
                              result.zones.culledBy};
  REQUIRE(cutBorders(scene.cage.view(), decided, options, testWorkspace(), cut).ok());

  const CagecastMesh cage = cMesh(scene.cage), target = cMesh(scene.target);
  CagecastOptions given;
  cagecastDefaults(&given, paper);
  given.threshold = 0.625f;
  given.vertexMasks = reinterpret_cast<const std::int8_t*>(masks.data());
  given.ignore = {ignored.data(), 1};
  CagecastTransfer out{};
  REQUIRE(cagecastTransfer(&cage, &target, &given, &out) == 0);
  CHECK(equal(out.uvs, result.projection.uvs));
  CHECK(equal(out.cornerUvs, result.projection.cornerUvs));
  CHECK(equal(out.zones, result.zones.zones));
  CHECK(equal(out.cosmeticTriangles, result.zones.cosmeticTriangles));
  CHECK(equal(out.cageTriangles, result.projection.triangles));
  CHECK(equal(out.distances, result.projection.distances));
  CHECK(equal(out.segments, result.projection.segments));
  REQUIRE(out.segmentCount == result.projection.segmentStats.size());
  for (std::uint32_t s = 0; s < out.segmentCount; ++s) {
    CHECK(out.segmentStats[s].score == result.projection.segmentStats[s].score());
    CHECK(out.segmentStats[s].group == result.projection.segmentStats[s].group);
    CHECK(out.segmentStats[s].culledBy == static_cast<int>(result.projection.segmentStats[s].culledBy));
  }

  CagecastCut pieces{};
  REQUIRE(cagecastCut(&cage, &target, &given, &out, &pieces) == 0);
  CHECK(equal(pieces.sources, cut.sources));
  CHECK(equal(pieces.weights, cut.weights));
  CHECK(equal(pieces.indices, cut.indices));
  CHECK(equal(pieces.origins, cut.origins));
  CHECK(equal(pieces.uvs, cut.uvs));
  CHECK(equal(pieces.cornerUvs, cut.cornerUvs));
  CHECK(equal(pieces.zones, cut.zones));
  CHECK(equal(pieces.cosmeticTriangles, cut.cosmeticTriangles));
  CHECK(pieces.vertexCount == cut.zones.size());
  CHECK(3 * pieces.newVertexCount == cut.sources.size());

  given.seams = 7;
  CHECK(cagecastTransfer(&cage, &target, &given, &out) == 1);
  CHECK(std::string(out.error.code) == "badOption");
  CHECK(std::string(out.error.option) == "seams");
  given.seams = 1;
  CHECK(cagecastTransfer(nullptr, &target, &given, &out) == 1);
  CHECK(std::string(out.error.message).find("cage has no") == 0);
  CHECK(cagecastCut(&cage, &target, &given, nullptr, &pieces) == 1);
  CHECK(std::string(pieces.error.code) == "resultMismatch");
  cagecastFreeTransfer(&out);
  cagecastFreeCut(&pieces);
  CHECK(out.memory == nullptr);
}
