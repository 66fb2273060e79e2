#include "mesh/check_model.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/triangle.hpp"
#include "input/validate.hpp"
#include "mesh/bounds.hpp"
#include "mesh/limits.hpp"

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

/// What the triangles of a mesh have together.
struct Area {
  double sum = 0;
  bool hasHeight = false;  ///< Whether one of them is more than a needle.

  Area(const MeshView& mesh, double diagonal) {
    const auto corner = [&](std::size_t i) { return &mesh.positions[std::size_t{3} * mesh.indices[i]]; };
    const auto edge = [&](std::size_t i, std::size_t j) {
      return length(Vec3::from(corner(j)) - Vec3::from(corner(i)));
    };
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      // A height counts by the size of the mesh: the searches scale that to 1, and take floats.
      const double longest = std::max({edge(i, i + 1), edge(i + 1, i + 2), edge(i + 2, i)});
      const double twice = length(cagecast::areaNormal(corner(i), corner(i + 1), corner(i + 2)));
      hasHeight = hasHeight || twice > kMinModelHeight * diagonal * longest;
      sum += 0.5 * twice;
    }
  }
};

/// Whether a base colour is one that can be read.
bool isGood(const BaseColor& color, bool hasUvs) {
  constexpr std::uint32_t kMaxSide = 1U << 16;  ///< Of an image: sizes stay within 64 bits.
  const auto& [width, height, pixels] = color.image;
  const bool isWithin = std::all_of(color.factor.begin(), color.factor.end(), [](float x) { return x >= 0 && x <= 1; });
  const bool isWhole = std::max(width, height) <= kMaxSide && pixels.size() == std::uint64_t{4} * width * height;
  return isWithin && isWhole && (pixels.empty() || hasUvs);
}

}  // namespace

Status checkMesh(const MeshView& mesh, Argument argument) noexcept {
  const auto fault = [argument](Code code, std::size_t at = 0) {
    return Status{code, argument, static_cast<std::uint32_t>(at)};
  };
  // As a model, as a cage need not have UVs.
  if (Status status = checkArrays(mesh, Argument::model); !status.ok()) {
    status.argument = argument;
    return status;
  }
  const bool isModel = argument == Argument::model;
  if (mesh.indices.size() / 3 > (isModel ? kMaxModelTriangles : kMaxCageTriangles) ||
      mesh.positions.size() / 3 > (isModel ? kMaxModelVertices : kMaxCageVertices))
    return fault(Code::tooDetailed);
  const Bounds bounds = boundsOf(mesh);
  const double diagonal = bounds.diagonal();
  const Area area(mesh, diagonal);
  if (!area.hasHeight) return fault(Code::flatMesh);
  if (const double layers = area.sum / (diagonal * diagonal); layers > kMaxLayers)
    return Status{.code = Code::tooManyLayers, .argument = argument, .value = static_cast<float>(layers)};
  if (diagonal < kMinDiagonal) return fault(Code::tooSmall);
  const double limit = std::min(kMaxCoordinate, kMaxDiagonalsAway * diagonal);
  for (const std::uint32_t v : mesh.indices)
    for (std::size_t i = std::size_t{3} * v; i < std::size_t{3} * v + 3; ++i)
      if (std::abs(static_cast<double>(mesh.positions[i])) > limit) return fault(Code::tooFar, i);
  return {};
}

Status checkModel(const Model& model) noexcept {
  if (const Status status = checkMesh(model.mesh, Argument::model); !status.ok()) return status;
  const auto fault = [](Code code, std::size_t at) {
    return Status{code, Argument::model, static_cast<std::uint32_t>(at)};
  };
  if (!model.marks.empty() && model.marks.size() != model.mesh.indices.size() / 3)
    return fault(Code::markCountMismatch, model.marks.size());
  for (std::size_t v = 0; v < model.mesh.groups.size() && !model.parts.empty(); ++v)
    if (model.mesh.groups[v] >= model.parts.size()) return fault(Code::partOutOfRange, v);
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const auto& [name, position, parent] = model.joints[j];
    if (!std::all_of(position.begin(), position.end(), [](float x) { return std::isfinite(x); }))
      return fault(Code::nonFiniteJoint, j);
    if (parent < -1 || parent >= static_cast<std::int64_t>(model.joints.size()))
      return fault(Code::parentOutOfRange, j);
  }
  if (!model.vertexJoints.empty() && model.vertexJoints.size() != model.mesh.positions.size() / 3)
    return fault(Code::vertexJointCountMismatch, model.vertexJoints.size());
  for (std::size_t v = 0; v < model.vertexJoints.size(); ++v)
    if (model.vertexJoints[v] != kNoJoint && model.vertexJoints[v] >= model.joints.size())
      return fault(Code::vertexJointOutOfRange, v);
  for (std::size_t p = 0; p < model.baseColors.size(); ++p)
    if (!isGood(model.baseColors[p], !model.mesh.uvs.empty())) return fault(Code::badBaseColor, p);
  for (std::size_t v = 0; v < model.mesh.groups.size() && !model.baseColors.empty(); ++v)
    if (model.mesh.groups[v] >= model.baseColors.size()) return fault(Code::noBaseColor, v);
  return {};
}

Status checkOption(Option option, float value) noexcept {
  for (const OptionRange& range : kOptionRanges)
    if (range.option == option && value >= range.low && value <= range.high) return {};
  return {Code::badOption, Argument::options, 0, option, value};
}

}  // namespace cagecast::cages
