#include "landmarks/landmark_list.hpp"

namespace cagecast::cages {

const Landmark* findLandmark(const std::vector<Landmark>& landmarks, std::string_view name) {
  for (const Landmark& landmark : landmarks)
    if (landmark.name == name) return &landmark;
  return nullptr;
}

std::optional<Vec3> placeOf(const std::vector<Landmark>& landmarks, std::string_view name) {
  const Landmark* found = findLandmark(landmarks, name);
  if (found == nullptr) return std::nullopt;
  return positionOf(*found);
}

std::string mirrorName(std::string_view name) {
  constexpr std::string_view kLeft = "_left", kRight = "_right";
  const auto with = [&](std::string_view end, std::string_view other) {
    return std::string(name.substr(0, name.size() - end.size())).append(other);
  };
  if (name.ends_with(kLeft)) return with(kLeft, kRight);
  return name.ends_with(kRight) ? with(kRight, kLeft) : std::string();
}

std::optional<Vec3> leftOf(const std::vector<Landmark>& landmarks) {
  Vec3 sum{0, 0, 0};
  for (const Landmark& landmark : landmarks) {
    const auto other = placeOf(landmarks, mirrorName(landmark.name));
    if (landmark.name.ends_with("_left") && other) sum = sum + positionOf(landmark) - *other;
  }
  sum.y = 0;
  const double size = length(sum);
  return size > 0 ? std::optional(1 / size * sum) : std::nullopt;
}

}  // namespace cagecast::cages
