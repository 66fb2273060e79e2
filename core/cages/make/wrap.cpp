#include "make/steps.hpp"

#include "mesh/progress.hpp"
#include "mesh/samples.hpp"
#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// How many points of the model are tested for whether they are in its hull.
constexpr std::size_t kLookedFor = 4000;
/// Of the outer area that is to be painted, a hull should not leave out more than this: a hand is 1 % of a figure, a
/// head 8 %. Area tells it, for heads and limbs have little volume.
constexpr double kLostAtBest = 0.03;
/// If it leaves out more than this, that is no odd piece, such as what floats about a scan, and the hull is of no use.
constexpr double kLostAtMost = 0.1;
/// If too much is left out, gaps are bridged that are wider by this factor.
constexpr double kWider = 2.5;

/// The share of the outer unmarked area that is outside the hull.
double lostShare(const TriangleMesh& mesh, const std::vector<bool>& isMarked, const HullOptions& options,
                 const TriangleMesh& hull) {
  std::vector<bool> isPainted = isMarked;
  isPainted.flip();
  const std::vector<Vec3> points = spreadPoints(subset(mesh, isPainted), kLookedFor);
  const double rounding = diagonalOf(mesh) / options.voxels;
  std::size_t lost = 0, kept = 0;
  for (const SurfacePoint& point : Surface(hull).closest(points)) {
    if (point.height > 0 && point.distance > rounding)
      ++lost;
    else if (point.distance < options.closing + options.offset + rounding)
      ++kept;  // What is deeper is inside the model.
  }
  return lost == 0 ? 0 : static_cast<double>(lost) / static_cast<double>(lost + kept);
}

}  // namespace

Status wrap(const TriangleMesh& mesh, const std::vector<bool>& isMarked, const WrapOptions& options,
            const Progress& progress, TriangleMesh& out) {
  double share = 1;  // Of the volume: less than 1 if there are pieces.
  if (!makeHull(mesh, options.hull, progress, out, &share)) return kAborted;
  if (out.empty()) return {Code::noVolume, Argument::model};
  if (share == 1) return {};
  const double lost = lostShare(mesh, isMarked, options.hull, out);
  if (lost > kLostAtBest && options.mayWiden) {
    HullOptions wider = options.hull;
    wider.closing *= kWider;
    TriangleMesh hull;
    if (!makeHull(mesh, wider, progress, hull)) return kAborted;
    if (!hull.empty() && lostShare(mesh, isMarked, wider, hull) <= kLostAtBest) {
      out = std::move(hull);
      return {};
    }
  }
  return lost <= kLostAtMost ? Status{} : Status{Code::inPieces, Argument::model};
}

}  // namespace cagecast::cages
