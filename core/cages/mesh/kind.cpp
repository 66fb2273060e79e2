#include "mesh/kind.hpp"

#include <algorithm>

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
  const Vec3 margin = 0.05 * box.size();
  const Vec3 low = box.low - margin, high = box.high + margin;
  return std::any_of(model.joints.begin(), model.joints.end(), [&](const Joint& joint) {
    const Vec3 p = Vec3::from(joint.position.data());
    const bool isInside =
        p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
    if (!isInside) return false;
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

}  // namespace

Kind kindOf(const Model& model) {
  const Bounds box = boundsOf(model.mesh);
  const Vec3 size = box.size();
  // Chibi figures are 2.2 times as tall as deep; heads with a neck 1.8 times.
  const double slender = size.y / std::max(size.z, 1e-9 * size.y);
  if (hasLegs(model, box)) return slender > 1.5 ? Kind::body : Kind::prop;  // On all fours, seams are those of props.
  const bool isCompact = slender > 0.6 && slender < 2.2 && size.x < 2.2 * size.y && size.x > 0.3 * size.y;
  const bool hasFace = hasParts(model, {"eye", "eyes", "*eyeball*", "teeth", "*tongue*", "*lash*", "*lashes"});
  const bool isCar = hasParts(model, {"*wheel*", "*tyre*", "*tire*", "window*", "windscreen*", "windshield*"});
  if (isCompact && !isCar && (hasFace || isOpenBelow(model.mesh, box))) return Kind::head;
  // Arms reach far to the sides in a T-pose, and less in an A-pose.
  if (slender > 2.8 && size.x > 0.2 * size.y && !isCar && (hasFace || size.x > 0.3 * size.y)) return Kind::body;
  return hasFace && !isCar && size.z < 2.5 * size.y ? Kind::head : Kind::prop;
}

}  // namespace cagecast::cages
