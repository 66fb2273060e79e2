#pragma once

#include <cstdint>
#include <vector>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"
#include "hull/hull.hpp"
#include "make/hole_marker.hpp"
#include "mesh/outer_points.hpp"
#include "mesh/triangle_mesh.hpp"

/// The steps of making a cage, each in a file of its own; `HoleMarker` is the one between wrapping and cutting.
namespace cagecast::cages {

/// The axes of the file that are up and front of a model.
struct Stance {
  Vec3 up{0, 1, 0}, front{0, 0, 1};
};

/// As the bones tell it of a figure that stands, with any axis up; y and z of any other model.
Stance stanceOf(const Model& model);

/// What a model seems to be, by the names of its joints and parts and by its proportions.
/// A body stands: it is much taller than deep, or taller than deep and has the joints of legs. A head is about as tall
/// as deep, and has a part that only heads have, or an open border at its bottom. Anything else is a prop.
/// @param model  Checked by `checkModel`.
Kind kindOf(const Model& model);

/// Whether a prop is a head if it turns out to have eyes: it is as compact as one, and has no legs and no wheels.
bool isCompactProp(const Model& model);

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

/// The frame of a face by landmarks; nothing without both centres of its eyes.
std::optional<FaceFrame> faceFrameOf(const std::vector<Landmark>& landmarks);

/// The skin of a model's face.
/// @param marked  Not all of it is marked. @param triangleOf  As `ColoredEyes` has it.
FaceSkin faceSkinOf(const Model& model, const MarkedMesh& marked, const std::vector<std::uint32_t>& triangleOf,
                    const FaceFrame& frame);

/// Whether each triangle is of a wheel, by shape: connected pieces that are equally large round discs, two or more, on
/// the ground, and what lies within them.
std::vector<bool> wheelsOf(const TriangleMesh& mesh);

struct WrapOptions {
  HullOptions hull;
  bool mayWiden = false;  ///< Whether wider gaps may be bridged if pieces are left out.
};

/// A hull, as by `makeHull`, around all that is to be painted.
/// @param isMarked  Per triangle of the mesh: need not be in the hull.
/// @return aborted, noVolume, or inPieces if these lie too far apart.
Status wrap(const TriangleMesh& mesh, const std::vector<bool>& isMarked, const WrapOptions& options,
            const Progress& progress, TriangleMesh& out);

/// Halves the edges of triangles of which a vertex is chosen; their neighbours are cut to fit. New vertices come after
/// the mesh's own.
/// @param[in,out] parents  A number per triangle, which its parts inherit.
void subdivide(const std::vector<bool>& isChosen, TriangleMesh& mesh, std::vector<std::uint32_t>& parents);

/// The part of a mesh without the holes of a field, which begin at 0.4. Triangles that the border of a hole crosses are
/// cut along it; pieces of less than a hundredth of the area are dropped.
/// @param field  Per vertex: see `HoleMarker::field`.
TriangleMesh cutHoles(const TriangleMesh& mesh, const std::vector<double>& field);

struct SimplifyOptions {
  std::uint32_t triangles = 0;  ///< Of the result, about.
  double tolerance = 0;         ///< How far boundary loops may be off; small ones are held to less.
};

/// Makes a mesh of fewer triangles, of vertices of the given one. Each of its boundary loops keeps 5 to 24 vertices in
/// place: small holes would vanish otherwise.
/// Surface simplification by quadric error metrics (Garland, Heckbert 1997), by meshoptimizer.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool simplify(const TriangleMesh& mesh, const SimplifyOptions& options, const Progress& progress, TriangleMesh& out);

/// Moves the vertices of a mesh outwards until points are behind it. Points next to a hole are let out.
/// @param limit  How far a vertex may go at most; farther would be a fin.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool enclose(const OuterPoints& points, double limit, const Progress& progress, TriangleMesh& mesh);

}  // namespace cagecast::cages
