#include "mesh/check_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "geometry/triangle.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

/// A mesh needs a triangle that is higher than this share of its diagonal.
constexpr double kMinModelHeight = 1e-6;

/// Farthest a coordinate may be from the origin, in diagonals of the mesh: what `Surface` can take.
constexpr double kMaxDiagonalsAway = 1e6;

/// Range of sizes of a mesh: smaller coordinates would be floats of fewer digits, and a cage around larger ones would
/// not fit a float.
constexpr double kMinDiagonal = 1e-37;
constexpr double kMaxCoordinate = 0x1p125;

std::string element(const char* name, const char* field, std::size_t i) {
  return std::string(name) + "." + field + "[" + std::to_string(i) + "]";
}

std::string size(std::size_t count, const char* what) { return std::to_string(count) + " " + what; }

/// The sentence about the arrays' sizes, or nothing.
std::string sizesOf(const MeshView& mesh, const std::string& name) {
  const std::size_t vertices = mesh.positions.size() / 3, triangles = mesh.indices.size() / 3;
  if (mesh.positions.empty()) return name + " has no vertices";
  if (mesh.indices.empty()) return name + " has no triangles";
  if (mesh.positions.size() % 3 != 0)
    return name + ".positions has " + size(mesh.positions.size(), "numbers, not three per vertex");
  if (mesh.indices.size() % 3 != 0)
    return name + ".indices has " + size(mesh.indices.size(), "numbers, not three per triangle");
  if (triangles > kMaxModelTriangles)
    return name + " has " + size(triangles, "triangles, more than ") + std::to_string(kMaxModelTriangles) +
           "; simplify it first";
  if (vertices > kMaxModelVertices)
    return name + " has " + size(vertices, "vertices, more than ") + std::to_string(kMaxModelVertices) +
           "; simplify it first";
  if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * vertices)
    return name + ".uvs has " + size(mesh.uvs.size(), "numbers for ") + size(vertices, "vertices");
  if (!mesh.groups.empty() && mesh.groups.size() != vertices)
    return name + ".groups has " + size(mesh.groups.size(), "numbers for ") + size(vertices, "vertices");
  return {};
}

/// The sentence about the numbers in the arrays, or nothing.
std::string valuesOf(const MeshView& mesh, const char* name) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!std::isfinite(mesh.positions[i])) return element(name, "positions", i) + " is not a finite number";
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
    if (!std::isfinite(mesh.uvs[i])) return element(name, "uvs", i) + " is not a finite number";
  const std::size_t vertices = mesh.positions.size() / 3;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.indices[i] >= vertices)
      return element(name, "indices", i) + " = " + std::to_string(mesh.indices[i]) + ", but there are " +
             size(vertices, "vertices");
  return {};
}

/// The sentence about its size and place in space, or nothing.
std::string extentOf(const MeshView& mesh, const std::string& name) {
  const auto [low, high] = boundsOf(mesh);
  const auto corner = [&](std::size_t i) { return &mesh.positions[std::size_t{3} * mesh.indices[i]]; };
  const auto edge = [&](std::size_t i, std::size_t j) {
    return length(cagecast::Vec3::from(corner(j)) - cagecast::Vec3::from(corner(i)));
  };
  // Its height counts by the size of the mesh: the searches scale that to 1, and take floats.
  const double least = kMinModelHeight * length(high - low);
  bool hasArea = false;
  for (std::size_t i = 0; i < mesh.indices.size() && !hasArea; i += 3) {
    const double longest = std::max({edge(i, i + 1), edge(i + 1, i + 2), edge(i + 2, i)});
    hasArea = length(cagecast::areaNormal(corner(i), corner(i + 1), corner(i + 2))) > least * longest;
  }
  if (!hasArea) return name + " has no triangle with an area";
  const double diagonal = length(high - low);
  if (diagonal < kMinDiagonal) return name + " is smaller than 1e-37 across";
  const double farthest = std::max({-low.x, -low.y, -low.z, high.x, high.y, high.z});
  if (farthest > kMaxCoordinate) return name + " reaches farther than 4.2e37 from the origin";
  if (farthest > kMaxDiagonalsAway * diagonal)
    return name + " is more than a million times its size away from the origin";
  return {};
}

}  // namespace

Outcome checkMesh(const MeshView& mesh, const char* name, Problem problem) {
  std::string message = sizesOf(mesh, name);
  if (message.empty()) message = valuesOf(mesh, name);
  if (message.empty()) message = extentOf(mesh, name);
  if (message.empty()) return {};
  return {problem, std::move(message)};
}

Outcome checkModel(const Model& model) {
  if (Outcome outcome = checkMesh(model.mesh, "model", Problem::badModel); !outcome.ok()) return outcome;
  const auto fault = [](std::string message) { return Outcome{Problem::badModel, std::move(message)}; };
  const std::size_t triangles = model.mesh.indices.size() / 3;
  if (!model.marks.empty() && model.marks.size() != triangles)
    return fault("model.marks has " + size(model.marks.size(), "numbers for ") + size(triangles, "triangles"));
  if (!model.parts.empty())
    for (std::size_t v = 0; v < model.mesh.groups.size(); ++v)
      if (model.mesh.groups[v] >= model.parts.size())
        return fault(element("model", "groups", v) + " = " + std::to_string(model.mesh.groups[v]) + ", but there are " +
                     size(model.parts.size(), "parts"));
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const Joint& joint = model.joints[j];
    for (const float x : joint.position)
      if (!std::isfinite(x)) return fault(element("model", "joints", j) + ".position is not finite");
    if (joint.parent < -1 || joint.parent >= static_cast<std::int64_t>(model.joints.size()))
      return fault(element("model", "joints", j) + ".parent = " + std::to_string(joint.parent) + ", but there are " +
                   size(model.joints.size(), "joints"));
  }
  return {};
}

Outcome checkOption(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  char message[160];
  std::snprintf(message, sizeof message, "options.%s = %g is not within %g..%g", name, value, least, most);
  return {Problem::badOptions, message};
}

}  // namespace cagecast::cages
