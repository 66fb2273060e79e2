#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <string_view>

#include "cagecast/status.hpp"
#include "input/fill_in.hpp"
#include "input/option_list.hpp"

namespace cagecast {

namespace {

constexpr const char* kCodeNames[] = {
#define CAGECAST_CODE(name, text, sentence) #name,
#define CAGECAST_CAGES_CODE(name, text, sentence) #name,
#include "cagecast/codes.def"
};

constexpr const char* kSentences[] = {
#define CAGECAST_CODE(name, text, sentence) sentence,
#include "cagecast/codes.def"
};

constexpr const char* kLockNames = "(automatic, keep, exclude)";

/// A number with seven significant digits, spelled as in JavaScript. printf would add 8 KB to the WebAssembly module.
std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  const std::string sign = value < 0 ? "-" : "";
  double digits = std::fabs(value);
  if (std::isinf(value)) return sign + "Infinity";
  if (digits == 0) return "0";
  int exponent = 6;  // value = digits · 10^(exponent − 6)
  for (; digits >= 1e7; ++exponent) digits /= 10;
  for (; digits < 1e6; --exponent) digits *= 10;
  auto rounded = static_cast<std::uint32_t>(std::lround(digits));
  if (rounded == 10'000'000) {
    rounded /= 10;
    ++exponent;
  }
  std::string text = std::to_string(rounded);
  if (exponent >= 7 || exponent < -6) {
    const auto last = text.find_last_not_of('0');
    text = text.substr(0, last + 1);
    if (last > 0) text.insert(1, ".");
    return sign + text + (exponent < 0 ? "e-" : "e+") + std::to_string(exponent < 0 ? -exponent : exponent);
  }
  if (exponent < 0) text.insert(0, static_cast<std::size_t>(-exponent), '0');
  const auto whole = static_cast<std::size_t>(exponent < 0 ? 1 : exponent + 1);
  const auto last = text.find_last_not_of('0');
  text = text.substr(0, last == std::string::npos || last < whole ? whole : last + 1);
  if (text.size() > whole) text.insert(whole, ".");
  return sign + text;
}

std::string spelled(float value) { return number(static_cast<double>(value)); }
std::string spelled(std::uint32_t value) { return std::to_string(value); }

std::string describeOption(const Status& status, const MeshView& target) {
  const std::string name = std::string("options.") + optionName(status.option);
  if (status.option == Option::vertexMasks || status.option == Option::triangleMasks) {
    const std::string at = std::to_string(status.at);
    if (status.value != 0)
      return name + "[" + at + "] = " + spelled(status.value) + " is not -1 (never), 0 or 1 (always)";
    const bool isOfVertices = status.option == Option::vertexMasks;
    const auto count = (isOfVertices ? target.positions.size() : target.indices.size()) / 3;
    return name + " has " + at + " entries, not 1 for each of " + std::to_string(count) +
           (isOfVertices ? " vertices" : " triangles") + " of target";
  }
  if (status.option == Option::locks) {
    const std::string at = std::to_string(status.at);
    if (status.value != 0) return name + "[" + at + "] = " + spelled(status.value) + " is not one of " + kLockNames;
    return name + "[" + at + "] is given, but there is no segment " + at;
  }
  if (status.option >= Option::ignoredParts && status.option <= Option::excludedParts) {
    if (status.value != 0) return name + " has all groups of target: nothing is left";
    return name + " has group " + std::to_string(status.at) + ", of which there is no vertex";
  }
  const std::string given = name + " = " + spelled(status.value);
  const OptionEntry* entry = findOption(status.option);
  if (entry == nullptr) return "options are not valid";
  if (entry->names != nullptr) return given + " is not one of " + entry->names;
  if (std::isinf(entry->high)) return given + " is not a number of at least " + number(entry->low);
  return given + " is not within " + number(entry->low) + ".." + number(entry->high);
}

/// " = " and the number at a place of an array; nothing if the array was not given.
template <typename Number>
std::string equals(std::span<const Number> values, std::size_t at) {
  return at < values.size() ? " = " + spelled(values[at]) : "";
}

/// What a name in braces stands for in a sentence.
std::string valueOf(std::string_view name, const Status& status, const MeshView& mesh) {
  const auto vertices = mesh.positions.size() / 3;
  if (name == "mesh") return argumentName(status.argument);
  if (name == "value") return spelled(status.value);
  if (name == "at") return std::to_string(status.at);
  if (name == "missing") return mesh.positions.empty() ? "vertices" : "triangles";
  if (name == "vertices") return std::to_string(vertices);
  if (name == "for vertices") return vertices > 0 ? " for " + std::to_string(vertices) + " vertices" : "";
  if (name == "of vertices") return vertices > 0 ? " (" + std::to_string(vertices) + " vertices)" : "";
  if (name == "triangles") return std::to_string(mesh.indices.size() / 3);
  if (name == "positions") return std::to_string(mesh.positions.size());
  if (name == "indices") return std::to_string(mesh.indices.size());
  if (name == "uvs") return std::to_string(mesh.uvs.size());
  if (name == "groups") return std::to_string(mesh.groups.size());
  if (name == "index at") return equals(mesh.indices, status.at);
  if (name == "most vertices") return std::to_string(kMaxVertices);
  if (name == "most triangles") return std::to_string(kMaxTriangles);
  return equals(name == "uv at" ? mesh.uvs : mesh.positions, status.at);
}

/// The sentence of a status, with names in braces.
const char* sentenceOf(const Status& status, const MeshView& mesh) {
  if (status.code == Code::tooLarge) {
    if (mesh.positions.size() / 3 > kMaxVertices) return "{mesh} has {vertices} vertices, more than {most vertices}";
    if (mesh.indices.size() / 3 > kMaxTriangles) return "{mesh} has {triangles} triangles, more than {most triangles}";
  }
  const auto i = static_cast<std::size_t>(status.code);
  return i < std::size(kSentences) ? kSentences[i] : "unknown";
}

}  // namespace

const char* codeName(Code code) noexcept {
  const auto i = static_cast<std::size_t>(code);
  return i < std::size(kCodeNames) ? kCodeNames[i] : "unknown";
}

const char* argumentName(Argument argument) noexcept {
  switch (argument) {
    case Argument::cage: return "cage";
    case Argument::target: return "target";
    case Argument::options: return "options";
    case Argument::model: return "model";
    case Argument::from: return "template";
    case Argument::landmarks: return "landmarks";
    default: return "";
  }
}

std::string describe(const Status& status, const MeshView& cage, const MeshView& target) {
  if (status.code == Code::badOption) return describeOption(status, target);
  const MeshView& mesh = status.argument == Argument::cage ? cage : target;
  return fillIn(sentenceOf(status, mesh), [&](std::string_view name) { return valueOf(name, status, mesh); });
}

}  // namespace cagecast
