#include "skin.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "parse.hpp"

namespace cagecast::gltf {
namespace {

/// Joints place a mesh equally if they differ by at most this share of its size.
constexpr double kSamePlace = 1e-3;
/// The cosine of the angle from which on a rig is turned against all that is above it: 45°.
constexpr double kTurned = 0.7071;
/// The cosine of the angle by which a rig's axes may be off those of the scene: 5°.
constexpr double kAligned = 0.9962;

/// How many times as large a transform makes what it places.
double sizeOf(const Transform& transform) { return std::cbrt(std::abs(transform.determinant())); }

/// The nodes of a file, and what is above them.
class Tree {
 public:
  Tree(const tinygltf::Model& model, const std::vector<Transform>& toScene)
      : worlds(toScene), parents_(toScene.size(), -1), isJoint_(toScene.size(), false) {
    for (std::size_t n = 0; n < parents_.size(); ++n)
      for (const int child : model.nodes[n].children)
        if (child >= 0 && at(child) < parents_.size()) parents_[at(child)] = static_cast<int>(n);
  }

  const std::vector<Transform>& worlds;

  void addJoints(const std::vector<int>& joints) {
    for (const int joint : joints) isJoint_[at(joint)] = true;
  }

  /// A node and those above it; each once, as a node may be below itself.
  std::vector<int> upFrom(int node) {
    std::vector<int> up;
    for (std::set<int> passed; node >= 0 && passed.insert(node).second; node = parents_[at(node)]) up.push_back(node);
    steps_ += up.size();
    if (steps_ > kMaxSceneElements) fail("has too many nodes above those with skins");
    return up;
  }

  /// Those of a way up that are below no joint, and none: what is below a joint has moved with it.
  std::vector<int> fixed(const std::vector<int>& up) const {
    const auto last = std::find_if(up.rbegin(), up.rend(), [&](int node) { return isJoint_[at(node)]; });
    return {last.base(), up.end()};
  }

 private:
  static std::size_t at(int node) { return static_cast<std::size_t>(node); }

  std::vector<int> parents_;
  std::vector<bool> isJoint_;
  std::size_t steps_ = 0;
};

/// A skin, and where its joints would place a mesh.
struct Skin {
  std::vector<int> joints;
  std::vector<Transform>
      transforms;                ///< 1 per joint: its own to the scene · its inverse bind matrix; zeros without it.
  std::vector<bool> isKnown;     ///< 1 per joint: whether that matrix seems to be its own.
  std::size_t root = 0;          ///< The topmost joint.
  std::vector<Transform> above;  ///< Of what is above all joints.
};

Skin readSkin(const tinygltf::Model& model, const Tree& tree, int index) {
  const tinygltf::Skin& skin = model.skins[static_cast<std::size_t>(index)];
  const std::string where = "skins[" + std::to_string(index) + "]";
  const bool hasInverses = skin.inverseBindMatrices >= 0;
  std::vector<double> inverses;
  if (hasInverses)
    inverses = decode(model, skin.inverseBindMatrices, TINYGLTF_TYPE_MAT4, 16, where + ".inverseBindMatrices");
  Skin out;
  out.joints = skin.joints;
  for (const int joint : skin.joints) {
    const Transform& world = element(tree.worlds, joint, "nodes", where + ".joints");
    const std::size_t at = 16 * out.transforms.size();
    const bool hasInverse = at < inverses.size();
    const Transform inverse = hasInverse ? transformOf(&inverses[at]) : Transform{};
    // An exporter may not have known the matrix of a joint that holds nothing.
    out.isKnown.push_back(hasInverse && inverse != Transform{});
    out.transforms.push_back(!hasInverses ? world : hasInverse ? world * inverse : Transform{{}});
  }
  return out;
}

/// Finds what is above the joints of a skin. All joints of the model must be known.
void findRoot(Skin& skin, Tree& tree) {
  if (skin.joints.empty()) return;
  std::map<int, std::size_t> numbers;
  for (std::size_t j = 0; j < skin.joints.size(); ++j) numbers.try_emplace(skin.joints[j], j);
  const std::vector<int> up = tree.upFrom(skin.joints.front());
  for (const int node : up)
    if (const auto found = numbers.find(node); found != numbers.end()) skin.root = found->second;
  for (const int node : tree.fixed(up)) skin.above.push_back(tree.worlds[static_cast<std::size_t>(node)]);
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

/// The cosine of the angle between two rotations, whatever their scale.
double cosineOf(const Transform& a, const Transform& b) {
  double trace = 0;
  for (std::size_t i = 0; i < 12; ++i)
    if (i % 4 < 3) trace += a.m[i] * b.m[i];
  return (trace / (sizeOf(a) * sizeOf(b)) - 1) / 2;
}

/// Whether a rotation takes axes to axes.
bool isAligned(const Transform& transform) {
  for (std::size_t column = 0; column < 3; ++column) {
    double largest = 0;
    for (std::size_t row = 0; row < 12; row += 4) largest = std::max(largest, std::abs(transform.m[row + column]));
    if (!(largest > kAligned * sizeOf(transform))) return false;
  }
  return true;
}

/// How joints hold a mesh, and where it may be.
struct Hold {
  std::vector<Transform> stored;  ///< In the bind pose, as far as that is known without the joints.
  Transform first, guide;         ///< What the first joint that holds it says, and the topmost one.
  double reach = 0;               ///< The largest coordinate.
  bool isBound = true;            ///< Whether all joints that hold it agree.
  bool isTurned = false;          ///< Whether the topmost joint is turned by a quarter against all that is above it.
  bool isFloat = true;

  /// How far two transforms place a vertex from each other at most, along an axis.
  double distance(const Transform& a, const Transform& b) const {
    double most = 0;
    for (std::size_t row = 0; row < 12; row += 4) {
      const auto off = [&](std::size_t column) { return std::abs(a.m[row + column] - b.m[row + column]); };
      most = std::max(most, (off(0) + off(1) + off(2)) * reach + off(3));
    }
    return most;
  }
  bool isNear(const Transform& a, const Transform& b) const {
    return distance(a, b) <= kSamePlace * sizeOf(first) * reach;
  }
  bool isAsLarge(const Transform& transform) const {
    return std::abs(sizeOf(transform) - sizeOf(first)) < kSamePlace * sizeOf(first);
  }
  const Transform& nearest(const std::vector<Transform>& places) const {
    const Transform* best = &places.front();
    for (const Transform& place : places)
      if (!isNear(place, *best) && distance(place, guide) < distance(*best, guide)) best = &place;
    return *best;
  }
  Transform placeBy(const Transform& transform) const {
    const Transform& place = nearest(stored);
    return isNear(transform, place) ? place : transform;
  }
  /// Where it is if the model has moved.
  Transform moved(const std::vector<Transform>& turned) const {
    std::vector<Transform> places = stored;
    places.insert(places.end(), turned.begin(), turned.end());
    const Transform& place = nearest(places);
    return isFloat && isAsLarge(place) ? place : placeBy(guide);
  }
};

Hold holdOf(const tinygltf::Model& model, const Skin& skin, const Instance& instance, Tree& tree) {
  const int position = attributeOf(instance.primitive, "POSITION");
  const std::vector<double> positions = decode(model, position, TINYGLTF_TYPE_VEC3, 3, instance.where + ".POSITION");
  Hold hold;
  hold.isFloat = model.accessors[static_cast<std::size_t>(position)].componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
  for (const double coordinate : positions) hold.reach = std::max(hold.reach, std::abs(coordinate));

  const std::vector<bool> holds = holdingJoints(model, instance, skin.joints.size(), positions.size() / 3);
  std::vector<Transform> holding;
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    if (holds[j] && sizeOf(skin.transforms[j]) > 0) holding.push_back(skin.transforms[j]);
  if (!holding.empty()) hold.first = holding.front();
  hold.guide = hold.first;
  // A joint that holds no vertex may have any matrix.
  if (!skin.joints.empty() && hold.isAsLarge(skin.transforms[skin.root])) hold.guide = skin.transforms[skin.root];
  hold.stored.emplace_back();
  for (const int node : tree.fixed(tree.upFrom(instance.node)))
    hold.stored.push_back(tree.worlds[static_cast<std::size_t>(node)]);
  hold.stored.insert(hold.stored.end(), skin.above.begin(), skin.above.end());
  for (const Transform& joint : holding) hold.isBound = hold.isBound && hold.isNear(joint, hold.first);
  hold.isTurned = isAligned(hold.guide);
  for (const Transform& place : hold.stored) hold.isTurned = hold.isTurned && cosineOf(place, hold.guide) < kTurned;
  return hold;
}

/// For each joint, from where it has moved a mesh to where the mesh is at rest.
/// @param places  The meshes with skins, where they are at rest.
std::map<int, Transform> waysBack(const std::vector<std::pair<const Skin*, Hold>>& skinned,
                                  const std::vector<Transform>& places) {
  std::map<int, Transform> back;
  for (std::size_t s = 0; s < skinned.size(); ++s) {
    const auto& [skin, hold] = skinned[s];
    for (std::size_t j = 0; j < skin->joints.size(); ++j) {
      const Transform& joint = skin->transforms[j];
      if (!(skin->isKnown[j] || j == skin->root) || !(std::abs(joint.determinant()) > 0)) continue;
      back.try_emplace(skin->joints[j], hold.isNear(joint, places[s]) ? Transform{} : places[s] * joint.inverse());
    }
  }
  return back;
}

}  // namespace

void placeMeshes(const tinygltf::Model& model, const std::vector<Transform>& worlds, std::vector<Instance>& instances) {
  Tree tree(model, worlds);
  std::map<int, Skin> skins;
  for (const Instance& instance : instances) {
    if (instance.skin < 0 || skins.count(instance.skin) != 0) continue;
    tree.addJoints(skins.emplace(instance.skin, readSkin(model, tree, instance.skin)).first->second.joints);
  }
  for (auto& [_, skin] : skins) findRoot(skin, tree);
  std::vector<std::pair<const Skin*, Hold>> skinned;
  std::vector<Transform> turned;
  bool isAtRest = true;
  for (const Instance& instance : instances) {
    if (instance.skin < 0) continue;
    const Skin& skin = skins.at(instance.skin);
    const Hold& hold = skinned.emplace_back(&skin, holdOf(model, skin, instance, tree)).second;
    if (hold.isTurned) turned.push_back(hold.guide);
    isAtRest = isAtRest && hold.isBound;
  }
  std::vector<Transform> places;
  places.reserve(skinned.size());
  for (const auto& [_, hold] : skinned) places.push_back(isAtRest ? hold.placeBy(hold.first) : hold.moved(turned));
  const std::map<int, Transform> back = isAtRest ? std::map<int, Transform>{} : waysBack(skinned, places);
  std::size_t next = 0;
  for (Instance& instance : instances) {
    if (instance.skin >= 0) {
      instance.world = places[next++];
    } else if (!back.empty()) {
      for (const int node : tree.upFrom(instance.node)) {
        const auto found = back.find(node);
        if (found == back.end()) continue;
        if (found->second != Transform{}) instance.world = found->second * instance.world;
        break;
      }
    }
  }
}

}  // namespace cagecast::gltf
