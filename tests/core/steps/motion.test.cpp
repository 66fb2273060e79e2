// Step 13: what comes into view when a face moves.

#include <algorithm>
#include <cmath>

#include "cagecast/clip.hpp"
#include "checks.hpp"

using namespace cagecast;
using scenes::append;
using scenes::Mesh;
using scenes::Point;

namespace {

/// A profile, from top to bottom: y and z.
using Profile = std::vector<std::array<float, 2>>;

/// A face of one profile, in columns from x = −1 to 1.
Mesh face(const Profile& profile) {
  constexpr std::uint32_t kColumns = 11;
  Mesh mesh;
  for (const auto& [y, z] : profile)
    for (std::uint32_t c = 0; c < kColumns; ++c)
      mesh.addVertex({-1 + 2 * static_cast<float>(c) / (kColumns - 1), y, z});
  for (std::uint32_t v = 0; v + kColumns < mesh.vertexCount(); ++v) {
    if (v % kColumns + 1 == kColumns) continue;
    mesh.addTriangle(v, v + kColumns, v + 1);
    mesh.addTriangle(v + 1, v + kColumns, v + kColumns + 1);
  }
  return mesh;
}

/// A level cage before the face, with a hole.
/// @param hole  Half its width and half its height.
Mesh cageWithHole(std::array<float, 2> hole) {
  return scenes::without(scenes::sheet({-1.2f, -1.2f, 0.15f}, {2.4f, 0, 0}, {0, 2.4f, 0}, 48),
                         [=](Point p) { return std::abs(p[0]) < hole[0] && std::abs(p[1]) < hole[1]; });
}

template <typename Map>
void addPose(Mesh& mesh, Map map) {
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = map(mesh.vertex(v));
    mesh.poses.insert(mesh.poses.end(), p.begin(), p.end());
  }
}

bool isLid(Point p) { return p[2] == -0.02f; }

/// A forehead whose lid is folded behind it, a cheek, an eye between them, and, in front of the closed lid, glasses.
struct Eye {
  Mesh cage = cageWithHole({0.5f, 0.2f});
  Mesh target = face({{1, 0}, {0.7f, 0}, {0.4f, 0}, {0.2f, 0}, {0.25f, -0.02f}, {0.35f, -0.02f}, {0.45f, -0.02f}});
  std::size_t skin = target.vertexCount();

  explicit Eye(bool hasGlasses = false) {
    append(target, face({{-0.2f, 0}, {-0.6f, 0}, {-1, 0}}));
    append(target, scenes::ellipsoid({0, 0, -0.35f}, {0.4f, 0.3f, 0.3f}, 8));
    if (hasGlasses) append(target, scenes::sheet({-1, -0.18f, 0.08f}, {2, 0, 0}, {0, 0.36f, 0}, 2));
    addPose(target, [](Point p) { return isLid(p) ? Point{p[0], 0.55f - 1.6f * p[1], 0.02f} : p; });
  }
};

constexpr float kDeep = -0.3f;  // Of a mouth.

/// Lips that touch, whose inner sides lead into a mouth with teeth; a pose opens it.
struct Mouth {
  Mesh cage;
  Mesh target = face({{1, 0},
                      {0.5f, 0},
                      {0.1f, 0},
                      {0.001f, 0},
                      {0.001f, -0.02f},
                      {0.001f, -0.04f},
                      {0.001f, kDeep},
                      {-0.001f, kDeep},
                      {-0.001f, -0.04f},
                      {-0.001f, -0.02f},
                      {-0.001f, 0},
                      {-0.1f, 0},
                      {-0.5f, 0},
                      {-1, 0}});
  std::size_t skin = target.vertexCount();

  explicit Mouth(std::array<float, 2> hole) : cage(cageWithHole(hole)) {
    append(target, scenes::ellipsoid({0, 0.013f, -0.15f}, {0.4f, 0.1f, 0.05f}, 8));
    const std::size_t ofSkin = skin;
    std::size_t v = 0;
    addPose(target, [&](Point p) { return v++ < ofSkin && p[1] < 0 ? Point{p[0], p[1] - 0.3f, p[2]} : p; });
  }
};

TransferOptions still() {
  TransferOptions options;
  options.motion = false;
  return options;
}

template <typename Scene>
TransferResult sameAsReference(const Scene& scene, const TransferOptions& options = {}) {
  requireSameAsReference("a face that moves", scene.cage.view(), scene.target.view(), options);
  return transferred(scene.cage.view(), scene.target.view(), options);
}

}  // namespace

TEST_CASE("a lid that is folded away at rest is painted, and its eye is not", "[motion]") {
  const Eye eye;
  const TransferResult before = sameAsReference(eye, still()), after = sameAsReference(eye);
  for (std::size_t v = 0; v < eye.target.vertexCount(); ++v) {
    const Point p = eye.target.vertex(v);
    INFO("vertex " << v << " at " << p[0] << ", " << p[1] << ", " << p[2]);
    const bool isOfLid = v < eye.skin && isLid(p);
    CHECK(before.zones.zones[v] == (isOfLid ? Zone::occluded : after.zones.zones[v]));
    if (isOfLid) CHECK(after.zones.zones[v] == Zone::cosmetic);
  }
  // Nothing but recovery is another; UVs are those at rest.
  CHECK(copied(after.projection.uvs) == copied(before.projection.uvs));
  CHECK(copied(after.projection.visibility) == copied(before.projection.visibility));
  for (std::size_t s = 0; s < before.projection.segmentStats.size(); ++s)
    CHECK(after.projection.segmentStats[s].culledBy == before.projection.segmentStats[s].culledBy);
  CHECK(after.projection.segmentStats[2].culled());
}

TEST_CASE("the inner sides of lips are painted, what is deep in a mouth and teeth are not", "[motion]") {
  const Mouth mouth({0, 0});
  const TransferResult before = sameAsReference(mouth, still()), after = sameAsReference(mouth);
  for (std::size_t v = 0; v < mouth.target.vertexCount(); ++v) {
    const Point p = mouth.target.vertex(v);
    INFO("vertex " << v << " at " << p[0] << ", " << p[1] << ", " << p[2]);
    if (v >= mouth.skin || p[2] == kDeep) CHECK(after.zones.zones[v] != Zone::cosmetic);
    // At the sides, rays come in from beside the mouth even at rest.
    if (v >= mouth.skin || p[1] > 0 || p[2] == 0 || p[2] == kDeep || std::abs(p[0]) > 0.7f) continue;
    CHECK(before.zones.zones[v] == Zone::occluded);
    CHECK(after.zones.zones[v] == Zone::cosmetic);
  }
}

TEST_CASE("teeth that show in a pose explain the hole over the lips", "[motion]") {
  const Mouth mouth({0.5f, 0.08f});
  const TransferResult before = sameAsReference(mouth, still()), after = sameAsReference(mouth);
  std::size_t gained = 0;
  for (std::size_t v = 0; v < mouth.skin; ++v) {
    const Point p = mouth.target.vertex(v);
    if (p[2] != 0) continue;
    gained += before.zones.zones[v] == Zone::uncovered;
    CHECK(after.zones.zones[v] == Zone::cosmetic);
  }
  CHECK(gained > 0);
  CHECK(copied(before.zones.explainedHoles) == std::vector<std::uint8_t>{0, 0});
  CHECK(std::count(after.zones.explainedHoles.begin(), after.zones.explainedHoles.end(), 1) == 1);
}

TEST_CASE("what hides a point in a pose hides nothing if it is culled, decided anew without projecting", "[motion]") {
  const Eye eye(true);
  const TransferResult result = sameAsReference(eye);
  const std::uint32_t skin = 0, glasses = 3;
  for (const Lock lock : {Lock::exclude, Lock::keep}) {
    for (const Lock ofSkin : {Lock::automatic, Lock::exclude}) {
      const LockEntry locks[] = {{glasses, lock}, {skin, ofSkin}};
      TransferOptions options;
      options.locks = locks;
      Zones zones;
      REQUIRE(classify(result.projection.view(), eye.target.indices, options, zones).ok());
      for (std::size_t v = 0; v < eye.skin; ++v) {
        // Beside the eye the glasses do not reach over what the lid shows.
        if (!isLid(eye.target.vertex(v)) || eye.target.vertex(v)[1] == 0.45f) continue;
        const bool isPainted = lock == Lock::exclude && ofSkin == Lock::automatic;
        CHECK(zones.zones[v] == (isPainted ? Zone::cosmetic : Zone::occluded));
      }
    }
  }
}

TEST_CASE("poses that move nothing, or nothing nearby, change no bit", "[motion]") {
  for (const bool isFar : {false, true}) {
    Eye eye;
    eye.target.poses.clear();
    if (isFar) append(eye.target, scenes::box({0, -0.9f, 0.05f}, {0.05f, 0.05f, 0.01f}, 1));
    const std::size_t first = isFar ? eye.target.vertexCount() - 24 : 0;
    const auto before = transferred(eye.cage.view(), eye.target.view(), {});
    std::size_t v = 0;
    addPose(eye.target, [&](Point p) { return isFar && v++ >= first ? Point{p[0], p[1], p[2] + 0.02f} : p; });
    const auto after = transferred(eye.cage.view(), eye.target.view(), {});
    CHECK(copied(after.zones.zones) == copied(before.zones.zones));
    CHECK(copied(after.projection.recovery) == copied(before.projection.recovery));
    CHECK(copied(after.projection.hiders) == copied(before.projection.hiders));
  }
}

TEST_CASE("vertices that lie together at rest part in a pose", "[motion]") {
  Mouth mouth({0, 0});
  // The lips touch: their edges are welded, and no pose opens a gap unless these part.
  for (std::size_t i = 1; i < mouth.target.positions.size(); i += 3) {
    float& y = mouth.target.positions[i];
    if (std::abs(y) == 0.001f && mouth.target.positions[i + 1] > kDeep) y = 0;
  }
  const TransferResult after = sameAsReference(mouth);
  for (std::size_t v = 0; v < mouth.skin; ++v) {
    const Point p = mouth.target.vertex(v);
    if (p[1] == 0 && p[2] < 0 && std::abs(p[0]) < 0.7f) CHECK(after.zones.zones[v] == Zone::cosmetic);
  }
}

TEST_CASE("pieces of a target that is cut are painted by its poses, too", "[motion]") {
  const Eye eye;
  const TransferResult result = transferred(eye.cage.view(), eye.target.view(), {});
  CutTarget cut;
  const DecidedTarget decided{eye.target.view(), result.zones.zones, result.projection.segments, result.zones.culledBy};
  REQUIRE(cutBorders(eye.cage.view(), decided, {}, testWorkspace(), cut).ok());
  for (std::size_t v = 0; v < eye.skin; ++v) {
    // Over the hole, borders are cut at its edge.
    const Point p = eye.target.vertex(v);
    if (isLid(p) && p[1] > 0.25f) CHECK(cut.zones[v] == result.zones.zones[v]);
  }
}

TEST_CASE("poses that cannot be used are errors", "[motion][errors]") {
  const struct {
    void (*change)(std::vector<float>&);
    Code code;
    std::uint32_t at;
    const char* text;
  } cases[] = {
      {[](auto& poses) { poses.pop_back(); }, Code::poseCountMismatch, 407, "target.poses has"},
      {[](auto& poses) { poses[7] = kNaN; }, Code::badPose, 7, "target.poses[7] is not a finite number"},
      {[](auto& poses) { poses[4] = 1e30f; }, Code::badPose, 4, "target.poses[4]"},
      {[](auto& poses) { poses[4] = -1e7f; }, Code::ok, 0, ""},
      {[](auto& poses) { poses.clear(); }, Code::ok, 0, ""},
  };
  for (const auto& [change, code, at, text] : cases) {
    Eye eye;
    change(eye.target.poses);
    TransferResult result;
    const Status status = transfer(eye.cage.view(), eye.target.view(), {}, testWorkspace(), result);
    INFO(describe(status, eye.cage.view(), eye.target.view()));
    CHECK(status.code == code);
    if (code == Code::badPose) CHECK(status.at == at);
    CHECK_THAT(describe(status, eye.cage.view(), eye.target.view()), Catch::Matchers::Contains(text));
  }
}
