// Steps of making and fitting cages, each by itself, on any mesh that it may get. What makes whole calls slow, fine
// grids and masks, is coarse here.

#include <algorithm>
#include <cmath>
#include <map>

#include "charts/steps.hpp"
#include "fit/steps.hpp"
#include "fit/warp.hpp"
#include "fuzz/figure.hpp"
#include "hull/hull.hpp"
#include "make/steps.hpp"
#include "mesh/check_model.hpp"

using namespace cagecast;
using namespace cagecast::cages;
using fuzz::require;

namespace {

void check(const TriangleMesh& mesh) {
  for (const Vec3& p : mesh.positions) require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) require(v < mesh.positions.size());
}

/// A closed manifold: each edge is used once in each direction.
void checkClosed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const Triangle3& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++uses[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : uses) require(count == 1 && uses.count({edge.second, edge.first}) == 1);
}

/// The hull of a mesh, with holes anywhere, simplified.
void wrapAndCut(fuzz::Input& input, const TriangleMesh& mesh, fuzz::Patience& patience) {
  const double diagonal = diagonalOf(mesh);
  HullOptions options;
  options.closing = 0.1 * static_cast<double>(input.share()) * diagonal;
  options.offset = (0.0005 + 0.1 * static_cast<double>(input.share())) * diagonal;
  options.voxels = 8 + input.below(12);
  if (input.flag()) options.near = mesh.positions[input.below(40) % mesh.positions.size()];
  TriangleMesh hull;
  const bool isWrapped = makeHull(mesh, options, patience.progress(), hull);
  require(isWrapped != patience.gone());
  if (!isWrapped) return;
  check(hull);
  checkClosed(hull);
  std::vector<double> field;
  for (std::size_t i = 0; i < hull.positions.size(); ++i) field.push_back(input.flag() ? input.share() : 0);
  const TriangleMesh shell = cutHoles(hull, field);
  check(shell);
  TriangleMesh simple;
  const SimplifyOptions few{4 + input.below(100), options.offset};
  if (shell.empty() || !simplify(shell, few, patience.progress(), simple)) return;
  check(simple);
  if (simple.empty()) return;
  const OuterPoints points{mesh.positions, vertexNormals(mesh)};
  if (enclose(points, 4 * options.offset, patience.progress(), simple)) check(simple);
}

void layOut(fuzz::Input& input, const TriangleMesh& mesh, fuzz::Patience& patience) {
  UnwrapOptions options;
  options.kind = static_cast<Kind>(input.below(4));
  if (input.flag()) std::swap(options.up, options.front);
  options.gutter = 1.0 / (8 + input.below(56));
  Layout layout;
  const bool isDone = unwrap(mesh, options, patience.progress(), layout);
  require(isDone != patience.gone());
  if (!isDone) return;
  check(layout.mesh);
  require(layout.mesh.triangles.size() == mesh.triangles.size());
  require(layout.uvs.size() == layout.mesh.positions.size());
  for (const Uv& uv : layout.uvs)
    for (const double x : uv) require(x >= 0 && x <= 1);
}

/// @param mesh  What the cage is drawn onto.
void fit(fuzz::Input& input, const TriangleMesh& mesh, fuzz::Patience& patience) {
  const fuzz::Mesh other = input.flag() ? fuzz::Mesh::ball(input, true) : fuzz::Mesh(input, true);
  if (!checkMesh(other.view(), Argument::from).ok()) return;
  const auto place = [&] {
    const auto x = [&] { return static_cast<float>(static_cast<std::int8_t>(input.byte())) / 64; };
    return Position{x(), x(), x()};
  };
  const std::vector<Landmark> from{{"nose_tip", place()}, {"eye_centre_left", place()}, {"eye_centre_right", place()}};
  TemplateCage cage = prepareTemplate({other.view(), from});
  cage.offset = std::max(cage.offset, 0.003 * cage.diagonal);
  std::vector<Anchor> anchors;
  for (std::uint32_t i = 1 + input.below(6); i > 0; --i) {
    const Vec3 at = positionOf({"", place()});
    const bool isTwice = std::any_of(anchors.begin(), anchors.end(),
                                     [&](const Anchor& one) { return length(one.from - at) < 1e-3 * cage.diagonal; });
    if (!isTwice) anchors.push_back({at, positionOf({"", place()}), input.flag() ? 0.0 : 0.1});
  }
  const Warp warp(anchors, cage.diagonal);
  std::vector<Vec3> positions = cage.mesh.positions;
  for (Vec3& p : positions) p = warp(p);
  check({positions, {}});
  const StepCallback step = [&](double share) { return patience.ask(static_cast<float>(share)); };
  const double reach = static_cast<double>(input.share());
  positions = tighten(cage, positions, mesh, {.reach = reach, .sliding = 0.5, .stiffest = 30, .softest = 1}, step);
  require(positions.empty() == patience.gone());
  if (patience.gone()) return;
  EyedFigure figure{mesh, std::vector<bool>(mesh.triangles.size()), {}, {}, {}, 0, eyePairs(from, from), {}, {}};
  figure.components = connectedPieces(mesh, figure.componentCount);
  std::vector<Vec3> tracks;
  if (!fitEyeHoles(cage, figure, step, tracks, positions) || !relax(cage, tracks, step, positions)) return;
  if (pushOut(cage, {mesh, mesh}, tracks, step, positions)) check({positions, cage.mesh.triangles});
}

/// Closest points and rays of anything, and pairs around any eyes.
void search(fuzz::Input& input, const TriangleMesh& mesh) {
  const auto anywhere = [&] { return Position{input.coordinate(), input.coordinate(), input.coordinate()}; };
  std::vector<Vec3> points;
  for (std::uint32_t i = input.below(6); i > 0; --i) points.push_back(positionOf({"", anywhere()}));
  const Surface surface(mesh);
  for (const SurfacePoint& point : surface.closest(points)) {
    require(point.triangle < mesh.triangles.size() && point.distance >= 0);
    check({{point.position}, {}});
  }
  std::vector<SurfaceRay> rays;
  for (const Vec3& p : points) rays.push_back({p, unit(points[0])});
  for (const RayHit& hit : surface.trace(rays)) require(hit.triangle < mesh.triangles.size());
  std::vector<Landmark> eyes{{"eye_centre_left", {1, 1, 0}}, {"eye_centre_right", {-1, 1, 0}}, {"nose_tip", {0, 0, 1}}};
  for (const char* name : {"eye_inner_left", "eye_outer_left", "eye_inner_right", "eye_outer_right"}) {
    const Vec3 at = positionOf({"", anywhere()});
    eyes.push_back({name, input.flag() || !(length(at) < 100) ? eyes.back().position : toPosition(at)});
  }
  for (const Anchor& anchor : eyeAnchors(eyes, eyes, axesOf(eyes))) check({{anchor.from, anchor.to}, {}});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t step = input.below(3);
  fuzz::Patience patience(input);
  const fuzz::Mesh given = input.flag() ? fuzz::Mesh::ball(input, false) : fuzz::Mesh(input, false);
  if (!checkMesh(given.view(), Argument::model).ok()) return 0;
  const TriangleMesh mesh = weldExactly(given.view());
  if (step == 0) wrapAndCut(input, mesh, patience);
  if (step == 1) layOut(input, mesh, patience);
  if (step == 2) fit(input, mesh, patience);
  search(input, mesh);
  return 0;
}
