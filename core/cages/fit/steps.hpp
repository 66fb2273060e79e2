#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "fit/hole_outline.hpp"
#include "fit/warp.hpp"
#include "landmarks/landmark_list.hpp"
#include "landmarks/parts.hpp"
#include "linear/sparse_system.hpp"
#include "mesh/bounds.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/thin_plate.hpp"

/// The steps of a fit, each in a file of its own. Lengths are in the space of the template.
namespace cagecast::cages {

/// The mirror plane and the directions of a head or figure, by its landmarks.
struct Axes {
  Vec3 left{1, 0, 0}, up{0, 1, 0}, front{0, 0, 1};
  Vec3 middle{};       ///< A point of the mirror plane.
  bool known = false;  ///< Whether there were landmarks on both sides and in front.
};

/// A cage to be fitted, welded, with what the fit needs to know of it. All in its own space.
struct TemplateCage {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertexOf;            ///< Vertex of `mesh` for each vertex of the given cage.
  std::vector<std::vector<std::uint32_t>> loops;  ///< Open borders: holes, and the rim where the figure ends.
  int rim = -1;  ///< The loop where the figure ends, as at a neck; -1 if there is none.
  double diagonal = 0;
  double offset = 0;  ///< How far the cage is off the model that it was made for, by the landmarks on its skin.
  Neighbours neighbours;
};

TemplateCage prepareTemplate(const Template& from);

/// Whether a landmark lies on the skin: joints and the centres of eyes do not.
bool isOnSkin(const std::string& name);

/// Whether a landmark is one of eyes, nose, mouth or chin.
bool isOfFace(const std::string& name);

Axes axesOf(const std::vector<Landmark>& landmarks);

/// The boundary loop that is a rim: the longest one, if it is longer than `kMinRim` diagonals and less lies within it
/// than within the outline of a mask, which may end anywhere on a figure; -1 if there is none.
int rimOf(const TriangleMesh& mesh, const std::vector<std::vector<std::uint32_t>>& loops, double diagonal);

/// Whether a template is for heads, by its landmarks: it has a face and no legs.
bool isHead(const Template& from);

/// Where a template's landmarks are on a model if nothing but its size and symmetry, and a few landmarks, are known.
std::vector<Landmark> guessLandmarks(const Template& from, const TemplateCage& cage, const Model& model,
                                     const std::vector<Landmark>& known);

/// Checks a list of landmarks by itself: not too many, finite, named, near its model, no name twice, no two on one
/// spot.
/// @param argument  What to blame.
/// @param box  Of the model.
Status checkLandmarkList(const std::vector<Landmark>& landmarks, Argument argument, const Bounds& box);

/// Checks that joints among the landmarks of a model, which its skeleton may have told, are in the unit of its mesh.
/// @param box  Of the mesh.
/// @return `at` is a place in the list.
Status checkJoints(const std::vector<Landmark>& landmarks, const Bounds& box);

/// Checks given landmarks: they have to be where a template can have them after turning and scaling, and on the
/// sides where all landmarks have them.
/// @param from,to  In the same order.
/// @param given  Whether a person gave it.
/// @param[out] outvoted  Whether each was found far from where three or more given ones put it.
/// @return `at` is a place in these lists.
Status checkAgreement(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                      const std::vector<bool>& given, double diagonal, std::vector<bool>& outvoted);

/// A piece of the body that moves as one: where it is in the template, and an affine map to the target.
struct Bone {
  Vec3 from, to;  ///< Its ends in the template.
  Affine map;
};

/// The bones between joints that both have: each turned by the smallest angle and stretched along its length; the head
/// by a similarity of its landmarks. Empty if fewer than `kMinBones` are known.
/// @param from,to  Landmarks with joints ("joint_knee_left"), both in the template's space.
std::vector<Bone> bonesOf(const std::vector<Landmark>& from, const std::vector<Landmark>& to);

/// Bends a cage by bones (linear blend skinning): weights 1 / distance^6, smoothed over neighbours.
std::vector<Vec3> bend(const TemplateCage& cage, const std::vector<Bone>& bones);

/// The same for any points, without smoothing.
Vec3 bend(const Vec3& point, const std::vector<Bone>& bones);

/// A pair for each landmark; those that are not certain may stay off a little. The centre of an eye is deep inside, and
/// is left out where both corners say more.
/// @param from,to  In the same order.
/// @param withJoints  Joints count only where there is a skeleton.
std::vector<Anchor> landmarkAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                                    bool withJoints);

/// Pairs of points around the rims where both end, such as necks: front on front, back on back, the sides by length.
/// Empty if the template has no rim, or the target none about as long and about there.
/// @param target  The target's skin, in the template's space.
std::vector<Anchor> rimAnchors(const TemplateCage& cage, const TriangleMesh& target, const Axes& axes);

/// Whether each triangle of a target is wholly below the rim of a cage: a template of a head does not see it.
/// @param positions  Of the cage where it is.
/// @param slack  How far below it has to be, in diagonals: what a neck goes into is still seen.
std::vector<bool> belowRim(const TemplateCage& cage, const std::vector<Vec3>& positions, const TriangleMesh& target,
                           double slack = 0.06);

/// The parts of a model without paint under the template of a head: clothes by name, parts held by no joint of head or
/// neck, and parts below the rim but for a tenth. Never a part with the face.
/// @param skin  Of the target; `triangleOf` are its triangles in the model.
/// @param isBelow  Per triangle of it: whether it is below the rim.
std::vector<std::uint32_t> partsBesideHead(const Model& model, const TriangleMesh& skin,
                                           const std::vector<std::uint32_t>& triangleOf,
                                           const std::vector<bool>& isBelow, const std::vector<Landmark>& landmarks);

/// Pairs along the lower edge of a jaw of which only the chin is known, as where a mouth is open or the chin double:
/// all of it moves with the chin, less and less towards the lobes of the ears. Empty if menton is known.
/// @param own  All landmarks of the template.
std::vector<Anchor> jawAnchors(const std::vector<Landmark>& own, const std::vector<Landmark>& to);

/// Pairs above and below each eye: an eye that is wider is higher, too, by as much.
std::vector<Anchor> eyeAnchors(const std::vector<Landmark>& from, const std::vector<Landmark>& to, const Axes& axes);

/// A face as a whole, in the template's space.
struct Face {
  Axes own, there;     ///< The directions of the template's face and of the target's.
  Similarity map;      ///< From the template's face to the target's.
  bool known = false;  ///< Whether there are landmarks enough.

  /// A length and direction of the template's face on that of the target.
  [[nodiscard]] Vec3 carried(const Vec3& v) const {
    return map.scale * (dot(v, own.left) * there.left + dot(v, own.up) * there.up + dot(v, own.front) * there.front);
  }
  /// Without its depth.
  [[nodiscard]] Vec3 fromFront(const Vec3& v) const { return v - dot(v, there.front) * there.front; }
};

/// @param from,to  Landmarks in the same order, both in the template's space.
/// @param axes  Of the template.
/// @param up  Where the target's y is.
Face faceOf(const std::vector<Landmark>& from, const std::vector<Landmark>& to, const Axes& axes, const Vec3& up);

/// Whether each landmark is one of an eye or of a mouth that was found elsewhere than a person has it.
/// @param given  Whether a person gave it.
/// @param found  Where what is given was found, too.
std::vector<bool> contradicted(const std::vector<bool>& given, const std::vector<std::optional<Vec3>>& found,
                               const Face& face, const std::vector<Landmark>& to);

/// Landmarks that are known of template and target.
struct LandmarkPairs {
  std::vector<Landmark> from, to;  ///< In the same order; `to` in the target's space, then in the template's.
  std::vector<bool> given;         ///< Whether a person gave it.
};

/// A hole of a cage for an eye or a mouth.
struct FaceHole {
  std::vector<std::uint32_t> loop;
  Vec3 place;            ///< Where its middle belongs, as seen from in front: depth does not count.
  bool isGiven = false;  ///< Whether a person gave a landmark of it.
  bool isMouth = false;
};

/// The hole at a spot of the template: the loop whose middle is nearest to it, and nearer than to another spot; -1 if
/// there is none.
int holeAt(const TemplateCage& cage, const Vec3& centre, const Vec3& other);

/// The holes of a face, and where the landmarks put them. Empty if the face is not known.
/// @param start  Where the cage is by landmarks alone.
std::vector<FaceHole> faceHoles(const TemplateCage& cage, const std::vector<Vec3>& start, const LandmarkPairs& pairs,
                                const Face& face);

/// How a hole has to move to be in its place, as seen from in front.
Vec3 missOf(const FaceHole& hole, const Face& face, const std::vector<Vec3>& positions);

/// A target whose holes are looked into.
struct SeenModel {
  const Model& model;
  const Figure& figure;       ///< All of it, read from `model`, in the template's space.
  const Similarity& toModel;  ///< From the template's space.
};

/// Whether there is nothing behind each hole of a face: no eye, no teeth, no opening, no other colour than around it,
/// no morph target that moves it. Where colours are not known, there may be something.
/// @param holes  Of the left eye, the right eye and the mouth; without one of them, none is empty.
/// @param positions  Of the cage where it is.
std::vector<bool> emptyHoles(const std::vector<FaceHole>& holes, const SeenModel& seen,
                             const std::vector<Vec3>& positions);

/// Triangles that close a hole, in the plane of its UVs.
/// @param uvs  Per corner of its loop, which has the mesh on its left.
/// @return Places in the loop; empty where the UVs do not say how.
std::vector<Triangle3> lidOf(const std::vector<Flat>& uvs);

struct TightenOptions {
  double reach = 0.1;   ///< Planes farther away than this share of the diagonal do not count; shrinks to a third.
  double sliding = 0;   ///< Resistance to sliding along the surface.
  double stiffest = 0;  ///< Resistance to bending, at first and at last.
  double softest = 0;
  std::span<const PlaneTerm> holds = {};  ///< What else the cage is drawn to, such as the holes of a face.
};

/// Draws a cage onto the hull of the target, smoothly and with little sliding.
/// @param rest  Positions of the cage to start from; what they are is kept as far as the hull lets them.
/// @return The positions; empty if cancelled.
std::vector<Vec3> tighten(const TemplateCage& cage, const std::vector<Vec3>& rest, const TriangleMesh& hull,
                          const TightenOptions& options, const StepCallback& step);

/// The centre of an eye of the template and of that of the target, both in the template's space.
struct EyePair {
  Vec3 from, to;
};

/// The pairs of both eyes by landmarks; empty if one is not known.
std::vector<EyePair> eyePairs(const std::vector<Landmark>& from, const std::vector<Landmark>& to);

/// The target in the template's space.
struct EyedFigure {
  TriangleMesh mesh;                      ///< Without excluded parts other than eyes.
  std::vector<bool> isEye;                ///< Per triangle: by the name of its part.
  std::vector<std::uint32_t> components;  ///< Per triangle.
  TriangleMesh covers;                    ///< What is excluded and no eye: lashes, brows, hair.
  std::vector<std::uint32_t> coverComponents;
  std::uint32_t componentCount = 0;
  std::vector<EyePair> eyes;  ///< Left and right; empty if not both are known of both.
  Face face;
  std::vector<FaceHole> holes;
};

/// Draws the borders of eye holes to the contours of what is visible of the eyes, seen along the direction in which
/// they look, with lashes as far as there is room. Where a model has no eyes of their own, or none where landmarks have
/// them, holes stay where they are.
/// @param[out] tracks  Per vertex of the cage: where its eye looks if it is on the border of a hole that was drawn,
///   where the face looks on that of another hole of it, else zero.
/// @return false if cancelled.
bool fitEyeHoles(const TemplateCage& cage, const EyedFigure& figure, const StepCallback& step,
                 std::vector<Vec3>& tracks, std::vector<Vec3>& positions);

/// Restores the template's shape at triangles that are folded over or thin, but are not so in the template.
/// @param tracks  Per vertex: the only direction in which it moves, unless a triangle at it cannot be unfolded
///   otherwise; zero if it is free.
/// @return false if cancelled.
bool relax(const TemplateCage& cage, const std::vector<Vec3>& tracks, const StepCallback& step,
           std::vector<Vec3>& positions);

/// Whether each triangle faces away from those around it, or turns by more than 120 degrees at an edge.
std::vector<bool> foldedTriangles(const TriangleMesh& mesh);

/// What a cage is pushed out of, in the template's space.
struct Enclosed {
  const TriangleMesh& skin;
  const TriangleMesh& hull;  ///< Skin that is farther inside than the offset, such as a mouth's, does not count.
};

/// Moves a cage outward where skin sticks out of it, by at most four times the offset and only where both face the same
/// way and no triangle folds over.
/// @param tracks  Per vertex: the only direction in which it moves; zero if it is free.
/// @return false if cancelled.
bool pushOut(const TemplateCage& cage, const Enclosed& inside, const std::vector<Vec3>& tracks,
             const StepCallback& step, std::vector<Vec3>& positions);

}  // namespace cagecast::cages
