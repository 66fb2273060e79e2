#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "landmarks/eyes.hpp"
#include "landmarks/frame.hpp"
#include "views/curve.hpp"

namespace cagecast::cages {

/// From the eyes up to the crown, and to the back of the head: of most heads, in units of the frame.
inline constexpr double kEyesToCrown = 0.29, kEyesToBack = 0.43;

/// A landmark in the space of a head.
struct Spot {
  std::string name;
  Vec3 position{};
  double confidence = 0;
};

/// Where the lips meet or part on the midline.
struct MouthLine {
  double crease = 0;           ///< Height of the crease, or of the upper edge of the gap.
  double top = 0, bottom = 0;  ///< Heights that the gap ends at; nearly equal if the mouth is closed.
  double depth = 0;            ///< Of the crease.
};

/// A head in its own space, and what has been found on it. All lengths are in units of the frame.
struct Head {
  HeadFrame frame;
  TriangleMesh skin;             ///< Without eyes, teeth and hair, as far as they are known.
  Surface surface;               ///< Of the skin.
  Eyes eyes;                     ///< In this space.
  std::vector<Spot> hints = {};  ///< Of the model.
  std::vector<Spot> spots = {};
  std::optional<MouthLine> mouth = {};

  /// Does nothing if the place is not finite: where a figure is turned, curves may have no value.
  void add(std::string name, const Vec3& position, double confidence) {
    if (!std::isfinite(position.x + position.y + position.z)) return;
    spots.push_back({std::move(name), position, confidence});
  }
  [[nodiscard]] const Spot* find(std::string_view name) const { return find(spots, name); }
  [[nodiscard]] const Spot* hint(std::string_view name) const { return find(hints, name); }

 private:
  static const Spot* find(const std::vector<Spot>& spots, std::string_view name) {
    for (const Spot& spot : spots)
      if (spot.name == name) return &spot;
    return nullptr;
  }
};

/// A frame for a head whose eyes are not known, from the depth of what is at the top of a figure.
/// @param side  1 if its left is that of the plane, -1 if it faces the other way.
HeadFrame guessHeadFrame(const TriangleMesh& mesh, const MirrorPlane& plane, double side);

/// A head around two eyes, in a space of its own, without any landmark yet.
/// @return Nothing if the eyes are too close or too far apart for the skin around them.
std::optional<Head> makeHead(const Figure& figure, const Eyes& eyes, const std::vector<Landmark>& hints = {});

/// Finds all landmarks of a head that can be found.
void findHeadLandmarks(const Figure& figure, const Eyes& eyes, Head& head);

/// The midline of a face: nose, brow, lips and chin, from the curve of its profile. Needs the eyes' height.
/// @param notMouths  Heights of creases on the midline that are no mouth.
/// @return false if there is no human face's profile, and no hint where its mouth is.
bool findProfile(Head& head, const std::vector<double>& notMouths = {});

/// Crown, forehead and back of the head. Needs the profile.
void findSkull(Head& head);

void findMouthCorners(Head& head);

/// Both ears: top, lobe and outermost point.
void findEars(Head& head);

/// The corners of the eyes, where the eyeballs' visible part ends.
/// @param all  Skin and eyes.
/// @param isEye  Per triangle of `all`.
void findEyeCorners(Head& head, const Surface& all, const std::vector<bool>& isEye);

}  // namespace cagecast::cages
