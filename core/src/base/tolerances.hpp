#pragma once

/// Constants that several folders share. Lengths are shares of the diagonal of the target's bounding box, written diag.
namespace cagecast {

/// Step 1: cage triangles whose distances from a point differ by less than this, in diag, are equally near. It is
/// larger than what rounding positions to floats moves a surface by, and smaller than any detail of a model.
inline constexpr double kTieDistance = 1e-6;

/// Step 1: of equally near triangles those come first whose planes are farthest from the point, up to this, in diag.
/// The heights of one point above two planes through the same edge differ by rounding alone.
inline constexpr double kTiePlane = 1e-7;

/// Steps 2, 3 and 9: a ray meets the target only from this far on, in diag, so that it does not hit the surface that it
/// starts from; it meets the cage from as far behind its start, so that a point on the cage is covered.
inline constexpr double kRayStart = 1e-5;

/// Step 12: a target edge is smeared if its UV length exceeds the UV length that the cage explains by this factor,
inline constexpr double kSmear = 4;
/// plus this UV length: edges that are shorter than it in the texture are never smeared.
inline constexpr double kSmearSlack = 0.005;

}  // namespace cagecast
