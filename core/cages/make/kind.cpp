#include "make/steps.hpp"

#include <algorithm>
#include <cmath>

#include "landmarks/landmark_list.hpp"
#include "landmarks/rig.hpp"
#include "mesh/bounds.hpp"
#include "mesh/part_names.hpp"

namespace cagecast::cages {

namespace {

bool hasParts(const Model& model, std::initializer_list<std::string_view> patterns) {
  return std::any_of(model.parts.begin(), model.parts.end(), [&](const std::string& name) {
    return std::any_of(patterns.begin(), patterns.end(),
                       [&](std::string_view pattern) { return matchesName(name, pattern); });
  });
}

/// Whether a leg's joint is inside the box: the legs of a rig may belong to a body that is not there.
bool hasLegs(const Model& model, const Bounds& box) {
  const Bounds around{box.low - 0.05 * box.size(), box.high + 0.05 * box.size()};
  return std::any_of(model.joints.begin(), model.joints.end(), [&](const Joint& joint) {
    if (around.distance(Vec3::from(joint.position.data())) > 0) return false;
    for (const std::string_view pattern : {"*leg*", "*thigh*", "*foot*", "*calf*", "*shin*"})
      if (matchesName(joint.name, pattern)) return true;
    return false;
  });
}

/// Whether an open border as wide as a neck is at the bottom of a mesh.
bool isOpenBelow(const MeshView& mesh, const Bounds& box) {
  const TriangleMesh welded = weldExactly(mesh);
  const Vec3 size = box.size();
  const double across = std::min(size.x, size.z);
  for (const auto& loop : boundaryLoops(welded)) {
    const Bounds border = boundsOf(welded, loop);
    const bool isWide = border.size().x > 0.3 * across && border.size().z > 0.3 * across;
    if (isWide && border.high.y < box.low.y + 0.35 * size.y) return true;
  }
  return false;
}

/// The axis of the file that a direction is closest to.
Vec3 axisOf(const Vec3& direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
  if (y >= x && y >= z) return {0, std::copysign(1.0, direction.y), 0};
  return x >= z ? Vec3{std::copysign(1.0, direction.x), 0, 0} : Vec3{0, 0, std::copysign(1.0, direction.z)};
}

/// What tells the kind of a model.
struct KindFeatures {
  double width = 0, height = 0, depth = 0;
  double slender = 0;  ///< Height by depth. Chibi figures are 2.2 times as tall as deep; heads with a neck 1.8 times.
  bool isCompact = false, isCar = false, isLegged = false;
};

KindFeatures featuresOf(const Model& model) {
  const Bounds box = boundsOf(model.mesh);
  const auto [up, front] = stanceOf(model);
  const Vec3 size = box.size(), side = cross(up, front);
  const auto along = [&](const Vec3& axis) { return std::abs(dot(axis, size)); };
  KindFeatures features{along(side), along(up), along(front)};
  features.slender = features.height / std::max(features.depth, 1e-9 * features.height);
  features.isCompact = features.slender > 0.6 && features.slender < 2.2 && features.width < 2.2 * features.height &&
                       features.width > 0.3 * features.height;
  features.isCar = isVehicle(model.parts);
  features.isLegged = hasLegs(model, box);
  return features;
}

}  // namespace

Stance stanceOf(const Model& model) {
  const Rig rig = recogniseRig(model.joints);
  const auto at = [&](const char* name) { return placeOf(rig.joints, name); };
  const auto hips = at("joint_hips"), head = at("joint_head"), neck = at("joint_neck");
  const auto left = at("joint_ankle_left"), right = at("joint_ankle_right");
  if (!hips || !(head || neck) || !left || !right) return {};
  const Vec3 trunk = unit(head.value_or(neck.value_or(*hips)) - *hips);
  const Vec3 legs = unit(*hips - 0.5 * (*left + *right));
  constexpr double kStraight = 0.8;  // The cosine of 37°: who sits or is on all fours does not stand.
  if (dot(trunk, legs) < kStraight) return {};
  Stance stance;
  stance.up = axisOf(trunk);
  if (stance.up.y != 0) return {};
  const Vec3 apart = *left - *right;
  const Vec3 side = axisOf(apart - dot(apart, stance.up) * stance.up);
  stance.front = cross(side, stance.up);
  return length(stance.front) > 0.5 ? stance : Stance{};
}

Kind kindOf(const Model& model) {
  const KindFeatures features = featuresOf(model);
  if (features.isLegged)
    return features.slender > 1.5 ? Kind::body : Kind::prop;  // On all fours, seams are those of props.
  const bool hasFace = hasParts(model, {"eye", "eyes", "*eyeball*", "teeth", "*tongue*", "*lash*", "*lashes"});
  if (features.isCompact && !features.isCar && (hasFace || isOpenBelow(model.mesh, boundsOf(model.mesh))))
    return Kind::head;
  // Arms reach far to the sides in a T-pose, and less in an A-pose.
  const double span = features.width / features.height;
  if (features.slender > 2.8 && span > 0.2 && !features.isCar && (hasFace || span > 0.3)) return Kind::body;
  return hasFace && !features.isCar && features.depth < 2.5 * features.height ? Kind::head : Kind::prop;
}

bool isCompactProp(const Model& model) {
  const KindFeatures features = featuresOf(model);
  return features.isCompact && !features.isCar && !features.isLegged && kindOf(model) == Kind::prop;
}

}  // namespace cagecast::cages
