#include "landmarks/parts.hpp"

#include <algorithm>
#include <cctype>
#include <string>

#include "landmarks/landmark_list.hpp"
#include "mesh/part_names.hpp"

namespace cagecast::cages {

namespace {

bool contains(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

}  // namespace

Role roleOf(std::string_view partName) {
  std::string name;
  for (const char c : partName) name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (contains(name, {"lash", "brow", "hair", "beard", "moustache", "mustache", "glasses", "eyewear", "eyeline",
                      "eye_line", "eyeshadow", "headwear", "helmet", "afro", "bob0", "ponytail"}))
    return Role::cover;
  for (const std::string_view hat : {"hat", "hats", "beanie"})
    if (matchesName(partName, hat)) return Role::cover;
  if (contains(name, {"teeth", "tooth", "tongue", "gum"})) return Role::mouth;
  if (contains(name, {"eyelid", "eye_lid", "eyesocket"})) return Role::surface;
  if (matchesName(name, "high-poly") || matchesName(name, "*.high-poly")) return Role::eye;  // MakeHuman's.
  if (contains(name, {"eye", "iris", "pupil", "cornea", "sclera"})) return Role::eye;
  return Role::surface;
}

bool Figure::has(Role role) const { return std::find(roles.begin(), roles.end(), role) != roles.end(); }

TriangleMesh Figure::only(Role first, Role second) const {
  std::vector<bool> keep(roles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = roles[t] == first || roles[t] == second;
  return subset(mesh, keep);
}

Figure readFigure(const Model& model) {
  Figure out;
  std::vector<std::uint32_t> triangleOf;
  out.mesh = weldExactly(model.mesh, nullptr, &triangleOf);
  std::vector<Role> partRoles;
  for (const std::string& part : model.parts) partRoles.push_back(roleOf(part));
  for (const std::uint32_t t : triangleOf) {
    Role role = Role::surface;
    if (!model.mesh.groups.empty()) {
      const std::uint32_t part = model.mesh.groups[model.mesh.indices[3 * std::size_t{t}]];
      if (part < partRoles.size()) role = partRoles[part];
    }
    out.roles.push_back(role);
  }
  // A file whose only part is called "Eyeball" is a model of an eyeball.
  if (!out.has(Role::surface)) std::fill(out.roles.begin(), out.roles.end(), Role::surface);
  out.components = connectedPieces(out.mesh, out.componentCount);
  out.triangleOf = std::move(triangleOf);
  out.rig = recogniseRig(model.joints);
  if (const auto left = leftOf(out.rig.joints)) out.front = cross(*left, {0, 1, 0});
  return out;
}

Figure headOf(const Figure& figure, const Model& model) {
  if (model.vertexJoints.empty()) return figure;
  Figure out;
  const auto isHeld = [&](std::size_t corner) {
    const std::uint16_t joint = model.vertexJoints[model.mesh.indices[corner]];
    return joint != kNoJoint && figure.rig.isHead[joint];
  };
  std::vector<bool> keep(figure.roles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const std::size_t first = 3 * std::size_t{figure.triangleOf[t]};
    const bool isOfHead = figure.roles[t] == Role::eye || figure.roles[t] == Role::mouth;
    keep[t] = isOfHead || (isHeld(first) && isHeld(first + 1) && isHeld(first + 2));
    if (!keep[t]) continue;
    out.roles.push_back(figure.roles[t]);
    out.triangleOf.push_back(figure.triangleOf[t]);
  }
  if (!out.has(Role::surface)) return figure;
  out.mesh = subset(figure.mesh, keep);
  out.components = connectedPieces(out.mesh, out.componentCount);
  out.rig = figure.rig;
  out.front = figure.front;
  return out;
}

}  // namespace cagecast::cages
