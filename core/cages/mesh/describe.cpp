#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"
#include "input/fill_in.hpp"
#include "mesh/limits.hpp"

namespace cagecast::cages {

namespace {

constexpr const char* kSentences[] = {
#define CAGECAST_CAGES_CODE(name, text, sentence) sentence,
#include "cagecast/codes.def"
};

/// How many landmarks a sentence lists at most.
constexpr std::size_t kMaxNames = 12;

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i) out += (i > 0 ? ", " : "") + names[i];
  return names.size() > kMaxNames ? out + " and " + std::to_string(names.size() - kMaxNames) + " more" : out;
}

/// The name of a landmark. Of what the call did not get, a sentence says nothing.
std::string nameAt(const std::vector<Landmark>& landmarks, std::size_t at) {
  return at < landmarks.size() ? landmarks[at].name : "a landmark";
}

/// The name of the landmark that is nearest to one of a list.
std::string nearestTo(const std::vector<Landmark>& landmarks, std::size_t at) {
  if (at >= landmarks.size()) return "another one";
  const auto distance = [&](const Landmark& other) {
    if (&other == &landmarks[at]) return std::numeric_limits<double>::infinity();
    return length(Vec3::from(other.position.data()) - Vec3::from(landmarks[at].position.data()));
  };
  return std::min_element(landmarks.begin(), landmarks.end(),
                          [&](const Landmark& a, const Landmark& b) { return distance(a) < distance(b); })
      ->name;
}

std::string limitOf(const Status& status) {
  const bool isModel = status.argument == Argument::model;
  switch (status.code) {
    case Code::tooDetailed: return std::to_string(isModel ? kMaxModelTriangles : kMaxCageTriangles);
    case Code::tooManyLayers: return text("%g", kMaxLayers);
    case Code::tooManyLandmarks: return std::to_string(kMaxLandmarks);
    case Code::tooFewLandmarks: return std::to_string(kMinLandmarks);
    case Code::landmarkAway: return text("%g %%", 100 * kMaxLandmarkOff);
    case Code::jointOutside: return text("%g", kMaxJointOutside);
    case Code::smallSkeleton: return text("%g", kMinSkeleton);
    default: return std::to_string(kMinBones);
  }
}

/// What a call was given.
struct Call {
  const Model& model;
  const Template& from;  ///< Or a cage without landmarks.
  const std::vector<Landmark>& given;
  float reach = 0;
};

std::string describeOption(const Status& status) {
  if (status.option == Option::kind)
    return "options.kind = " + text("%g", static_cast<double>(status.value)) + " is not a kind";
  if (status.option >= Option::ignoredParts && status.option <= Option::excludedParts)
    return std::string("options.") + optionName(status.option) + " has group " + std::to_string(status.at) +
           ", of which there is no vertex";
  for (const auto& [option, name, low, high] : kOptionRanges)
    if (option == status.option)
      return std::string("options.") + name + text(" = %g", static_cast<double>(status.value)) +
             text(" is not within %g", static_cast<double>(low)) + text("..%g", static_cast<double>(high));
  return "options are not valid";
}

std::string valueOf(std::string_view name, const Status& status, const Call& call) {
  const std::size_t at = status.at;
  const auto value = static_cast<double>(status.value);
  const MeshView& mesh = status.argument == Argument::model ? call.model.mesh : call.from.cage;
  if (name == "mesh") return argumentName(status.argument);
  if (name == "landmarks") return status.argument == Argument::from ? "template.landmarks" : "landmarks";
  if (name == "at") return std::to_string(at);
  if (name == "value") return text("%.3g", value);
  if (name == "percent") return text("%.1f %%", 100 * value);
  if (name == "reach") return text("%.1f %%", 100 * static_cast<double>(call.reach));
  if (name == "limit") return limitOf(status);
  if (name == "most vertices")
    return std::to_string(status.argument == Argument::model ? kMaxModelVertices : kMaxCageVertices);
  if (name == "triangles") return std::to_string(mesh.indices.size() / 3);
  if (name == "vertices") return std::to_string(mesh.positions.size() / 3);
  if (name == "group") return at < mesh.groups.size() ? std::to_string(mesh.groups[at]) : "0";
  if (name == "base colors") return std::to_string(call.model.baseColors.size());
  if (name == "parts") return std::to_string(call.model.parts.size());
  if (name == "parent") return at < call.model.joints.size() ? std::to_string(call.model.joints[at].parent) : "?";
  if (name == "joints") return std::to_string(call.model.joints.size());
  if (name == "names") {
    std::vector<std::string> names;
    for (const Landmark& landmark : call.from.landmarks) names.push_back(landmark.name);
    return listed(names);
  }
  // Those that are compared with the template's are numbered as there.
  const bool isCompared = status.code == Code::wrongSide || status.code == Code::landmarkAway;
  const bool isGiven = status.argument == Argument::landmarks && !isCompared;
  const std::vector<Landmark>& landmarks = isGiven ? call.given : call.from.landmarks;
  return name == "nearest" ? nearestTo(landmarks, at) : nameAt(landmarks, at);
}

std::string describe(const Status& status, const Call& call) {
  if (status.code == Code::badOption) return describeOption(status);
  constexpr auto kFirst = static_cast<std::size_t>(Code::aborted);
  const auto code = static_cast<std::size_t>(status.code);
  if (code < kFirst || code >= kFirst + std::size(kSentences))
    return cagecast::describe(status, call.from.cage,
                              status.argument == Argument::model ? call.model.mesh : call.from.cage);
  return fillIn(kSentences[code - kFirst], [&](std::string_view name) { return valueOf(name, status, call); });
}

}  // namespace

std::string describe(const Status& status, const Model& model) { return describe(status, Call{model, {}, {}}); }

std::string describe(const Status& status, const Template& from, const Model& model, const FitOptions& options) {
  return describe(status, Call{model, from, options.landmarks});
}

std::string describe(const Status& status, const MeshView& cage, const Model& model, const RefineOptions& options) {
  return describe(status, Call{model, {cage, {}}, {}, options.reach});
}

}  // namespace cagecast::cages
