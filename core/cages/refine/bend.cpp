#include "refine/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mesh/progress.hpp"
#include "mesh/thin_plate.hpp"

namespace cagecast::cages {

namespace {

constexpr int kBendSteps = 12;
/// Factor by which a step shrinks the robust scale: faster, as the cage lies about right already.
constexpr double kBendTightening = 0.6;
/// A step that moves no vertex by more than this share of the diagonal is the last one.
constexpr double kBendSettled = 1e-4;
/// The cage may be bent in waves of this length, as a share of the diagonal: a limb, but not a nose.
constexpr double kWave = 0.3;
/// Resistance to motion as such, as a share of the weight of the gaps: holds what no gap says anything about.
constexpr double kHold = 1e-4;
/// Resistance to the motion of a single step: without it, steps along the surface feed each other.
constexpr double kDamping = 1e-2;
/// Cotangents beyond this belong to slivers, whose stiffness would spoil that of their neighbours.
constexpr double kMaxCotangent = 5;
/// Cells around vertices count as at least this share of the mean one, for the same reason.
constexpr double kMinCell = 0.1;

/// Bending energy per coordinate: the square of the Laplacian by cotangents, integrated over the mesh.
std::vector<SparseEntry> bendingOf(const TriangleMesh& mesh) {
  std::vector<SparseEntry> laplacian;
  std::vector<double> cells(mesh.positions.size(), 0);
  double whole = 0;
  for (const Triangle3& t : mesh.triangles) {
    const double twiceArea = length(areaNormal(mesh, t));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t apex = t[i], a = t[(i + 1) % 3], b = t[(i + 2) % 3];
      const double cotangent =
          dot(mesh.positions[a] - mesh.positions[apex], mesh.positions[b] - mesh.positions[apex]) / twiceArea;
      const double weight = 0.5 * std::clamp(cotangent, -kMaxCotangent, kMaxCotangent);
      laplacian.insert(laplacian.end(), {{a, b, -weight}, {b, a, -weight}, {a, a, weight}, {b, b, weight}});
      cells[apex] += twiceArea / 6;
    }
    whole += twiceArea / 2;
  }
  const double least = kMinCell * whole / static_cast<double>(cells.size());
  for (double& cell : cells) cell = 1 / std::max(cell, least);
  return squared(collapsed(std::move(laplacian)), cells);
}

class Bending {
 public:
  Bending(const Target& target, const std::vector<SurfaceSample>& spots, const TriangleMesh& cage)
      : spots_(spots), start_(cage.positions), plate_(cage, bendingOf(cage)) {
    const double area = areaOf(cage), perVertex = area / static_cast<double>(start_.size());
    const double wave = kWave * target.diagonal / (2 * std::numbers::pi);  // Where bending and gaps count alike.
    weights_ = {.bending = std::pow(wave, 4), .hold = kHold * perVertex, .damping = kDamping * perVertex};
    share_ = area / static_cast<double>(spots.size());
  }

  /// @param goOn  As of `SparseSystem::factorize`.
  /// @return The most that a vertex moved; 0 if there is no solution, or if it was cancelled.
  double step(std::span<const Gap> gaps, const RobustScale& scale, double offset, const StepCallback& goOn,
              TriangleMesh& cage) {
    std::vector<PlaneTerm> planes;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      if (!gaps[i].facing) continue;
      const double wanted = offset - gaps[i].size;
      planes.push_back({cage.triangles[spots_[i].triangle], spots_[i].weights,
                        gaps[i].spot + wanted * gaps[i].direction, gaps[i].direction, share_ * scale.weight(wanted)});
    }
    std::vector<Vec3> positions = plate_.solve(start_, planes, weights_, cage.positions, goOn);
    double most = 0;
    for (std::size_t v = 0; v < positions.size(); ++v) most = std::max(most, length(positions[v] - cage.positions[v]));
    if (!positions.empty()) cage.positions = std::move(positions);
    return most;
  }

  /// Moves the corners of triangles that were turned over, which are slivers, all the same way.
  void unfold(TriangleMesh& cage) const {
    constexpr int kUnfoldRounds = 30;
    const TriangleMesh before{start_, cage.triangles};
    bool isFolded = true;
    for (int round = 0; round < kUnfoldRounds && isFolded; ++round) {
      isFolded = false;
      for (const Triangle3& t : cage.triangles) {
        if (dot(areaNormal(cage, t), areaNormal(before, t)) > 0) continue;
        isFolded = true;
        Vec3 way{0, 0, 0};
        for (const std::uint32_t v : t) way = way + 1.0 / 3 * (cage.positions[v] - start_[v]);
        for (const std::uint32_t v : t) cage.positions[v] = start_[v] + way;
      }
    }
  }

 private:
  const std::vector<SurfaceSample>& spots_;
  std::vector<Vec3> start_;
  ThinPlate plate_;
  ThinPlate::Weights weights_;
  double share_ = 0;  ///< Of the cage's area that a spot stands for.
};

}  // namespace

bool bendCage(const Target& target, const std::vector<SurfaceSample>& spots, double reach, const Progress& progress,
              TriangleMesh& cage) {
  Bending bending(target, spots, cage);
  RobustScale scale(reach * target.diagonal, target.diagonal);
  double least = INFINITY;
  std::vector<Vec3> best = cage.positions;
  for (int step = 0; step < kBendSteps; ++step) {
    bool goesOn = true;
    const StepCallback stepOf = [&](double done) {
      return goesOn = report(progress, (step + done) / static_cast<double>(kBendSteps), "bend");
    };
    if (!stepOf(0)) return false;
    const std::vector<Gap> gaps = measureGaps(target, cage, spots);
    const Placement placement = placementOf(target, gaps);
    scale.tighten(placement.spread, kBendTightening);
    if (placement.unevenness < least) {
      least = placement.unevenness;
      best = cage.positions;
    } else if (scale.settled()) {
      break;
    }
    const double moved = bending.step(gaps, scale, placement.offset, stepOf, cage);
    if (!goesOn) return false;
    if (moved < kBendSettled * target.diagonal) break;
  }
  cage.positions = best;
  bending.unfold(cage);
  return true;
}

}  // namespace cagecast::cages
