#include "landmarks/rig.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace cagecast::cages {

namespace {

enum Naming : std::size_t { kVrm, kMixamo, kRoblox, kVroid, kRigify, kNamings };

struct RigBone {
  std::string_view landmark;
  std::array<std::string_view, kNamings> names;
};

constexpr RigBone kBones[] = {
#define BONE(landmark, vrm, mixamo, roblox, vroid, rigify) {landmark, {vrm, mixamo, roblox, vroid, rigify}},
#include "landmarks/bones.def"
#undef BONE
};

/// Fewer named joints than this may be chance: many rigs have a "Head" and a "Neck".
constexpr std::size_t kMinNamed = 6;

/// Case, spaces and separators of names vary with the exporter.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

constexpr std::string_view kMixamoPrefix = "mixamorig";

/// The joint's own name: without the names of an armature or a namespace, without Rigify's prefixes, and without
/// Mixamo's, which may have a number.
std::string bareName(std::string_view name, bool& mixamo) {
  const std::size_t last = name.find_last_of("|:");
  std::string_view own = last == std::string_view::npos ? name : name.substr(last + 1);
  if (own.starts_with("DEF-") || own.starts_with("ORG-")) own.remove_prefix(4);
  std::string out = plain(own);
  mixamo = plain(name).find(kMixamoPrefix) != std::string::npos;
  if (out.starts_with(kMixamoPrefix)) {
    std::size_t length = kMixamoPrefix.size();
    while (length < out.size() && std::isdigit(static_cast<unsigned char>(out[length])) != 0) ++length;
    out.erase(0, length);
  }
  return out;
}

std::string replaced(std::string_view pattern, char what, std::string_view with) {
  std::string out;
  for (const char c : pattern) {
    if (c == what)
      out += with;
    else
      out += c;
  }
  return out;
}

/// Calls `visit(landmark, bone, side)` for each joint of each side.
template <typename Visit>
void forEachJoint(Visit visit) {
  for (const RigBone& bone : kBones) {
    const bool paired = bone.landmark.back() == '*';
    for (const std::string_view side : {std::string_view("left"), std::string_view("right")}) {
      visit("joint_" + replaced(bone.landmark, '*', "_" + std::string(side)), bone, side);
      if (!paired) break;
    }
  }
}

}  // namespace

std::vector<std::string> jointLandmarks() {
  std::vector<std::string> out;
  forEachJoint([&](const std::string& landmark, const RigBone&, std::string_view) { out.push_back(landmark); });
  return out;
}

Rig recogniseRig(const std::vector<Joint>& joints) {
  if (joints.empty()) return {};
  std::vector<std::string> names;
  bool anyMixamo = false;
  for (const Joint& joint : joints) {
    bool mixamo = false;
    names.push_back(bareName(joint.name, mixamo));
    anyMixamo = anyMixamo || mixamo;
  }
  std::array<std::vector<Landmark>, kNamings> found;
  forEachJoint([&](const std::string& landmark, const RigBone& bone, std::string_view side) {
    for (std::size_t naming = 0; naming < kNamings; ++naming) {
      const std::string wanted = plain(replaced(replaced(bone.names[naming], '#', side), '%', side.substr(0, 1)));
      const auto at = std::find(names.begin(), names.end(), wanted);
      if (wanted.empty() || at == names.end()) continue;
      found[naming].push_back({landmark, joints[static_cast<std::size_t>(at - names.begin())].position, 1});
    }
  });
  const auto most =
      std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (most->size() < kMinNamed) return {"unknown"};
  const auto naming = static_cast<std::size_t>(most - found.begin());
  const char* kNames[] = {"VRM", anyMixamo ? "Mixamo" : "Ready Player Me", "Roblox R15", "VRoid", "Rigify"};
  return {kNames[naming], std::move(*most)};
}

}  // namespace cagecast::cages
