#pragma once

#include <cstddef>

#include "cagecast/status.hpp"

/// Limits that users see: errors name them.
namespace cagecast::cages {

/// Triangles and vertices of a model: beyond it a call would take minutes in a page.
inline constexpr std::size_t kMaxModelTriangles = 2'000'000;
inline constexpr std::size_t kMaxModelVertices = 6'000'000;

/// Triangles and vertices of a cage: the time of fitting one grows with the power 1.5 to 2 of them, to half a minute
/// here.
inline constexpr std::size_t kMaxCageTriangles = 20'000;
inline constexpr std::size_t kMaxCageVertices = 60'000;

/// The area of all triangles of a mesh, in squares of its diagonal: a figure in clothes with hair has 3, a car 2, a
/// tree of leaves perhaps 20. Each point of space is searched through all layers of triangles there.
inline constexpr double kMaxLayers = 50;

/// Each landmark is compared with where all others put it: the time grows with the cube of their number.
inline constexpr std::size_t kMaxLandmarks = 300;
inline constexpr std::size_t kMinLandmarks = 4;
/// Two landmarks that are closer than this share of the diagonal are on one spot, and count once.
inline constexpr double kOneSpot = 1e-3;
/// A landmark that is off by more than this share of the diagonal, after the others are aligned, may be a mistake.
inline constexpr double kMaxLandmarkOff = 0.15;

/// Joints may be outside the box of the mesh by so many diagonals: a figure that ends at the hips may have those of
/// legs.
inline constexpr double kMaxJointOutside = 0.5;
/// A skeleton of several bones reaches over at least this share of the diagonal of its mesh.
inline constexpr double kMinSkeleton = 0.05;
/// With fewer, a figure is not bent.
inline constexpr std::size_t kMinBones = 6;

/// The range of an option that is a number.
struct OptionRange {
  Option option;
  const char* name;
  float low, high;
};
inline constexpr OptionRange kOptionRanges[] = {
    {Option::triangles, "triangles", 50, 20'000},
    {Option::closing, "closing", 0.0005f, 0.2f},  // Shares of the diagonal.
    {Option::offset, "offset", 0.0005f, 0.2f},
    {Option::voxels, "voxels", 16, 400},
    {Option::reach, "reach", 0.001f, 0.2f},  // Below, no cage would move; beyond, cage and model hardly touch.
};

}  // namespace cagecast::cages
