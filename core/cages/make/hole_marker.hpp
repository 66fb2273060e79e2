#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/surface.hpp"
#include "mesh/triangle_mesh.hpp"
#include "views/face_frame.hpp"

namespace cagecast::cages {

/// The skin of a face, which is to be painted even where hair, a beard or glasses lie in front of it.
struct FaceSkin {
  std::vector<bool> isSkin = {};               ///< Per triangle of a mesh. Empty if it is not known where the face is.
  std::vector<bool> isCover = {};              ///< Per triangle: marked, and lies over skin.
  std::optional<Surface> others = {};          ///< All triangles that are no such covers.
  std::vector<std::uint32_t> triangleOf = {};  ///< Of the mesh, for each of `others`.

  /// Whether what is nearest to each point, but for covers, is the face's skin.
  [[nodiscard]] std::vector<bool> isBelow(std::span<const Vec3> points) const;
  /// The same, but only for points whose triangle is a cover.
  [[nodiscard]] std::vector<bool> isCoveredBy(std::span<const std::uint32_t> triangles,
                                              std::span<const Vec3> points) const;
};

struct MarkedMesh;

/// Two eyes that are no parts: what differs in its base colour from the skin around it, seen from the front.
class ColoredEyes {
 public:
  ColoredEyes() = default;
  /// @param triangleOf  Of the model, for each triangle of the mesh that is the model's.
  /// @param landmarks  With both centres of the eyes.
  ColoredEyes(const Model& model, const MarkedMesh& marked, const std::vector<std::uint32_t>& triangleOf,
              const std::vector<Landmark>& landmarks, const FaceFrame& face);

  /// Whether a point of the hull is before an eye.
  [[nodiscard]] bool isBefore(const Vec3& p, const Vec3& normal) const;

 private:
  FaceFrame face_;
  std::array<Vec3, 2> centres_{};                ///< In the space of the face.
  std::array<std::vector<bool>, 2> cells_ = {};  ///< Around the centres; empty if there are no such eyes.
};

/// A model, and what of it must not be painted.
struct MarkedMesh {
  const TriangleMesh* mesh = nullptr;
  const Surface* surface = nullptr;  ///< Of `mesh`.
  std::vector<bool> isMarked;        ///< Per triangle of `mesh`.
  std::vector<bool> isKept = {};  ///< Per triangle that is the model's: is painted, whatever is on it. Empty: none is.
  FaceSkin face = {};
  ColoredEyes eyes = {};
};

/// Finds where a hull around a model is to have holes.
///
/// A vertex of the hull is marked if what lies straight below it is, or what is nearest to it; or if something marked
/// that is seen from just above it is nearest to it: lashes and teeth are too thin for the first two.
class HoleMarker {
 public:
  /// @param depth  How far below the hull a part may lie and still be seen through it.
  /// @param[in,out] hull  Is refined along the borders of the marks.
  HoleMarker(const MarkedMesh& model, double depth, TriangleMesh& hull);

  /// Marks the vertices of the hull.
  /// @param refinements  How often its edges are halved near the borders of the marks.
  /// @return false if `progress` cancelled it; it gets shares from 0 to 1.
  bool mark(int refinements, const Progress& progress);

  /// How much the hull is to have a hole at each of its vertices: 0 not at all, 1 wholly; marks end at ½. Smooth; marks
  /// that smoothing would remove come back.
  [[nodiscard]] std::vector<double> field() const;

  /// Marks more of the hull where a cage made with `field` still covers too much of a marked part; farther around each
  /// time that it is called.
  /// @param[out] coveredShare  Of all that is seen of marked parts, the share that the cage covers in such parts.
  /// @return false if `progress` cancelled it, which leaves the marks as they were.
  bool widen(const TriangleMesh& cage, const Progress& progress, double& coveredShare);

 private:
  /// A spot on a marked part that is seen from the hull.
  struct Sample {
    Vec3 position{};
    Vec3 onHull{};               ///< The closest point on the hull as it was,
    std::uint32_t triangle = 0;  ///< and the triangle that it is in.
    std::uint32_t piece = 0;     ///< Connected piece of the marked triangles.
  };

  /// Sets `samples_`.
  bool findSamples(const Progress& progress);
  /// Sets `below_` for the vertices from one on.
  bool markBelow(std::size_t begin, const Progress& progress);
  /// Sets `above_` and `sampled_`.
  void markSamples();
  /// Marks what lies between marks that are close together, but no face.
  void closeGaps(const Neighbours& neighbours, std::vector<bool>& marks) const;
  [[nodiscard]] std::vector<bool> marks() const;
  /// The vertex of the hull that is nearest to each sample.
  [[nodiscard]] std::vector<std::uint32_t> verticesAbove() const;

  const MarkedMesh& model_;
  double depth_;
  TriangleMesh& hull_;
  std::vector<std::uint32_t> parents_;  ///< The triangle of the hull as it was, for each; rising.
  std::vector<Sample> samples_;
  std::uint32_t pieces_ = 0;
  std::vector<bool> below_;           ///< Per vertex: what is below or nearest is marked, or `widen` has marked it.
  std::vector<std::uint32_t> above_;  ///< The vertex that is nearest to each sample.
  std::vector<bool> sampled_;         ///< Per vertex: a sample is nearest to it.
  int widened_ = 0;                   ///< How far around, in edges, `widen` marked last.
};

}  // namespace cagecast::cages
