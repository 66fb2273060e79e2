#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cagecast/mesh.hpp"
#include "cagecast/options.hpp"
#include "cagecast/status.hpp"

/// Cages for models that have none: made afresh for one model, fitted from a template, or moved into place.
///
/// A library of its own (`cagecast::cages`), and a WebAssembly module of its own, because it needs Eigen and
/// meshoptimizer and takes seconds instead of milliseconds. Single-threaded and deterministic.
///
/// Functions return a `Status`, as those of the core do. Unless it is ok, nothing in their output is valid. Names and
/// lists of names need strings and vectors, so these are used throughout, and not `Array`; where memory runs out, the
/// status is `outOfMemory`, if the library is compiled with exceptions, which it catches itself.
namespace cagecast::cages {

using Position = std::array<float, 3>;  ///< x, y, z in the space of the model.

/// A named spot on a model, such as `nose_tip` or `eye_centre_left`; docs/cages.md lists the names.
struct Landmark {
  std::string name;
  Position position{};
  float confidence = 1;  ///< 0..1: 1 if a person or a bone gave it; those found at less than 0.5 are left out.
};

/// A joint of the model's skeleton, in the pose in which the mesh is given.
struct Joint {
  std::string name;  ///< As in the file; `fitCage` and `findLandmarks` know the names of common rigs.
  Position position{};
  std::int32_t parent = -1;  ///< Its place in the list; -1 for a root.
};

/// An image of small size, such as 512 by 512: larger ones say no more of where a face is.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::span<const std::uint8_t> pixels = {};  ///< 4 per pixel: red, green, blue in sRGB, alpha; upper row first.
};

/// What a part looks like without light: its image, if it has one, times a colour.
struct BaseColor {
  std::array<float, 3> factor{1, 1, 1};  ///< Red, green, blue in linear light, 0..1.
  Image image = {};                      ///< Lies on the part by its UVs, and is repeated beyond 0..1. Empty: white.
  bool isKnown = true;                   ///< Whether it says all: not where an image could not be read.
};

/// What a cage is made for. The arrays belong to the caller and are only read.
struct Model {
  MeshView mesh;                             ///< `groups` number the parts. UVs are those of `baseColors`.
  std::vector<std::string> parts = {};       ///< Name of each part, or several: "node/mesh/material". May be empty.
  std::vector<Joint> joints = {};            ///< May be empty.
  std::span<const std::uint8_t> marks = {};  ///< 1 per triangle or none: 1 must not be painted, as by a brush.
  /// Where names say that the face is, such as those of morph targets: `eye_inner`, `eye_outer` and `mouth_corner` of
  /// both sides (which is left, its shape says), and `mouth`, the middle between the lips. Given landmarks count more,
  /// found ones less. May be empty.
  std::vector<Landmark> hints = {};
  /// The joint that holds each vertex most, as its place in `joints`; `kNoJoint` for none. What a head's joints hold is
  /// where a face is looked for. May be empty.
  std::span<const std::uint16_t> vertexJoints = {};
  /// The look of each part, by its number in `groups`. A painted face is looked for in it where names, bones and shape
  /// do not say enough. May be empty. Pixels whose alpha is below one half are not there.
  std::vector<BaseColor> baseColors = {};
};

inline constexpr std::uint16_t kNoJoint = 0xffff;

/// What a model is, which decides resolution, tightness and seams.
enum class Kind : std::uint8_t { automatic, head, body, prop };

/// A cage, with what is known about it.
struct Cage {
  std::vector<float> positions;        ///< 3 per vertex, in the space of the model.
  std::vector<float> uvs;              ///< 2 per vertex, 0..1. Seams have a vertex for each side.
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, counter-clockwise seen from outside.
  std::vector<Landmark> landmarks;     ///< Spots of the model that it was made for.
  Kind kind = Kind::automatic;         ///< What it was made for; `automatic` if that is not known.

  [[nodiscard]] MeshView view() const noexcept { return {positions, indices, uvs}; }
};

/// Whether each part is excluded by its name, unless `Parts::keep` has it: eyes, teeth, tongues, hair and glasses; of
/// vehicles windows, wheels, lights and the interior. `light`, `seat` and their like count beside a part that is named
/// as that of a vehicle.
/// @param parts  As `Model::parts`.
std::vector<bool> excludedByName(const std::vector<std::string>& parts);

/// Lengths are shares of the diagonal of the model's bounding box, 0.0005 to 0.2. 0 means: by kind.
struct MakeOptions {
  Kind kind = Kind::automatic;
  Parts parts = {};             ///< Holes are over excluded parts, and over those of `excludedByName` unless kept.
  std::uint32_t triangles = 0;  ///< Of the cage, about: heads and props 600, bodies 1500.
  float closing = 0;            ///< Gaps narrower than twice this, or two voxels, are bridged: 0.02, bodies 0.008.
  float offset = 0;             ///< Distance of the cage from the model: 0.01, bodies 0.004.
  std::uint32_t voxels = 0;     ///< Along the longest side: 140, bodies 240.
};

struct FitOptions {
  Parts parts = {};                      ///< Excluded parts are no skin, nor those of `excludedByName` unless kept.
  std::vector<Landmark> landmarks = {};  ///< Of the model, at most 300; these override found ones.
};

struct RefineOptions {
  float reach = 0.05f;  ///< How far off the cage may be, as a share of the diagonal: 0.001 to 0.2.
};

/// Reports how far a call is, as a share 0..1, and what it does ("hull", "unwrap"). Called many times a
/// second; on a model of a million triangles or on the finest grid, seconds may pass between two calls. Return false to
/// cancel: the status is `aborted` then. What it throws, the call throws.
using Progress = std::function<bool(float share, const char* stage)>;

/// What was found on a model.
struct FoundLandmarks {
  std::vector<Landmark> landmarks;
  std::vector<std::string> missing;  ///< Names that were looked for in vain, or that are too uncertain: ask for these.
  std::string
      rig;  ///< "VRM", "Mixamo", "Ready Player Me", "Roblox R15", "VRoid", "Rigify", "other"; "unknown" or empty.
  Kind kind = Kind::prop;        ///< What the model seems to be.
  bool areSeveralHeads = false;  ///< Whether heads stand beside each other. Then none of their landmarks is given.
};

/// Finds the landmarks of a head or a figure by part names, joint names, shape and base colours.
Status findLandmarks(const Model& model, const Progress& progress, FoundLandmarks& out);

/// Makes a cage for a model: a hull around it, with holes over the parts that are not painted, unwrapped.
Status makeCage(const Model& model, const MakeOptions& options, const Progress& progress, Cage& out);

/// A cage that was made for one model and is to be fitted to others.
struct Template {
  MeshView cage;                    ///< With UVs.
  std::vector<Landmark> landmarks;  ///< Of the model that it was made for: 4 to 300.
  Kind kind = Kind::automatic;      ///< The fitted cage gets it, too. The fit itself asks only for landmarks.
};

/// A fitted cage; its landmarks are those that the fit used.
struct FittedCage : Cage {
  std::vector<std::string> missing;  ///< Landmarks of the template that are not known on the model: ask for these.
  /// Landmarks that are used with a guess of where they are, as fewer than four were known: the model is taken for the
  /// template's own, stretched to its size. Ask for these first.
  std::vector<std::string> guessed;
  /// Parts without paint under a template of a head, by group: clothes, and parts below its neck.
  std::vector<std::uint32_t> bare;
  /// Vertices on the borders of holes that were closed: there is nothing behind them that should stay bare.
  std::vector<std::uint32_t> closed;
};

/// Moves a template cage onto another model; vertices, UVs and triangles stay. Holes for eyes or a mouth with nothing
/// behind them are closed by further triangles.
Status fitCage(const Template& from, const Model& model, const FitOptions& options, const Progress& progress,
               FittedCage& out);

/// Moves, turns and scales a cage that is slightly off its model into place, and bends it where it is inside the model.
/// In place means that its distance from the model is as even as it can be; holes and part names are not looked at.
/// A cage in place stays as it is, to the bit. UVs, triangles and their order stay in any case, and so do landmarks,
/// which belong to the model: `out.landmarks` is empty.
/// @return An error if the cage is farther off than `reach`, cannot be brought into place, or is of another model.
/// Cost: 0.1 to 0.5 s for cages of 600 to 1500 triangles.
Status refineCage(const MeshView& cage, const Model& model, const RefineOptions& options, const Progress& progress,
                  Cage& out);

/// One sentence for people about a status of `makeCage` or `findLandmarks`: it names the argument, the element, its
/// value and the limit. All but the status is what the call was given.
std::string describe(const Status& status, const Model& model);
/// The same of `fitCage`.
std::string describe(const Status& status, const Template& from, const Model& model, const FitOptions& options);
/// The same of `refineCage`.
std::string describe(const Status& status, const MeshView& cage, const Model& model, const RefineOptions& options);

}  // namespace cagecast::cages
