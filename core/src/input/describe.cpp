#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>

#include "cagecast/status.hpp"
#include "input/option_list.hpp"

namespace cagecast {

namespace {

constexpr const char* kCodeNames[] = {
#define CAGECAST_CODE(name, text) #name,
#include "cagecast/codes.def"
};

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
  auto rounded = static_cast<std::uint32_t>(digits + 0.5);
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

std::string describeOption(const Status& status) {
  const std::string name = std::string("options.") + optionName(status.option);
  if (status.option == Option::segmentLocks || status.option == Option::groupLocks) {
    const bool isGroup = status.option == Option::groupLocks;
    return name + "[" + std::to_string(status.at) + "] is given, but there is no " +
           (isGroup ? "segment of group " : "segment ") + std::to_string(status.at);
  }
  const std::string given = name + " = " + number(static_cast<double>(status.value));
  const OptionEntry* entry = findOption(status.option);
  if (entry == nullptr) return "options are not valid";
  if (entry->names != nullptr) return given + " is not one of " + entry->names;
  if (std::isinf(entry->high)) return given + " is not a number of at least " + number(entry->low);
  return given + " is not within " + number(entry->low) + ".." + number(entry->high);
}

}  // namespace

const char* codeName(Code code) noexcept {
  const auto i = static_cast<std::size_t>(code);
  return i < std::size(kCodeNames) ? kCodeNames[i] : "unknown";
}

std::string describe(const Status& status, const MeshView& cage, const MeshView& target) {
  const bool isCage = status.argument == Argument::cage;
  const MeshView& mesh = isCage ? cage : target;
  const std::string name = isCage ? "cage" : "target";
  const std::string at = "[" + std::to_string(status.at) + "]";
  const std::string vertices = std::to_string(mesh.positions.size() / 3) + " vertices";
  switch (status.code) {
    case Code::ok: return "ok";
    case Code::emptyMesh:
      return name + (mesh.positions.empty() ? " has no vertices" : " has no triangles") + "; at least one is needed";
    case Code::positionsNotTriples:
      return name + ".positions has " + std::to_string(mesh.positions.size()) + " numbers, not 3 per vertex";
    case Code::indicesNotTriples:
      return name + ".indices has " + std::to_string(mesh.indices.size()) + " entries, not 3 per triangle";
    case Code::missingUvs: return name + ".uvs is missing: the texture is drawn in the cage's UVs, 2 per vertex";
    case Code::uvCountMismatch:
      return name + ".uvs has " + std::to_string(mesh.uvs.size()) + " numbers, not 2 for each of " + vertices;
    case Code::groupCountMismatch:
      return name + ".groups has " + std::to_string(mesh.groups.size()) + " entries, not 1 for each of " + vertices;
    case Code::cornerUvCountMismatch:
      return "cornerUvs does not have 2 numbers for each of " + std::to_string(mesh.indices.size()) + " indices";
    case Code::indexOutOfRange:
      return name + ".indices" + at + " = " + std::to_string(mesh.indices[status.at]) + " is out of range (" +
             vertices + ")";
    case Code::nonFinitePosition:
      return name + ".positions" + at + " = " + number(static_cast<double>(mesh.positions[status.at])) +
             " is not a finite number";
    case Code::nonFiniteUv:
      return name + ".uvs" + at + " = " + number(static_cast<double>(mesh.uvs[status.at])) + " is not a finite number";
    case Code::noUsableCageTriangle: return "cage has no triangle with an area";
    case Code::tooLarge:
      if (mesh.positions.size() / 3 > kMaxVertices)
        return name + " has " + vertices + ", more than " + std::to_string(kMaxVertices);
      if (mesh.indices.size() / 3 > kMaxTriangles) {
        return name + " has " + std::to_string(mesh.indices.size() / 3) + " triangles, more than " +
               std::to_string(kMaxTriangles);
      }
      return name + ".positions" + at + " = " + number(static_cast<double>(mesh.positions[status.at])) +
             " is too far from the origin (more than 1e8 diagonals of the target)";
    case Code::badOption: return describeOption(status);
    case Code::resultMismatch:
      return "the result does not belong to this target: it has " + std::to_string(status.at) + " zones for " +
             vertices + ", or its segments do not match";
    case Code::outOfMemory: return "not enough memory for this target and cage";
  }
  return "unknown";
}

}  // namespace cagecast
