#include "mesh/kind.hpp"

#include <algorithm>

#include "mesh/part_names.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

namespace {

struct Box {
  Vec3 low, high;
};

Box boxOf(const MeshView& mesh) {
  Vec3 low = Vec3::from(&mesh.positions[std::size_t{3} * mesh.indices[0]]), high = low;
  for (const std::uint32_t v : mesh.indices) {
    const Vec3 p = Vec3::from(&mesh.positions[std::size_t{3} * v]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

template <class Names, class NameOf>
bool anyMatches(const Names& names, const NameOf& nameOf, std::initializer_list<std::string_view> patterns) {
  return std::any_of(names.begin(), names.end(), [&](const auto& entry) {
    return std::any_of(patterns.begin(), patterns.end(),
                       [&](std::string_view pattern) { return matchesName(nameOf(entry), pattern); });
  });
}

bool hasParts(const Model& model, std::initializer_list<std::string_view> patterns) {
  return anyMatches(
      model.parts, [](const std::string& name) { return std::string_view(name); }, patterns);
}

bool hasJoints(const Model& model, std::initializer_list<std::string_view> patterns) {
  return anyMatches(
      model.joints, [](const Joint& joint) { return std::string_view(joint.name); }, patterns);
}

/// Whether an open border as wide as a neck is at the bottom of a mesh.
bool isOpenBelow(const MeshView& mesh, const Box& box) {
  const TriangleMesh welded = weldExactly(mesh);
  const Vec3 size = box.high - box.low;
  const double across = std::min(size.x, size.z);
  for (const auto& loop : boundaryLoops(welded)) {
    Vec3 low = box.high, high = box.low;
    for (const std::uint32_t v : loop) {
      const Vec3& p = welded.positions[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const bool isWide = high.x - low.x > 0.3 * across && high.z - low.z > 0.3 * across;
    if (isWide && high.y < box.low.y + 0.35 * size.y) return true;
  }
  return false;
}

}  // namespace

Kind kindOf(const Model& model) {
  const Box box = boxOf(model.mesh);
  const Vec3 size = box.high - box.low;
  // Chibi figures are 2.2 times as tall as deep; heads with a neck 1.8 times.
  const double slender = size.y / std::max(size.z, 1e-9 * size.y);
  const bool hasLegs = hasJoints(model, {"*leg*", "*thigh*", "*foot*", "*calf*", "*shin*"});
  if (hasLegs && slender > 1.5) return Kind::body;
  const bool isCompact = slender > 0.6 && slender < 2.2 && size.x < 2.2 * size.y && size.x > 0.3 * size.y;
  const bool hasFace = hasParts(model, {"eye", "eyes", "*eyeball*", "teeth", "*tongue*", "*lash*", "*lashes"});
  const bool isCar = hasParts(model, {"*wheel*", "*tyre*", "*tire*", "window*", "windscreen*", "windshield*"});
  if (isCompact && !isCar && (hasFace || isOpenBelow(model.mesh, box))) return Kind::head;
  // Arms reach far to the sides in a T-pose, and less in an A-pose.
  if (slender > 2.8 && size.x > 0.2 * size.y && !isCar && (hasFace || size.x > 0.3 * size.y)) return Kind::body;
  return hasFace && !isCar && size.z < 2.5 * size.y ? Kind::head : Kind::prop;
}

}  // namespace cagecast::cages
