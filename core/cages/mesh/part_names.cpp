#include "mesh/part_names.hpp"

#include <algorithm>

namespace cagecast::cages {

namespace {

bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }
/// Bytes of other alphabets, in UTF-8, count as letters.
bool isLetter(char c) { return isUpper(c) || (c >= 'a' && c <= 'z') || (static_cast<unsigned char>(c) & 0x80u) != 0; }
char lower(char c) { return isUpper(c) ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

bool matches(std::string_view text, std::string_view pattern) noexcept {
  // Only the last star can have to take more: what stands before it has found its first place already.
  std::size_t n = 0, p = 0, star = std::string_view::npos, resume = 0;
  while (n < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || lower(pattern[p]) == lower(text[n]))) {
      ++n;
      ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// Whether "light" before a word is no lamp: "LightBlue".
bool isColour(std::string_view word) {
  static constexpr const char* kColours[] = {"blue",   "brown", "red",   "green", "gr?y",   "yellow", "orange",
                                             "purple", "pink",  "beige", "wood",  "metal",  "skin",   "white",
                                             "black",  "cyan",  "stone", "teal",  "violet", "tan"};
  return std::any_of(std::begin(kColours), std::end(kColours), [&](const char* one) { return matches(word, one); });
}

std::vector<std::string_view> wordsOf(std::string_view name) {
  std::vector<std::string_view> words;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= name.size(); ++i) {
    const bool goesOn =
        i < name.size() && isLetter(name[i]) && !(i > start && isUpper(name[i]) && !isUpper(name[i - 1]));
    if (goesOn) continue;
    if (i > start) words.push_back(name.substr(start, i - start));
    start = i < name.size() && isLetter(name[i]) ? i : i + 1;
  }
  return words;
}

bool matchesName(std::string_view name, std::string_view pattern) {
  if (matches(name, pattern)) return true;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    if (matches(name.substr(begin, end - begin), pattern)) return true;
    begin = end + 1;
  }
  const std::vector<std::string_view> words = wordsOf(name);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool isShade = i + 1 < words.size() && matches(words[i], "light") && isColour(words[i + 1]);
    if (!isShade && matches(words[i], pattern)) return true;
  }
  return false;
}

std::vector<bool> trianglesOf(const MeshView& mesh, const std::vector<bool>& isMatch) {
  std::vector<bool> out(mesh.indices.size() / 3, false);
  if (mesh.groups.empty()) return out;
  for (std::size_t t = 0; t < out.size(); ++t) {
    const std::uint32_t group = mesh.groups[mesh.indices[3 * t]];
    out[t] = group < isMatch.size() && isMatch[group];
  }
  return out;
}

std::vector<bool> matchingParts(const std::vector<std::string>& parts, const std::vector<std::string>& patterns) {
  std::vector<bool> out(parts.size(), false);
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (const std::string& pattern : patterns) out[i] = out[i] || matchesName(parts[i], pattern);
  return out;
}

/// Whether each part is named as one that only vehicles have.
std::vector<bool> vehicleParts(const std::vector<std::string>& parts) {
  static const std::vector<std::string> kVehicles = {"window*", "windscreen*", "windshield*", "wheel*",
                                                     "tyre*",   "tire*",       "headlight*",  "taillight*",
                                                     "lamp*",   "grille*",     "dashboard*",  "steering*"};
  return matchingParts(parts, kVehicles);
}

bool isVehicle(const std::vector<std::string>& parts) {
  const std::vector<bool> own = vehicleParts(parts);
  return std::find(own.begin(), own.end(), true) != own.end();
}

std::vector<bool> excludedByName(const std::vector<std::string>& parts) {
  static const std::vector<std::string> kFaces = {
      // `eye` is a word of its own: lids are skin.
      "eye", "eyes", "eyeball*", "eyelash*", "eyebrow*", "eyeline*", "lash*", "brow", "brows", "iris*", "pupil*",
      "cornea*", "sclera*", "teeth*", "tooth*", "tongue*", "gum", "gums", "mouth*", "hair*", "beard*", "moustache*",
      "mustache*", "glass*", "goggles*",
      // MakeHuman's hair and eyes.
      "afro*", "*bob0?", "ponytail*", "high-poly", "*.high-poly"};
  // A tone of skin may be light, and a chair is a seat.
  static const std::vector<std::string> kOnVehicles = {"rim",   "rims",      "light",   "lights",
                                                       "seat*", "interior*", "lining*", "floor*"};
  std::vector<bool> out = matchingParts(parts, kFaces);
  const std::vector<bool> ofVehicle = vehicleParts(parts), onVehicle = matchingParts(parts, kOnVehicles);
  const bool isOne = isVehicle(parts);
  for (std::size_t p = 0; p < parts.size(); ++p) out[p] = out[p] || ofVehicle[p] || (isOne && onVehicle[p]);
  return out;
}

std::vector<bool> trianglesIn(const MeshView& mesh, std::span<const std::uint32_t> groups) {
  std::vector<std::uint32_t> sorted(groups.begin(), groups.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> out(mesh.indices.size() / 3, false);
  for (std::size_t t = 0; t < out.size() && !sorted.empty(); ++t) {
    const std::uint32_t group = mesh.groups.empty() ? 0 : mesh.groups[mesh.indices[3 * t]];
    out[t] = std::binary_search(sorted.begin(), sorted.end(), group);
  }
  return out;
}

std::vector<bool> excludedTriangles(const Model& model, const Parts& parts) {
  std::vector<bool> out = trianglesOf(model.mesh, excludedByName(model.parts));
  const std::vector<bool> isExcluded = trianglesIn(model.mesh, parts.exclude);
  const std::vector<bool> isKept = trianglesIn(model.mesh, parts.keep);
  for (std::size_t t = 0; t < out.size(); ++t) out[t] = !isKept[t] && (out[t] || isExcluded[t]);
  return out;
}

Status checkParts(const Model& model, const Parts& parts) noexcept {
  const std::span<const std::uint32_t> all = model.mesh.groups;
  const std::uint32_t last = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
  for (const auto& [option, groups] : {std::pair{Option::ignoredParts, parts.ignore},
                                       {Option::keptParts, parts.keep},
                                       {Option::excludedParts, parts.exclude}}) {
    for (const std::uint32_t group : groups)
      if (group > last) return {Code::badOption, Argument::options, group, option};
  }
  return {};
}

WithoutParts::WithoutParts(const Model& model, std::span<const std::uint32_t> groups) : model_(model) {
  if (groups.empty()) return;
  const std::vector<bool> isIgnored = trianglesIn(model.mesh, groups);
  for (std::size_t t = 0; t < isIgnored.size(); ++t) {
    if (isIgnored[t]) continue;
    const auto corners = model.mesh.indices.subspan(3 * t, 3);
    indices_.insert(indices_.end(), corners.begin(), corners.end());
    if (!model.marks.empty()) marks_.push_back(model.marks[t]);
  }
  model_.mesh.indices = indices_;
  model_.marks = marks_;
}

}  // namespace cagecast::cages
