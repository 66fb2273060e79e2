// Transfers any scene: the status is ok or names the input, and an answer is consistent, the same every time, and the
// reference's.

#include <cmath>
#include <cstdio>
#include <utility>

#include "fuzz/input.hpp"
#include "reference/reference.hpp"
#include "reference/scene.hpp"

using namespace cagecast;
using fuzz::require;

namespace {

void check(const fuzz::Scene& scene, const TransferResult& result) {
  const Projection& projection = result.projection;
  const std::size_t vertices = scene.target.positions.size() / 3;
  require(projection.visibility.size() == vertices && result.zones.zones.size() == vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    require(std::isfinite(projection.distances[v]) && projection.distances[v] >= 0);
    require(std::isfinite(projection.uvs[2 * v]) && std::isfinite(projection.uvs[2 * v + 1]));
    require(3 * std::size_t{projection.triangles[v]} < scene.cage.indices.size());
    require(projection.segments[v] < projection.segmentStats.size());
  }
  for (const SegmentStats& segment : projection.segmentStats) {
    require(segment.area >= 0 && segment.exposedArea >= 0 && segment.coveredArea >= 0);
    require(segment.coveredArea <= segment.exposedArea);
    require(segment.depth >= 0 && segment.depth <= 1 && segment.score() >= 0);
  }
}

/// What masks say of vertices and triangles is so.
void checkMasked(const fuzz::Scene& scene, const Zones& out) {
  const auto& [vertices, triangles] = scene.options.masks;
  for (std::size_t v = 0; v < vertices.size(); ++v) require(vertices[v] != Mask::never || out.zones[v] == Zone::culled);
  for (std::size_t t = 0; t < scene.target.indices.size() / 3; ++t) {
    const Mask mask = triangles.empty() ? Mask::automatic : triangles[t];
    bool isNever = mask == Mask::never;
    for (std::size_t k = 3 * t; k < 3 * t + 3 && !vertices.empty(); ++k)
      isNever = isNever || vertices[scene.target.indices[k]] == Mask::never;
    if (isNever || mask == Mask::always) require((out.cosmeticTriangles[t] != 0) == !isNever);
  }
}

bool areEqual(const TransferResult& a, const TransferResult& b) {
  const auto same = [](const auto& x, const auto& y) { return std::equal(x.begin(), x.end(), y.begin(), y.end()); };
  return same(a.projection.uvs, b.projection.uvs) && same(a.zones.zones, b.zones.zones) &&
         same(a.projection.triangles, b.projection.triangles) && same(a.projection.cornerUvs, b.projection.cornerUvs);
}

/// The least height of a triangle.
double width(const fuzz::Mesh& mesh, std::size_t triangle) {
  const auto corner = [&](std::size_t k) { return reference::vertex(mesh.view(), mesh.indices[3 * triangle + k % 3]); };
  const auto edge = [&](std::size_t k) { return corner(k + 1) - corner(k); };
  const double longest = std::max({length(edge(0)), length(edge(1)), length(edge(2))});
  return longest > 0 ? length(cross(edge(0), edge(1))) / longest : 0;
}

/// Whether all coordinates are on the grid, or off it by far more than rounding, and no triangle is a needle. Of
/// others, rounding decides what the reference says.
bool isRegular(const fuzz::Mesh& mesh) {
  if (!mesh.poses.empty()) {
    fuzz::Mesh posed = mesh;
    posed.positions = std::exchange(posed.poses, {});
    if (!isRegular(posed)) return false;
  }
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const double found = width(mesh, t);
    if (found > 0 && found < 1e-8) return false;
  }
  return std::all_of(mesh.positions.begin(), mesh.positions.end(), [](float x) {
    const float offset = std::abs(x - std::round(16 * x) / 16);
    return std::abs(x) <= 16 && (offset == 0 || offset > 5e-7f);
  });
}

/// Whether a mesh has a size. Ties are told by shares of the target's, so that rounding decides them where it has none.
bool hasSize(const fuzz::Mesh& mesh) {
  const std::vector<float>& p = mesh.positions;
  for (std::size_t i = 3; i < p.size(); ++i)
    if (p[i] != p[i % 3]) return true;
  return false;
}

void compareWithReference(const fuzz::Scene& scene, Workspace& workspace) {
  const MeshView cage = scene.cage.view(), target = scene.target.view();
  TransferOptions options = scene.options;
  options.masks = {};  // The reference has none.
  // At 0 without a floor the library does not look where nothing is covered.
  options.threshold = std::max(options.threshold, 0.01f);
  TransferResult result;
  require(transfer(cage, target, options, workspace, result).ok());
  const reference::Differences found = compare(reference::transfer(cage, target, options), result, target);
  if (found.total() > 0) std::fprintf(stderr, "not as the reference:\n%s", found.details.c_str());
  require(found.total() == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Scene scene(input);
  Workspace workspace;
  TransferResult result, again;
  const Status status = transfer(scene.cage.view(), scene.target.view(), scene.options, workspace, result);
  if (!status.ok()) {
    require(!describe(status, scene.cage.view(), scene.target.view()).empty());
    return 0;
  }
  check(scene, result);
  checkMasked(scene, result.zones);
  require(transfer(scene.cage.view(), scene.target.view(), scene.options, workspace, again).ok());
  require(areEqual(result, again));
  if (isRegular(scene.cage) && isRegular(scene.target) && hasSize(scene.target)) compareWithReference(scene, workspace);
  return 0;
}
