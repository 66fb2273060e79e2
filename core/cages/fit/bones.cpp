#include "fit/steps.hpp"

#include <algorithm>
#include <cmath>

#include "fit/warp.hpp"
#include "mesh/limits.hpp"

namespace cagecast::cages {

namespace {

constexpr int kWeightSmoothings = 4;
/// Bones are at least this thick where weights are computed, in diagonals, so that weights stay finite.
constexpr double kThickness = 1e-3;
/// How far a bone at the end of a limb reaches, in lengths of the one before it.
constexpr double kHandLength = 0.7, kHeadLength = 2.0;

/// A bone's joints; without a second one it goes on like the bone that ends where it begins.
struct Link {
  const char* from;
  const char* to;
};
constexpr Link kTrunk[] = {{"hips", "spine"}, {"spine", "chest"}, {"chest", "neck"}, {"neck", "head"}};
constexpr Link kLimbs[] = {
    {"clavicle", "shoulder"}, {"shoulder", "elbow"}, {"elbow", "wrist"}, {"hip", "knee"}, {"knee", "ankle"}};

std::optional<Vec3> jointAt(const std::vector<Landmark>& landmarks, const std::string& name) {
  return placeOf(landmarks, "joint_" + name);
}

/// Turned by the smallest angle and stretched along its length.
Bone boneBetween(const Vec3& a, const Vec3& b, const Vec3& toA, const Vec3& toB) {
  const double size = length(b - a), toSize = length(toB - toA);
  const Vec3 direction = 1 / size * (b - a);
  const Similarity turn = shortestRotation(direction, 1 / toSize * (toB - toA));
  const double stretch = toSize / size;
  const auto image = [&](const Vec3& axis) {
    return turn.turned(axis + (stretch - 1) * dot(axis, direction) * direction);
  };
  Bone bone{a, b, {image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1})}};
  bone.map.translation = toA - bone.map(a);
  return bone;
}

/// Goes on beyond the end of a bone, turned like it but not stretched.
Bone boneBeyond(const Bone& before, double share, const Vec3& to) {
  const Vec3 along = before.to - before.from;
  Bone bone{before.to, before.to + share * along, shortestRotation(unit(along), unit(before.map.turned(along)))};
  bone.map.translation = to - bone.map(before.to);
  return bone;
}

/// The head as a whole, by its landmarks; nothing if there are too few.
std::optional<Bone> headBone(const std::vector<Landmark>& from, const std::vector<Landmark>& to) {
  static constexpr const char* kFace[] = {"nose", "eye_", "mouth",  "chin",   "crown",
                                          "ear_", "lip_", "nasion", "occiput"};
  std::vector<Vec3> a, b;
  for (const Landmark& landmark : from) {
    const bool onHead = std::any_of(std::begin(kFace), std::end(kFace),
                                    [&](const char* begin) { return landmark.name.starts_with(begin); });
    const auto there = placeOf(to, landmark.name);
    if (!onHead || !there) continue;
    a.push_back(positionOf(landmark));
    b.push_back(*there);
  }
  const auto joint = jointAt(from, "head"), toJoint = jointAt(to, "head");
  if (a.size() < 4 || !joint || !toJoint) return std::nullopt;
  return Bone{*joint, meanOf(a), fitSimilarity(a, b)};
}

std::vector<double> weightsAt(const Vec3& p, const std::vector<Bone>& bones, double thickness) {
  std::vector<double> weights;
  double total = 0;
  for (const Bone& bone : bones) {
    const double distance = std::max(distanceToSegment(p, bone.from, bone.to), thickness);
    weights.push_back(std::pow(distance, -6.0));
    total += weights.back();
  }
  for (double& weight : weights) weight /= total;
  return weights;
}

Vec3 blend(const Vec3& p, const std::vector<Bone>& bones, const std::vector<double>& weights) {
  Vec3 out{0, 0, 0};
  for (std::size_t i = 0; i < bones.size(); ++i) out = out + weights[i] * bones[i].map(p);
  return out;
}

double sizeOf(const std::vector<Bone>& bones) {
  double size = 0;
  for (const Bone& bone : bones) size += length(bone.to - bone.from);
  return size;
}

}  // namespace

std::vector<Bone> bonesOf(const std::vector<Landmark>& from, const std::vector<Landmark>& to) {
  std::vector<Bone> bones;
  const auto add = [&](const std::string& a, const std::string& b) -> bool {
    const auto fromA = jointAt(from, a), fromB = jointAt(from, b), toA = jointAt(to, a), toB = jointAt(to, b);
    if (!fromA || !fromB || !toA || !toB || !(length(*fromB - *fromA) > 0) || !(length(*toB - *toA) > 0)) return false;
    bones.push_back(boneBetween(*fromA, *fromB, *toA, *toB));
    return true;
  };
  const auto beyond = [&](const std::string& end, double share) {
    const auto at = jointAt(to, end);
    if (at) bones.push_back(boneBeyond(bones.back(), share, *at));
  };
  for (const Link& link : kTrunk) {
    const bool added = add(link.from, link.to);
    if (!added || std::string(link.to) != "head") continue;
    const std::optional<Bone> head = headBone(from, to);
    if (head)
      bones.push_back(*head);
    else
      beyond("head", kHeadLength);
  }
  for (const std::string side : {"_left", "_right"}) {
    for (const Link& link : kLimbs) {
      const bool added = add(link.from + side, link.to + side);
      if (added && std::string(link.to) == "wrist") beyond("wrist" + side, kHandLength);
    }
    add("hips", "hip" + side);
    // Feet keep their direction: joints do not tell how they are turned.
    const auto ankle = jointAt(from, "ankle" + side), toAnkle = jointAt(to, "ankle" + side);
    const auto toe = placeOf(from, "toe_big" + side);
    if (ankle && toAnkle && toe) {
      Bone foot{*ankle, *toe, {}};
      foot.map.translation = *toAnkle - *ankle;
      bones.push_back(foot);
    }
  }
  if (bones.size() < kMinBones) bones.clear();
  return bones;
}

Vec3 bend(const Vec3& point, const std::vector<Bone>& bones) {
  return blend(point, bones, weightsAt(point, bones, kThickness * sizeOf(bones)));
}

std::vector<Vec3> bend(const TemplateCage& cage, const std::vector<Bone>& bones) {
  std::vector<std::vector<double>> weights;
  for (const Vec3& p : cage.mesh.positions) weights.push_back(weightsAt(p, bones, kThickness * cage.diagonal));
  for (int round = 0; round < kWeightSmoothings; ++round) {
    std::vector<std::vector<double>> next = weights;
    for (std::size_t v = 0; v < weights.size(); ++v)
      for (const std::uint32_t u : cage.neighbours[v])
        for (std::size_t i = 0; i < bones.size(); ++i)
          next[v][i] += (weights[u][i] - weights[v][i]) / (1.0 + static_cast<double>(cage.neighbours[v].size()));
    weights = std::move(next);
  }
  std::vector<Vec3> out;
  for (std::size_t v = 0; v < weights.size(); ++v) out.push_back(blend(cage.mesh.positions[v], bones, weights[v]));
  return out;
}

}  // namespace cagecast::cages
