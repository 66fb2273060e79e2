#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cagecast/cages.hpp"
#include "mesh/samples.hpp"
#include "mesh/surface.hpp"
#include "mesh/triangle_mesh.hpp"

/// The steps of a refinement, each in a file of its own.
namespace cagecast::cages {

/// What a cage is placed around.
struct Target {
  explicit Target(const TriangleMesh& mesh);

  Surface surface;
  std::vector<Vec3> normals;  ///< Of unit length, per triangle.
  double diagonal = 0;
};

/// How far a spot of the cage is from the target.
struct Gap {
  Vec3 spot{};          ///< Where it is.
  Vec3 direction{};     ///< Of unit length: the gap grows that way.
  double size = 0;      ///< Distance from the target; negative if the spot is inside of it.
  bool facing = false;  ///< Whether cage and target face the same way. Other gaps say nothing about the placement.
};

/// @param cage  May have moved since the spots were spread.
std::vector<Gap> measureGaps(const Target& target, const TriangleMesh& cage, const std::vector<SurfaceSample>& spots);

/// How a cage lies around its target. Lengths are in the space of the model.
struct Placement {
  double offset = 0;      ///< The median gap.
  double spread = 0;      ///< Standard deviation of the gaps, estimated from the median difference from the offset.
  double unevenness = 0;  ///< Mean difference from the offset, where one counts at most 0.03 of the diagonal.
  double sunk = 0;        ///< Share of the spots that are inside the target by more than 0.0025 of the diagonal.
  double facing = 0;      ///< Share of the spots that face the same way as the target.
};

Placement placementOf(const Target& target, std::span<const Gap> gaps);

/// The scale of an estimate that starts by believing all gaps and ends by believing the usual ones.
/// Residuals r weigh 1 / (1 + (r / scale)²)² in it, which are the weights of Geman and McClure.
class RobustScale {
 public:
  /// @param start  Residuals of this size still count.
  /// @param diagonal  Of the target.
  RobustScale(double start, double diagonal);

  /// Lowers the scale towards the spread of the gaps, but by no more than a factor.
  void tighten(double spread, double factor);
  [[nodiscard]] double weight(double residual) const noexcept;
  /// Whether it got as low as the spread lets it.
  [[nodiscard]] bool settled() const noexcept { return settled_; }

 private:
  double scale_;
  double finest_;
  bool settled_ = false;
};

enum class Growth : std::uint8_t { free, none };

/// How far a cage may be moved.
struct AlignLimits {
  Growth growth;  ///< Whether it may be enlarged or shrunk.
  double reach;   ///< How far off it may be, as a share of the diagonal.
};

/// Moves, turns and, if it may, enlarges or shrinks a cage so that its gaps become as even as possible.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool alignCage(const Target& target, const std::vector<SurfaceSample>& spots, const AlignLimits& limits,
               const Progress& progress, TriangleMesh& cage);

/// Bends a cage that lies about where it belongs so that its gaps become even: by a smooth motion of its vertices.
/// @param reach  How far off the cage may be, as a share of the diagonal.
/// @return false if `progress` cancelled it; it gets shares from 0 to 1.
bool bendCage(const Target& target, const std::vector<SurfaceSample>& spots, double reach, const Progress& progress,
              TriangleMesh& cage);

}  // namespace cagecast::cages
