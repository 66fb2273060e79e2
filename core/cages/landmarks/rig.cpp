#include "landmarks/rig.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <string_view>

namespace cagecast::cages {

namespace {

enum Naming : std::size_t { kVrm, kMixamo, kRoblox, kVroid, kRigify, kNamings };

struct RigBone {
  std::string_view landmark;
  std::array<std::string_view, kNamings> names;
  std::string_view words;  ///< Of other rigs, with "|" between them.
};

constexpr RigBone kBones[] = {
#define BONE(landmark, vrm, mixamo, roblox, vroid, rigify, words) \
  {landmark, {vrm, mixamo, roblox, vroid, rigify}, words},
#include "landmarks/bones.def"
#undef BONE
};

/// Fewer named joints than this may be chance: many rigs have a "Head" and a "Neck".
constexpr std::size_t kMinNamed = 6;
/// Words say less than a naming that is known: they have to name so many more joints than it does.
constexpr std::size_t kClearlyMore = 2;
/// What nearly all names have is the exporter's, in per cent of them.
constexpr std::size_t kNearlyAll = 80;

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

/// A landmark, and its place in the list of joints.
struct RigJoint {
  std::string landmark;
  std::size_t joint = 0;
};

/// A joint's name without its side, in lower case.
struct SidedName {
  std::string_view side;  ///< "left", "right", or empty.
  std::string rest;
};

/// The words of a name: they end at separators and before capitals; numbers belong to the word before them.
std::vector<std::string> lowerWords(std::string_view name) {
  std::vector<std::string> out(1);
  char last = 0;
  for (const char c : name) {
    const auto code = static_cast<unsigned char>(c);
    const bool isLetter = code >= 0x80 || std::isalnum(code) != 0;
    if (!isLetter || (std::isupper(code) != 0 && std::islower(static_cast<unsigned char>(last)) != 0))
      out.emplace_back();
    if (isLetter) out.back() += static_cast<char>(code < 0x80 ? std::tolower(code) : code);
    last = c;
  }
  std::erase(out, "");
  return out;
}

std::string_view sideOf(std::string_view word) {
  if (word == "l" || word == "left" || word == "左") return "left";
  return word == "r" || word == "right" || word == "右" ? "right" : "";
}

/// Names without the numbers that an exporter gave to nearly all of them: "DEF-head_051".
std::vector<std::string> withoutNumbers(const std::vector<Joint>& joints) {
  std::vector<std::string> all, cut;
  std::size_t numbered = 0;
  for (const Joint& joint : joints) {
    const std::size_t end = joint.name.find_last_not_of("0123456789");
    const bool isNumbered = end != std::string::npos && end + 1 < joint.name.size() && joint.name[end] == '_';
    all.push_back(joint.name);
    cut.push_back(isNumbered ? joint.name.substr(0, end) : joint.name);
    numbered += isNumbered ? 1 : 0;
  }
  return 100 * numbered >= kNearlyAll * joints.size() ? cut : all;
}

/// Splits names into their side and what is left of them, without words that nearly all names begin with, such as those
/// of an armature.
std::vector<SidedName> sidedNames(const std::vector<std::string>& names) {
  std::vector<std::vector<std::string>> all;
  all.reserve(names.size());
  for (const std::string& name : names) all.push_back(lowerWords(name));
  std::map<std::string, std::size_t> counts;
  for (const auto& words : all)
    for (const std::string& word : std::set<std::string>(words.begin(), words.end())) ++counts[word];
  std::vector<SidedName> out;
  for (const auto& words : all) {
    SidedName name;
    for (const std::string& word : words) {
      const bool isCommon = 100 * counts[word] >= kNearlyAll * all.size() && words.size() > 1;
      const bool isPrefix = name.rest.empty() && (isCommon || word == "c");  // "c" is the centre.
      std::string_view rest = word;
      if (isPrefix) continue;
      for (const std::string_view begin : {"left", "right", "左", "右"})
        if (name.side.empty() && rest.starts_with(begin)) {
          name.side = sideOf(begin);
          rest.remove_prefix(begin.size());
        }
      if (name.side.empty() && !sideOf(rest).empty())
        name.side = sideOf(rest);
      else
        name.rest += rest;
    }
    out.push_back(std::move(name));
  }
  return out;
}

/// The joint of a side that has one of some words for a name, of the first word that any has: with or without a number.
std::size_t findByWords(const std::vector<SidedName>& names, std::string_view words, std::string_view side,
                        const std::vector<bool>& isTaken) {
  while (!words.empty()) {
    const std::size_t end = words.find('|');
    const std::string_view word = words.substr(0, end);
    for (const bool numbered : {false, true})
      for (std::size_t j = 0; j < names.size(); ++j) {
        std::string_view rest = names[j].rest;
        if (isTaken[j] || names[j].side != side || !rest.starts_with(word)) continue;
        rest.remove_prefix(word.size());
        if (rest == "m") rest = "";  // The middle, between "_L" and "_R".
        const bool isNumber = std::all_of(rest.begin(), rest.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (rest.empty() || (numbered && isNumber)) return j;
      }
    words = end == std::string_view::npos ? "" : words.substr(end + 1);
  }
  return names.size();
}

/// The joints of a rig that has names of its own, by the words in them.
std::vector<RigJoint> jointsByWords(const std::vector<SidedName>& names) {
  std::vector<bool> isTaken(names.size());
  std::vector<RigJoint> out;
  forEachJoint([&](const std::string& landmark, const RigBone& bone, std::string_view side) {
    const bool isPaired = bone.landmark.back() == '*';
    const std::size_t j = findByWords(names, bone.words, isPaired ? side : "", isTaken);
    if (j == names.size()) return;
    isTaken[j] = true;
    out.push_back({landmark, j});
  });
  return out;
}

/// Whether each joint is a certain one, or below it.
std::vector<bool> belowJoint(const std::vector<Joint>& joints, std::size_t root) {
  std::vector<bool> out(joints.size()), isKnown(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    // Up to the head or to what is known, which a circle of parents is, too, once it is passed.
    std::vector<std::size_t> path;
    auto at = static_cast<std::int64_t>(j);
    for (; at >= 0 && !isKnown[static_cast<std::size_t>(at)]; at = joints[path.back()].parent) {
      path.push_back(static_cast<std::size_t>(at));
      isKnown[path.back()] = true;
      if (path.back() == root) break;
    }
    const bool isBelow = at >= 0 && (static_cast<std::size_t>(at) == root || out[static_cast<std::size_t>(at)]);
    for (const std::size_t joint : path) out[joint] = isBelow;
  }
  return out;
}

}  // namespace

std::vector<std::string> jointLandmarks() {
  std::vector<std::string> out;
  forEachJoint([&](const std::string& landmark, const RigBone&, std::string_view) { out.push_back(landmark); });
  return out;
}

Rig recogniseRig(const std::vector<Joint>& joints) {
  if (joints.empty()) return {};
  const std::vector<std::string> own = withoutNumbers(joints);
  std::vector<std::string> names;
  bool anyMixamo = false;
  for (const std::string& name : own) {
    bool mixamo = false;
    names.push_back(bareName(name, mixamo));
    anyMixamo = anyMixamo || mixamo;
  }
  std::array<std::vector<RigJoint>, kNamings> found;
  forEachJoint([&](const std::string& landmark, const RigBone& bone, std::string_view side) {
    for (std::size_t naming = 0; naming < kNamings; ++naming) {
      const std::string wanted = plain(replaced(replaced(bone.names[naming], '#', side), '%', side.substr(0, 1)));
      const auto at = std::find(names.begin(), names.end(), wanted);
      if (!wanted.empty() && at != names.end())
        found[naming].push_back({landmark, static_cast<std::size_t>(at - names.begin())});
    }
  });
  const auto most =
      std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const char* kNames[] = {"VRM", anyMixamo ? "Mixamo" : "Ready Player Me", "Roblox R15", "VRoid", "Rigify"};
  Rig rig{kNames[most - found.begin()]};
  std::vector<RigJoint> best = std::move(*most);
  const std::vector<SidedName> sided = sidedNames(own);
  const std::size_t head = findByWords(sided, "head|頭", "", std::vector<bool>(sided.size()));
  rig.isNeck = rig.isHead = belowJoint(joints, head);
  if (std::vector<RigJoint> others = jointsByWords(sided); others.size() > best.size() + kClearlyMore) {
    best = std::move(others);
    rig.name = "other";
  }
  if (best.size() < kMinNamed) {
    rig.name = "unknown";
    return rig;
  }
  for (const RigJoint& one : best) {
    rig.joints.push_back({one.landmark, joints[one.joint].position, 1});
    if (one.landmark != "joint_neck") continue;
    const std::vector<bool> isNeck = belowJoint(joints, one.joint);
    for (std::size_t j = 0; j < joints.size(); ++j) rig.isNeck[j] = rig.isNeck[j] || isNeck[j];
  }
  return rig;
}

}  // namespace cagecast::cages
