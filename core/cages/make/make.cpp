#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "cagecast/cages.hpp"
#include "charts/unwrap.hpp"
#include "landmarks/eyes.hpp"
#include "landmarks/frame.hpp"
#include "landmarks/parts.hpp"
#include "make/hole_marker.hpp"
#include "make/steps.hpp"
#include "mesh/check_model.hpp"
#include "mesh/foreground.hpp"
#include "mesh/part_names.hpp"
#include "mesh/progress.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Ends of the stages, as shares of the time.
constexpr float kFoundEnd = 0.1f;
constexpr float kHullEnd = 0.3f;
constexpr float kHolesEnd = 0.5f;
constexpr float kSimplifyEnd = 0.6f;
constexpr float kEncloseEnd = 0.75f;

/// How far below the border of a neck the cage ends, in offsets.
constexpr double kNeckExtension = 2;
/// How far below the hull a part may lie and still be seen through it, in offsets.
constexpr double kVisibleDepth = 1.4;
/// The model stays this share of the offset behind the cage.
constexpr double kDepthMargin = 0.4;
/// How far a vertex of the cage may be moved outwards, in offsets.
constexpr double kFarthestPush = 4;
/// How often the cage is made at most, with wider holes where it covers too much.
constexpr int kAttempts = 5;
/// Holes are widened until they open this share more of the hull, at most.
constexpr double kMaxWidened = 0.1;
/// The cage is moved past about this many points of the hull.
constexpr std::size_t kEnclosedPoints = 20000;

/// The options of a call with all values filled in. Lengths are in the space of the model.
struct MakeSettings {
  Kind kind = Kind::prop;
  HullOptions hull;
  std::uint32_t triangles = 0;
};

Status checkOptions(const MakeOptions& options) {
  if (options.kind > Kind::prop)
    return {Code::badOption, Argument::options, 0, Option::kind, static_cast<float>(options.kind)};
  for (const auto& [option, value] : {std::pair{Option::closing, options.closing},
                                      {Option::offset, options.offset},
                                      {Option::voxels, static_cast<float>(options.voxels)},
                                      {Option::triangles, static_cast<float>(options.triangles)}}) {
    if (value == 0) continue;  // By kind.
    if (const Status status = checkOption(option, value); !status.ok()) return status;
  }
  return {};
}

MakeSettings settingsFor(const Model& model, const MakeOptions& options, double diagonal) {
  MakeSettings settings;
  settings.kind = options.kind == Kind::automatic ? kindOf(model) : options.kind;
  const bool isBody = settings.kind == Kind::body;
  const auto closing = static_cast<double>(options.closing), offset = static_cast<double>(options.offset);
  settings.hull.closing = diagonal * (closing > 0 ? closing : isBody ? 0.008 : 0.02);
  settings.hull.offset = diagonal * (offset > 0 ? offset : isBody ? 0.004 : 0.01);
  settings.hull.voxels = options.voxels != 0 ? options.voxels : isBody ? 240 : 140;
  settings.triangles = options.triangles != 0 ? options.triangles : isBody ? 1500 : 600;
  return settings;
}

/// Whether each triangle of the mesh must not be painted.
/// @param triangleOf  The triangle of the model for each of the mesh.
std::vector<bool> marksOf(const Model& model, const MakeOptions& options,
                          const std::vector<std::uint32_t>& triangleOf) {
  const std::vector<bool> isExcluded = excludedTriangles(model, options.parts);
  std::vector<bool> isMarked(triangleOf.size());
  for (std::size_t t = 0; t < triangleOf.size(); ++t) {
    const std::uint32_t original = triangleOf[t];
    isMarked[t] = isExcluded[original] || (!model.marks.empty() && model.marks[original] != 0);
  }
  return isMarked;
}

bool hasMarks(const std::vector<bool>& isMarked) {
  return std::find(isMarked.begin(), isMarked.end(), true) != isMarked.end();
}

/// Whether eyes are where a face has its own, seen from the front.
bool areOf(const FaceFrame& face, const Eyes& eyes) {
  constexpr double kOff = 0.25;  ///< In distances of the eyes.
  return std::all_of(eyes.centres.begin(), eyes.centres.end(), [&](const Vec3& centre) {
    const Vec3 d = face.toLocal(centre);
    return std::hypot(std::abs(d.x) - 0.5, d.y) < kOff;
  });
}

/// Marks the eyes of a head or a figure by their shape, two loose pieces, where no part is called an eye. If anything
/// is marked already, they have to be those of the face.
/// @param[in,out] isMarked  Per triangle of the model without those that have no area.
/// @return false if `progress` cancelled it.
bool markLooseEyes(const Model& model, const std::optional<FaceFrame>& face, const std::vector<bool>& isKept,
                   const Progress& progress, std::vector<bool>& isMarked) {
  const Figure figure = readFigure(model);
  if (figure.has(Role::eye) || figure.componentCount < 3) return true;  // Two eyes, and what they are eyes of.
  const auto mark = [&](const MirrorPlane& plane, bool isAnywhere) {
    const std::optional<Eyes> eyes = findLooseEyes(figure, plane);
    if (!eyes || eyes->triangles.size() != isMarked.size() || !(isAnywhere || areOf(*face, *eyes))) return false;
    for (std::size_t t = 0; t < isMarked.size(); ++t) isMarked[t] = isMarked[t] || (eyes->triangles[t] && !isKept[t]);
    return true;
  };
  if (!report(progress, 0, "landmarks")) return false;
  if (face && mark({face->left, dot(face->left, face->middle)}, false)) return true;
  if (hasMarks(isMarked)) return true;
  for (const MirrorPlane& plane : findMirrorPlanes(figure.mesh)) {
    if (!report(progress, 0, "landmarks")) return false;
    if (mark(plane, true)) break;
  }
  return true;
}

/// Marks the wheels of a vehicle by their shape, unless they are kept, or names say what its wheels are.
void lookForWheels(const Model& model, Kind kind, const TriangleMesh& mesh, const std::vector<bool>& isKept,
                   std::vector<bool>& isMarked) {
  static const std::vector<std::string> kNames = {"*wheel*", "tyre*", "tire*", "rim", "rims"};
  const std::vector<bool> named = matchingParts(model.parts, kNames);
  const bool isNamed = std::find(named.begin(), named.end(), true) != named.end();
  if (kind != Kind::prop || isNamed) return;
  const std::vector<bool> wheels = wheelsOf(mesh);
  for (std::size_t t = 0; t < wheels.size(); ++t) isMarked[t] = isMarked[t] || (wheels[t] && !isKept[t]);
}

/// Points below the hull, but in front of the model, which the cage must not fall behind.
OuterPoints pointsToEnclose(const TriangleMesh& hull, const std::vector<double>& field, double depth) {
  const std::vector<Vec3> normals = vertexNormals(hull);
  const std::size_t step = std::max<std::size_t>(1, hull.positions.size() / kEnclosedPoints);
  OuterPoints points;
  for (std::size_t v = 0; v < hull.positions.size(); v += step) {
    if (field[v] >= 0.5) continue;
    points.positions.push_back(hull.positions[v] - depth * normals[v]);
    points.normals.push_back(normals[v]);
  }
  return points;
}

/// What a cage is shaped from.
struct MarkedHull {
  const TriangleMesh& mesh;
  const std::vector<Neck>& necks;
  HoleMarker& marker;
};

constexpr Status kNothingToPaint{Code::nothingToPaint, Argument::model};

/// Cuts holes into a hull, simplifies it, and moves it past the model; again with wider holes where it then covers too
/// much of what must not be painted. A later cage may be worse, as it is simplified differently: the best is kept.
Status shape(const MarkedHull& hull, const MakeSettings& settings, const Progress& progress, TriangleMesh& out) {
  const double offset = settings.hull.offset, depth = (1 - kDepthMargin) * offset;
  double covered = 1, leastCovered = std::numeric_limits<double>::infinity(), leastClosed = 0;
  for (int attempt = 0; attempt < kAttempts && covered > 0; ++attempt) {
    std::vector<double> field = hull.marker.field();
    openNecks(hull.mesh, hull.necks, field);
    const auto closed = std::count_if(field.begin(), field.end(), [](double open) { return open < 0.5; });
    if (attempt == 0) leastClosed = (1 - kMaxWidened) * static_cast<double>(closed);
    if (static_cast<double>(closed) < leastClosed) break;
    const TriangleMesh shell = cutHoles(hull.mesh, field);
    if (shell.empty() && out.empty()) return kNothingToPaint;
    TriangleMesh cage;
    if (!simplify(shell, {settings.triangles, offset}, partOf(progress, kHolesEnd, kSimplifyEnd), cage))
      return kAborted;
    if (cage.empty() && out.empty()) return {Code::tooFewTriangles, Argument::model};
    if (cage.empty()) break;
    if (!enclose(pointsToEnclose(hull.mesh, field, depth), kFarthestPush * offset,
                 partOf(progress, kSimplifyEnd, kEncloseEnd), cage))
      return kAborted;
    if (!hull.marker.widen(cage, partOf(progress, kEncloseEnd, kEncloseEnd), covered)) return kAborted;
    if (covered >= leastCovered) continue;
    leastCovered = covered;
    out = std::move(cage);
  }
  return {};
}

void store(const Layout& layout, Kind kind, std::vector<Landmark> landmarks, Cage& out) {
  out = {};
  out.kind = kind;
  out.landmarks = std::move(landmarks);
  for (const Vec3& p : layout.mesh.positions) append(out.positions, p);
  for (const Uv& uv : layout.uvs)
    for (const double x : uv) out.uvs.push_back(static_cast<float>(x));
  for (const Triangle3& t : layout.mesh.triangles) out.indices.insert(out.indices.end(), t.begin(), t.end());
}

Status make(const Model& given, const MakeOptions& options, const Progress& progress, Cage& out) {
  if (const Status status = checkModel(given); !status.ok()) return status;
  if (const Status status = checkOptions(options); !status.ok()) return status;
  if (const Status status = checkParts(given, options.parts); !status.ok()) return status;
  const WithoutParts rest(given, options.parts.ignore);
  if (const Status status = checkModel(rest.model()); !status.ok()) return status;
  const Foreground foreground(rest.model());
  const Model& model = foreground.model();
  float reached = 0;  // A repeated stage does not go back.
  const Progress rising = [&progress, &reached](float share, const char* stage) {
    reached = std::max(reached, share);
    return report(progress, reached, stage);
  };
  const auto part = [&rising](float from, float to) { return partOf(rising, from, to); };
  std::vector<std::uint32_t> triangleOf;
  TriangleMesh mesh = weldExactly(model.mesh, nullptr, &triangleOf);
  MakeSettings settings = settingsFor(model, options, diagonalOf(mesh));
  const double offset = settings.hull.offset;
  std::vector<bool> isMarked = marksOf(model, options, triangleOf);
  const std::vector<bool> ofKept = trianglesIn(model.mesh, options.parts.keep);
  std::vector<bool> isKept(triangleOf.size());
  for (std::size_t t = 0; t < triangleOf.size(); ++t) isKept[t] = ofKept[triangleOf[t]];
  FoundLandmarks found;
  if (const Status status = findLandmarks(model, part(0, kFoundEnd), found); !status.ok()) return status;
  const std::optional<FaceFrame> face = faceFrameOf(found.landmarks);
  const bool mayBeHead = options.kind == Kind::automatic && isCompactProp(model);
  const bool wasMarked = hasMarks(isMarked);
  if ((settings.kind != Kind::prop || mayBeHead) && !markLooseEyes(model, face, isKept, rising, isMarked))
    return kAborted;
  if (mayBeHead && (face || (hasMarks(isMarked) && !wasMarked))) settings.kind = Kind::head;  // As it has eyes.
  lookForWheels(model, settings.kind, mesh, isKept, isMarked);
  std::vector<Neck> necks;
  if (settings.kind == Kind::head) necks = extendNecks(kNeckExtension * offset, mesh);
  if (std::find(isMarked.begin(), isMarked.end(), false) == isMarked.end()) return kNothingToPaint;
  isMarked.resize(mesh.triangles.size(), false);  // `extendNecks` has added triangles; they may be painted.
  TriangleMesh hull;
  const WrapOptions wrapping{settings.hull, options.closing == 0};
  if (const Status status = wrap(mesh, isMarked, wrapping, part(kFoundEnd, kHullEnd), hull); !status.ok())
    return status;

  const Surface surface(mesh);
  MarkedMesh marked{&mesh, &surface, std::move(isMarked), std::move(isKept)};
  if (face) {
    marked.eyes = ColoredEyes(model, marked, triangleOf, found.landmarks, *face);
    marked.face = faceSkinOf(model, marked, triangleOf, *face);
  }
  HoleMarker marker(marked, kVisibleDepth * offset, hull);
  if (!marker.mark(settings.kind == Kind::body ? 2 : 1, part(kHullEnd, kHolesEnd))) return kAborted;
  TriangleMesh cage;
  if (const Status status = shape({hull, necks, marker}, settings, rising, cage); !status.ok()) return status;
  Layout layout;
  UnwrapOptions unwrapOptions;
  const Stance stance = stanceOf(model);
  unwrapOptions.kind = settings.kind;
  unwrapOptions.up = stance.up;
  unwrapOptions.front = stance.front;
  unwrapOptions.face = face;
  if (!unwrap(cage, unwrapOptions, part(kEncloseEnd, 1), layout)) return kAborted;
  if (!rising(1, "unwrap")) return kAborted;
  store(layout, settings.kind, std::move(found.landmarks), out);
  return {};
}

}  // namespace

Status makeCage(const Model& model, const MakeOptions& options, const Progress& progress, Cage& out) {
  return guarded([&] { return make(model, options, progress, out); });
}

}  // namespace cagecast::cages
