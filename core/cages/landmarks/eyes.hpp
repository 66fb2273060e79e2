#pragma once

#include <array>
#include <optional>
#include <vector>

#include "landmarks/frame.hpp"
#include "landmarks/parts.hpp"

namespace cagecast::cages {

/// The two eyes of a figure, in the space of the model.
struct Eyes {
  std::array<Vec3, 2> centres{};  ///< Left, right: the figure's.
  Vec3 left{1, 0, 0};             ///< From the right eye to the left one, horizontal.
  Vec3 front{0, 0, 1};
  double radius = 0;
  double confidence = 0;
  bool isNamed = false;              ///< Whether a name says so: of parts, or of what closes them.
  bool areOfSeveralHeads = false;    ///< Then nothing else is known of them.
  std::vector<bool> triangles = {};  ///< Of the figure: which belong to an eye. Empty if they are part of the skin.

  [[nodiscard]] Vec3 middle() const { return 0.5 * (centres[0] + centres[1]); }
};

/// A sphere through points, by least squares.
struct Sphere {
  Vec3 centre{};
  double radius = 0;
  double residual = 0;  ///< Typical distance of the points from it, as a share of the radius.
};
Sphere fitSphere(const std::vector<Vec3>& points);

/// Whether balls are eyes of several heads beside each other: two pairs of them, each level and about as far apart as
/// the other's, with more than the width of a head between them.
bool haveSeveralHeads(std::vector<Sphere> balls);

/// The eyes by the names of parts.
std::optional<Eyes> findNamedEyes(const Figure& figure);

/// The eyes by a model's hints: where lids close.
std::optional<Eyes> findHintedEyes(const Figure& figure, const std::vector<Landmark>& hints);

/// The eyes where a rig has joints for them.
std::optional<Eyes> findJointedEyes(const Figure& figure, const std::vector<Landmark>& joints);

/// The eyes as two connected components that mirror each other, are round, and are seen from the front only.
/// @param plane  Of the figure, or of its head.
std::optional<Eyes> findLooseEyes(const Figure& figure, const MirrorPlane& plane);

/// The eyes as bulges of the skin beside the root of the nose.
/// @param plane  Of the figure.
std::optional<Eyes> findFusedEyes(const Figure& figure, const MirrorPlane& plane);

}  // namespace cagecast::cages
