#pragma once

#include <optional>
#include <vector>

#include "fit/hole_outline.hpp"
#include "fit/steps.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

/// What a hole of a cage has to show, seen along an axis: what is visible of an eye, or what is between the lips. Flat
/// places are about its middle, in lengths; heights count from a line across, which may be bent as lips are.
struct FaceOpening {
  Vec3 middle{}, axis{}, across{}, up{};
  /// Distances from `middle` in directions at equal angles, from `across` to `up`, where heights are `stretch` times as
  /// large: so a slit has a contour that is round.
  std::vector<double> contour;
  double stretch = 1;
  /// Whether next to nothing shows: both sides of the hole are at the depth of the line between them.
  bool isClosed = false;
  std::vector<HoleContent::Cover> covers;
  /// Heights of the line across, from `seamFrom` on in steps of `seamStep`; it is straight if there are none.
  std::vector<double> seam;
  double seamFrom = 0, seamStep = 1;
  /// From rim to rim across what shows, if that is no surface of its own.
  TriangleMesh fill;

  [[nodiscard]] double seamAt(double x) const;
  [[nodiscard]] Flat flat(const Vec3& p) const;
  [[nodiscard]] Vec3 place(const Flat& p) const;
};

/// What is visible of an eye, with the lashes around it; nothing if the figure has no eye of its own there.
/// @param surface  Of the figure's mesh.
std::optional<FaceOpening> eyeOpening(const HoledFigure& figure, const EyePair& eye, const Vec3& other, double diagonal,
                                      const Surface& surface);

/// What is between the lips of a figure; where they are closed, next to nothing along the line where they meet. Nothing
/// at all if it is larger than a mouth: then the hole is not where lips are.
/// @param border  Of the mouth's hole, where it is by now.
/// @param width  From one corner of the mouth to the other.
/// @param surface  Of the figure's mesh: without teeth and tongue, which would fill the opening.
std::optional<FaceOpening> mouthOpening(const std::vector<Vec3>& border, double width, const Axes& face,
                                        const Surface& surface);

/// What the border of a hole is laid on.
struct HoleGround {
  const Surface& surface;
  double offset;  ///< How far in front of it.
};

/// Moves the border of a hole to where it shows what it has to, and what is next to it out of its way.
void drawHole(const TemplateCage& cage, std::vector<std::uint32_t> loop, const FaceOpening& opening,
              const HoleGround& ground, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
