#include <algorithm>

#include "cuts.hpp"

using namespace cagecast;

namespace {

/// A head under its cage, whose target has random masks.
struct Masked {
  scenes::Scene scene = scenes::head(14);
  std::vector<Mask> vertices = std::vector<Mask>(scene.target.vertexCount(), Mask::automatic);
  std::vector<Mask> triangles = std::vector<Mask>(scene.target.triangleCount(), Mask::automatic);

  explicit Masked(std::uint64_t seed) {
    scenes::Random random(seed);
    for (std::vector<Mask>* masks : {&vertices, &triangles})
      for (Mask& mask : *masks) {
        const std::uint32_t n = random.below(20);
        mask = n == 0 ? Mask::never : n == 1 ? Mask::always : Mask::automatic;
      }
  }
  [[nodiscard]] TransferOptions options() const {
    TransferOptions options;
    options.masks = {vertices, triangles};
    return options;
  }
  [[nodiscard]] TransferResult transfer(const TransferOptions& with) const {
    return transferred(scene.cage.view(), scene.target.view(), with);
  }
  [[nodiscard]] bool hasCorner(std::size_t t, Mask mask) const {
    const auto corners = std::span(scene.target.indices).subspan(3 * t, 3);
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return vertices[v] == mask; });
  }
  [[nodiscard]] bool isMasked(std::size_t t) const {
    return triangles[t] != Mask::automatic || hasCorner(t, Mask::never) || hasCorner(t, Mask::always);
  }
};

/// Whether a triangle is painted by the zones of its corners.
bool isPainted(const std::vector<Zone>& zones, const scenes::Mesh& mesh, std::size_t t) {
  int cosmetic = 0, others = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Zone zone = zones[mesh.indices[3 * t + k]];
    cosmetic += zone == Zone::cosmetic;
    others += zone == Zone::uncovered || zone == Zone::culled;
  }
  return cosmetic > 0 && others == 0;
}

}  // namespace

TEST_CASE("a masked vertex is culled or cosmetic, and decides its triangles by its zone", "[masks]") {
  Masked call(1);
  call.triangles.clear();
  const TransferResult before = call.transfer({}), after = call.transfer(call.options());
  const std::vector<Zone> zones = copied(after.zones.zones);
  for (std::size_t v = 0; v < zones.size(); ++v) {
    const Zone expected = call.vertices[v] == Mask::never    ? Zone::culled
                          : call.vertices[v] == Mask::always ? Zone::cosmetic
                                                             : before.zones.zones[v];
    REQUIRE(zones[v] == expected);
  }
  std::size_t more = 0, fewer = 0;
  for (std::size_t t = 0; t < call.scene.target.triangleCount(); ++t) {
    const bool isNow = after.zones.cosmeticTriangles[t] != 0, was = before.zones.cosmeticTriangles[t] != 0;
    REQUIRE(isNow == isPainted(zones, call.scene.target, t));
    more += isNow && !was;
    fewer += was && !isNow;
  }
  CHECK(more > 0);
  CHECK(fewer > 0);
  CHECK(copied(before.zones.culledBy) == copied(after.zones.culledBy));
}

TEST_CASE("a masked triangle is decided by its mask, never overrides always, and vertices follow", "[masks]") {
  Masked call(2);
  const TransferResult before = call.transfer({}), after = call.transfer(call.options());
  for (std::size_t t = 0; t < call.triangles.size(); ++t) {
    const bool isNever = call.triangles[t] == Mask::never || call.hasCorner(t, Mask::never);
    const bool isNow = after.zones.cosmeticTriangles[t] != 0;
    if (isNever || call.triangles[t] == Mask::always) CHECK(isNow == !isNever);
    if (!call.isMasked(t)) CHECK(isNow == (before.zones.cosmeticTriangles[t] != 0));
    for (std::size_t k = 0; k < 3 && isNow; ++k) {
      const Zone zone = after.zones.zones[call.scene.target.indices[3 * t + k]];
      CHECK((call.triangles[t] == Mask::always ? zone == Zone::cosmetic : zone <= Zone::occluded));
    }
  }
  std::fill(call.triangles.begin(), call.triangles.end(), Mask::never);
  const TransferResult none = call.transfer(call.options());
  for (const std::uint32_t v : call.scene.target.indices) CHECK(none.zones.zones[v] == Zone::culled);
}

TEST_CASE("a piece of a masked triangle is decided as the whole was, any other as without masks", "[masks]") {
  const Masked call(4);
  const MeshView cage = call.scene.cage.view(), target = call.scene.target.view();
  const TransferResult whole = call.transfer(call.options());
  const CutTarget plain = cutOf(cage, target, {}), cut = cutOf(cage, target, call.options(), whole);
  REQUIRE(copied(plain.origins) == copied(cut.origins));
  REQUIRE(cut.origins.size() > call.triangles.size());
  for (std::size_t piece = 0; piece < cut.origins.size(); ++piece) {
    const std::uint32_t t = cut.origins[piece];
    CHECK(cut.cosmeticTriangles[piece] ==
          (call.isMasked(t) ? whole.zones.cosmeticTriangles[t] : plain.cosmeticTriangles[piece]));
  }
  for (std::size_t v = 0; v < call.vertices.size(); ++v)
    if (call.vertices[v] != Mask::automatic) CHECK(cut.zones[v] == whole.zones.zones[v]);
}

TEST_CASE("masks that do not belong to the target are an error that says why", "[masks][errors]") {
  struct Case {
    std::vector<Mask> vertices, triangles;
    Option option;
    std::uint32_t at;
    std::string text;
  };
  const Case cases[] = {{std::vector<Mask>(3),
                         {},
                         Option::vertexMasks,
                         3,
                         "vertices has 3 entries, not 1 for each of 8 vertices of target"},
                        {{},
                         std::vector<Mask>(1),
                         Option::triangleMasks,
                         1,
                         "triangles has 1 entries, not 1 for each of 4 triangles of target"},
                        {std::vector<Mask>(8, static_cast<Mask>(2)),
                         {},
                         Option::vertexMasks,
                         0,
                         "vertices[0] = 2 is not -1 (never), 0 or 1 (always)"},
                        {{},
                         {{}, {}, static_cast<Mask>(-2), {}},
                         Option::triangleMasks,
                         2,
                         "triangles[2] = -2 is not -1 (never), 0 or 1 (always)"}};
  const scenes::Mesh cage = scenes::box({}, {2, 2, 2}, 1);
  scenes::Mesh target = scenes::box({}, {1, 1, 1}, 1);
  target.positions.resize(24), target.uvs.clear(), target.groups.clear(), target.indices.resize(12);
  for (const Case& one : cases) {
    TransferOptions options;
    options.masks = {one.vertices, one.triangles};
    TransferResult result;
    CutTarget cut;
    const TransferResult good = transferred(cage.view(), target.view(), {});
    for (const Status& status :
         {transfer(cage.view(), target.view(), options, testWorkspace(), result),
          classify(good.projection.view(), target.indices, options, result.zones),
          cutBorders(cage.view(), {target.view(), good.zones.zones, good.projection.segments, good.zones.culledBy},
                     options, testWorkspace(), cut)}) {
      CHECK(status.code == Code::badOption);
      CHECK(status.argument == Argument::options);
      CHECK(status.option == one.option);
      CHECK(status.at == one.at);
      CHECK(describe(status, cage.view(), target.view()) == "options.masks." + one.text);
    }
  }
}
