#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace cagecast::cages {

/// A point of a plane.
struct Flat {
  double x = 0, y = 0;
};

/// What a hole is for, as it is seen from in front: about the origin, in any unit of length.
struct HoleContent {
  std::vector<double> contour;  ///< How far what must be free reaches, in directions at equal angles, from x to y.
  /// A point of a piece such as lashes, with the area that it stands for. Most of a piece should be free where there is
  /// room.
  struct Cover {
    Flat at;
    double area = 0;
    std::size_t piece = 0;  ///< Numbered from 0.
  };
  std::vector<Cover> covers;
  /// A triangle at the hole, which must not fold over: counter-clockwise.
  struct Neighbour {
    std::array<int, 3> corners;  ///< Of the hole; -1 for others.
    std::array<Flat, 3> places;  ///< Where they are before; those that are no corners of the hole stay there.
  };
  std::vector<Neighbour> neighbours;
};

/// The corners of a hole, so that what must be free is free with a margin, covers are where they allow, and not much
/// else is. They keep their order, and their angles as far as possible.
/// @param corners  Around the origin, counter-clockwise; at least 3.
std::vector<Flat> fitOutline(std::vector<Flat> corners, const HoleContent& content);

}  // namespace cagecast::cages
