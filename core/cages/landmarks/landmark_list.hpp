#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"

namespace cagecast::cages {

inline Vec3 toVec3(const Position& p) { return Vec3::from(p.data()); }
inline Position toPosition(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}
inline Vec3 positionOf(const Landmark& landmark) { return toVec3(landmark.position); }

inline std::vector<Vec3> positionsOf(const std::vector<Landmark>& landmarks) {
  std::vector<Vec3> out(landmarks.size());
  std::transform(landmarks.begin(), landmarks.end(), out.begin(), positionOf);
  return out;
}

/// A landmark of a list by its name; null if it is not there.
const Landmark* findLandmark(const std::vector<Landmark>& landmarks, std::string_view name);
/// Where it is; nothing if it is not there.
std::optional<Vec3> placeOf(const std::vector<Landmark>& landmarks, std::string_view name);

/// Whether it is the joint of a skeleton.
inline bool isJoint(std::string_view name) { return name.starts_with("joint_"); }

/// The name of the landmark on the other side: "ear_top_right" for "ear_top_left"; empty if it has no side.
std::string mirrorName(std::string_view name);

/// The horizontal direction to a figure's left, of unit length, by landmarks that come in pairs.
std::optional<Vec3> leftOf(const std::vector<Landmark>& landmarks);

}  // namespace cagecast::cages
