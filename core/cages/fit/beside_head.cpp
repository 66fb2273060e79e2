#include <algorithm>

#include "fit/steps.hpp"
#include "landmarks/rig.hpp"
#include "mesh/part_names.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Words of names of clothes; a part that is called skin besides is none.
const std::vector<std::string>& clothes() {
  static const std::vector<std::string> kWords = {
      "outfit*",  "cloth*",  "shirt*",   "tshirt*", "tops",    "jacket*", "coat",    "suit",
      "dress",    "pants*",  "trouser*", "jeans*",  "shorts*", "skirt*",  "shoe*",   "boot*",
      "foot?ear", "sock*",   "glove*",   "tie",     "collar*", "scarf*",  "hoodie*", "sweater*",
      "vest",     "blouse*", "uniform",  "armo?r*", "cape",    "robe*",   "belt*"};
  return kWords;
}

/// What is known of a part, in shares of its area.
struct PartAreas {
  double all = 0, below = 0;
  double bound = 0, held = 0;  ///< By joints, and by those of head and neck.
};

}  // namespace

std::vector<std::uint32_t> partsBesideHead(const Model& model, const TriangleMesh& skin,
                                           const std::vector<std::uint32_t>& triangleOf,
                                           const std::vector<bool>& isBelow, const std::vector<Landmark>& landmarks) {
  constexpr double kMostlyBelow = 0.9;
  const auto& indices = model.mesh.indices;
  const auto& groups = model.mesh.groups;
  std::vector<std::uint32_t> out;
  std::vector<PartAreas> areas(model.parts.size());
  if (groups.empty() || areas.empty()) return out;
  const Rig rig = recogniseRig(model.joints);
  const bool hasHead = std::find(rig.isHead.begin(), rig.isHead.end(), true) != rig.isHead.end();
  const auto jointAt = [&](std::size_t corner) {
    return hasHead && !model.vertexJoints.empty() ? model.vertexJoints[indices[corner]] : kNoJoint;
  };
  const auto partOf = [&](std::size_t t) { return groups[indices[3 * std::size_t{triangleOf[t]}]]; };
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const double area = length(areaNormal(skin, skin.triangles[t]));
    const std::size_t first = 3 * std::size_t{triangleOf[t]};
    if (partOf(t) >= areas.size()) continue;
    PartAreas& part = areas[partOf(t)];
    part.all += area;
    if (isBelow[t]) part.below += area;
    const std::uint16_t joints[] = {jointAt(first), jointAt(first + 1), jointAt(first + 2)};
    const auto isHeld = [&](std::uint16_t joint) { return joint != kNoJoint && rig.isNeck[joint]; };
    if (joints[0] != kNoJoint) part.bound += area;
    if (std::any_of(std::begin(joints), std::end(joints), isHeld)) part.held += area;
  }
  std::vector<Vec3> spots;
  for (const Landmark& landmark : landmarks)
    if (isOfFace(landmark.name)) spots.push_back(positionOf(landmark));
  std::vector<bool> hasFace(areas.size());
  for (const SurfacePoint& point : Surface(skin).closest(spots))
    if (const std::uint32_t part = partOf(point.triangle); part < areas.size()) hasFace[part] = true;
  const std::vector<bool> isCloth = matchingParts(model.parts, clothes());
  const std::vector<bool> isSkin = matchingParts(model.parts, {"skin"});
  const std::vector<bool> isBody = matchingParts(model.parts, {"body", "head", "neck"});
  for (std::uint32_t p = 0; p < areas.size(); ++p) {
    const PartAreas& part = areas[p];
    if (hasFace[p] || !(part.all > 0)) continue;
    const bool isBeyond = part.below > kMostlyBelow * part.all && !isSkin[p] && !isBody[p];
    if ((isCloth[p] && !isSkin[p]) || (part.bound > 0 && !(part.held > 0)) || isBeyond) out.push_back(p);
  }
  return out;
}

}  // namespace cagecast::cages
