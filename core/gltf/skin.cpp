#include "skin.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "parse.hpp"

namespace cagecast::gltf {
namespace {

/// Joints place a mesh equally if they differ by at most this share of its size.
constexpr double kSamePlace = 1e-3;

/// How many times as large a transform makes what it places.
double sizeOf(const Transform& transform) { return std::cbrt(std::abs(transform.determinant())); }

/// For each joint of a skin, its transform in the scene · its inverse bind matrix; zeros if the latter is missing.
std::vector<Transform> jointTransforms(const tinygltf::Model& model, const std::vector<Transform>& worlds, int index) {
  const tinygltf::Skin& skin = model.skins[static_cast<std::size_t>(index)];
  const std::string where = "skins[" + std::to_string(index) + "]";
  const bool hasInverses = skin.inverseBindMatrices >= 0;
  std::vector<double> inverses;
  if (hasInverses)
    inverses = decode(model, skin.inverseBindMatrices, TINYGLTF_TYPE_MAT4, 16, where + ".inverseBindMatrices");
  std::vector<Transform> transforms;
  for (const int joint : skin.joints) {
    const Transform& world = element(worlds, joint, "nodes", where + ".joints");
    const std::size_t at = 16 * transforms.size();
    if (!hasInverses)
      transforms.push_back(world);
    else
      transforms.push_back(at < inverses.size() ? world * transformOf(&inverses[at]) : Transform{{}});
  }
  return transforms;
}

/// Which joints hold vertices of an instance.
std::vector<bool> holdingJoints(const tinygltf::Model& model, const Instance& instance, std::size_t joints,
                                std::size_t vertexCount) {
  const auto attribute = [&](const std::string& name) {
    std::vector<double> values;
    const int accessor = attributeOf(instance.primitive, name);
    if (accessor < 0) return values;
    values = decode(model, accessor, TINYGLTF_TYPE_VEC4, 4, instance.where + "." + name);
    if (values.size() < vertexCount * 4)
      fail(instance.where, ".", name, " has ", values.size() / 4, " elements for ", vertexCount, " vertices");
    return values;
  };
  const std::vector<double> held = attribute("JOINTS_0"), weights = attribute("WEIGHTS_0");
  std::vector<bool> holds(joints, false);
  for (std::size_t i = 0; i < std::min(held.size(), weights.size()); ++i)
    if (weights[i] > 0 && held[i] >= 0 && held[i] < static_cast<double>(joints))
      holds[static_cast<std::size_t>(held[i])] = true;
  return holds;
}

/// Where joints place a mesh if the model is at rest, and if it has moved.
struct Hold {
  bool isBound;  ///< Whether the joints that hold it agree.
  Transform atRest, moved;
};

Hold holdOf(const tinygltf::Model& model, const std::vector<Transform>& joints, const Instance& instance) {
  const int position = attributeOf(instance.primitive, "POSITION");
  const std::vector<double> positions = decode(model, position, TINYGLTF_TYPE_VEC3, 3, instance.where + ".POSITION");
  const bool isFloat =
      model.accessors[static_cast<std::size_t>(position)].componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
  double reach = 0;
  for (const double coordinate : positions) reach = std::max(reach, std::abs(coordinate));

  const std::vector<bool> holds = holdingJoints(model, instance, joints.size(), positions.size() / 3);
  std::vector<Transform> holding;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (holds[j] && sizeOf(joints[j]) > 0) holding.push_back(joints[j]);
  const Transform stored;
  const Transform& first = holding.empty() ? stored : holding.front();
  const double size = sizeOf(first), tolerance = kSamePlace * size;
  // Whether two transforms place all vertices equally, within the tolerance along each axis.
  const auto isNear = [&](const Transform& a, const Transform& b) {
    for (std::size_t row = 0; row < 12; row += 4) {
      const auto off = [&](std::size_t column) { return std::abs(a.m[row + column] - b.m[row + column]); };
      if (!((off(0) + off(1) + off(2)) * reach + off(3) <= tolerance * reach)) return false;
    }
    return true;
  };
  const auto isAsLarge = [&](const Transform& transform) { return std::abs(sizeOf(transform) - size) < tolerance; };
  const auto placeBy = [&](const Transform& transform) { return isNear(transform, stored) ? stored : transform; };
  // A joint that holds no vertex may have any matrix.
  const Transform& guide = !joints.empty() && isAsLarge(joints.front()) ? joints.front() : first;
  return {std::all_of(holding.begin(), holding.end(), [&](const Transform& joint) { return isNear(joint, first); }),
          placeBy(first), isFloat && isAsLarge(stored) ? stored : placeBy(guide)};
}

}  // namespace

void placeSkinned(const tinygltf::Model& model, const std::vector<Transform>& worlds,
                  std::vector<Instance>& instances) {
  std::map<int, std::vector<Transform>> jointsOf;  // Of each skin.
  std::vector<std::pair<Instance*, Hold>> skinned;
  bool isAtRest = true;
  for (Instance& instance : instances) {
    if (instance.skin < 0) continue;
    const auto [joints, isNew] = jointsOf.try_emplace(instance.skin);
    if (isNew) joints->second = jointTransforms(model, worlds, instance.skin);
    skinned.emplace_back(&instance, holdOf(model, joints->second, instance));
    isAtRest = isAtRest && skinned.back().second.isBound;
  }
  for (const auto& [instance, hold] : skinned) instance->world = isAtRest ? hold.atRest : hold.moved;
}

}  // namespace cagecast::gltf
