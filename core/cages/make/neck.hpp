#pragma once

#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The plane at which the cage of a head ends, below the open border of its neck.
struct Neck {
  Vec3 normal{};      ///< Away from the head, of unit length.
  double height = 0;  ///< The dot product of the plane's points with the normal.
  Vec3 middle{};      ///< Of the opening, on the plane.
  double radius = 0;  ///< Of the opening.
};

/// Lengthens the open necks of a head to planes beyond them, for a hull to follow: openings of at least a fifth of the
/// diagonal at which the head ends, and a piece of it that is more than a sheet.
/// @param by  From the outermost spot of the border to the plane.
/// @param[in,out] head  Gets vertices and triangles after its own.
std::vector<Neck> extendNecks(double by, TriangleMesh& head);

/// Opens the hull of a head at the planes of its necks.
/// @param[in,out] field  See `HoleMarker::field`.
void openNecks(const TriangleMesh& hull, const std::vector<Neck>& necks, std::vector<double>& field);

}  // namespace cagecast::cages
