// What says that a cage is in place: its gaps to the model are as even as they can be. Their size, whether parts of the
// model lie outside, and how well the holes fit say less: a cage that is a little too large hides any of them.
#include <algorithm>
#include <cmath>

#include "cagecast/cages.hpp"
#include "mesh/bounds.hpp"
#include "mesh/check_model.hpp"
#include "mesh/progress.hpp"
#include "refine/steps.hpp"

namespace cagecast::cages {

namespace {

/// Spots of the cage. With 3000 the result differs by less than 0.01 % of the diagonal from that with 12,000.
constexpr std::size_t kSpots = 3000;
/// A cage is moved or bent only if that makes its gaps so many times as even. Cages in place reach 1.4 by being moved:
/// those whose makers left more room in one place than in another.
constexpr double kWorthwhile = 1.5;
/// The same if the gaps then differ by less than kCrisp of their usual size, on the mean. Cages with so even gaps were
/// made at a fixed distance; in place, they reach 1.05.
constexpr double kWorthwhileIfCrisp = 1.25;
constexpr double kCrisp = 0.12;
/// A cage that would move by less than this share of the diagonal stays.
constexpr double kMinMove = 0.0015;
/// More than this share of the cage cannot be meant to lie inside the model.
constexpr double kMaxSunk = 0.1;
/// At least this share of a cage faces the same way as the model beneath it.
constexpr double kMinFacing = 0.7;
/// A cage whose gaps differ by more than this share of the diagonal, on the mean, is of another model. Those of cages
/// in place differ by up to 0.008.
constexpr double kMaxUneven = 0.02;
/// A cage is bent only if more than this share of it is inside the model. A smooth bend can even out any cage with more
/// room in one place than in another, but such cages may be meant so.
constexpr double kBendFrom = 0.005;
/// Vertices of the cage this close together, as a share of the diagonal, move as one: seams, and poles of balls.
constexpr double kWeld = 1e-6;
Status fault(Code code, double value = 0) { return {code, Argument::cage, 0, Option::none, static_cast<float>(value)}; }

/// Whether a cage is anywhere near its model, so that closest points mean something.
Status checkNearness(const Bounds& cage, const Bounds& model, double reach) {
  const double gap = model.distance(cage) / model.diagonal();
  if (gap > reach) return fault(Code::cageApart, gap);
  constexpr double kLargest = 2;
  const double size = cage.diagonal() / model.diagonal();
  return size > kLargest ? fault(Code::cageTooLarge, size) : Status{};
}

/// A copy of a mesh in which positions that are equal once rounded are one vertex.
TriangleMesh weldNearly(const MeshView& mesh, double unit, std::vector<std::uint32_t>& vertexOf) {
  std::vector<float> rounded;
  rounded.reserve(mesh.positions.size());
  for (const float x : mesh.positions)
    rounded.push_back(static_cast<float>(unit * std::round(static_cast<double>(x) / unit)));
  return weldExactly({rounded, mesh.indices}, &vertexOf);
}

/// A cage in some place, and how it lies there.
struct Candidate {
  TriangleMesh cage;
  Placement placement;
};

class Refinement {
 public:
  Refinement(const TriangleMesh& cage, const TriangleMesh& model, double reach, const Progress& progress)
      : target_(model), spots_(spreadSamples(cage, kSpots)), reach_(reach), progress_(progress) {
    given_ = {cage, placementOf(target_, measureGaps(target_, cage, spots_))};
  }

  /// @return false if it was cancelled.
  bool run() {
    Candidate aligned, bent;
    if (!align(Growth::free, 0, aligned)) return false;
    // A cage that is bent can be shrunk into the model so that it is equally far inside everywhere.
    constexpr double kSinks = 0.02;
    if (aligned.placement.sunk > given_.placement.sunk + kSinks && !align(Growth::none, 0.3f, aligned)) return false;
    if (aligned.placement.sunk > kBendFrom) {
      if (!bend(aligned, bent)) return false;
      // The spread of the better half of the gaps is no measure of a bend, which fits some of them at any price.
      if (isMoreEven(bent, aligned) && !sinks(bent, aligned) && !isFolded(bent.cage)) aligned = std::move(bent);
    }
    best_ = std::move(aligned);
    const bool isBetter = isMoreEven(best_, given_, isCrisp(best_) ? kWorthwhileIfCrisp : kWorthwhile) ||
                          kWorthwhile * best_.placement.spread < given_.placement.spread;
    stays_ = !isBetter || sinks(best_, given_) || moved() < kMinMove * target_.diagonal;
    if (stays_) best_ = given_;
    return report(progress_, 1, "bend");
  }

  /// Whether what came out is a cage of this model at all.
  [[nodiscard]] Status judge() const {
    const Placement& placement = best_.placement;
    if (placement.facing < kMinFacing) return fault(Code::cageFacesAway, placement.facing);
    const double uneven = placement.unevenness / target_.diagonal, far = moved() / target_.diagonal;
    if (uneven > kMaxUneven) return fault(Code::cageUneven, uneven);
    if (placement.sunk > kMaxSunk) return fault(Code::cageInside, placement.sunk);
    if (far > reach_) return fault(Code::cageOff, far);
    return {};
  }

  [[nodiscard]] bool stays() const noexcept { return stays_; }
  [[nodiscard]] const TriangleMesh& cage() const noexcept { return best_.cage; }

 private:
  bool align(Growth growth, float from, Candidate& out) {
    out.cage = given_.cage;
    if (!alignCage(target_, spots_, {growth, reach_}, partOf(progress_, from, from + 0.3f), out.cage)) return false;
    out.placement = placementOf(target_, measureGaps(target_, out.cage, spots_));
    return true;
  }

  bool bend(const Candidate& aligned, Candidate& out) {
    out.cage = aligned.cage;
    if (!bendCage(target_, spots_, reach_, partOf(progress_, 0.6f, 1), out.cage)) return false;
    out.placement = placementOf(target_, measureGaps(target_, out.cage, spots_));
    return true;
  }

  [[nodiscard]] static bool isMoreEven(const Candidate& a, const Candidate& b, double times = kWorthwhile) {
    return times * a.placement.unevenness < b.placement.unevenness;
  }

  [[nodiscard]] static bool isCrisp(const Candidate& candidate) {
    return candidate.placement.unevenness < kCrisp * candidate.placement.offset;
  }

  /// Whether one of two candidates is further inside the model.
  [[nodiscard]] static bool sinks(const Candidate& a, const Candidate& b) {
    constexpr double kMore = 0.01;  // Of the cage.
    return a.placement.sunk > b.placement.sunk + kMore;
  }

  /// Whether a triangle was turned over on the way.
  [[nodiscard]] bool isFolded(const TriangleMesh& cage) const {
    for (const Triangle3& t : cage.triangles)
      if (dot(areaNormal(cage, t), areaNormal(given_.cage, t)) < 0) return true;
    return false;
  }

  /// How far the cage moved: the root of the mean square over its spots.
  [[nodiscard]] double moved() const {
    const std::vector<Gap> before = measureGaps(target_, given_.cage, spots_);
    const std::vector<Gap> after = measureGaps(target_, best_.cage, spots_);
    double squares = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Vec3 way = after[i].spot - before[i].spot;
      squares += dot(way, way) / static_cast<double>(before.size());
    }
    return std::sqrt(squares);
  }

  Target target_;
  std::vector<SurfaceSample> spots_;
  double reach_;
  const Progress& progress_;
  Candidate given_, best_;
  bool stays_ = true;
};

Status refine(const MeshView& cage, const Model& model, const RefineOptions& options, const Progress& progress,
              Cage& out) {
  if (const Status status = checkMesh(cage, Argument::cage); !status.ok()) return status;
  if (const Status status = checkModel(model); !status.ok()) return status;
  if (const Status status = checkOption(Option::reach, options.reach); !status.ok()) return status;
  const TriangleMesh target = weldExactly(model.mesh);
  std::vector<std::uint32_t> vertexOf;
  const TriangleMesh welded = weldNearly(cage, kWeld * diagonalOf(target), vertexOf);
  if (welded.empty()) return fault(Code::vanishingCage);
  const double reach = static_cast<double>(options.reach);
  if (const Status status = checkNearness(boundsOf(welded), boundsOf(target), reach); !status.ok()) return status;
  if (!report(progress, 0, "align")) return kAborted;
  Refinement refinement(welded, target, reach, progress);
  if (!refinement.run()) return kAborted;
  if (const Status status = refinement.judge(); !status.ok()) return status;
  Cage refined;  // `out` may own the cage.
  refined.uvs.assign(cage.uvs.begin(), cage.uvs.end());
  refined.indices.assign(cage.indices.begin(), cage.indices.end());
  if (refinement.stays()) refined.positions.assign(cage.positions.begin(), cage.positions.end());
  for (std::size_t v = 0; v < vertexOf.size() && !refinement.stays(); ++v)
    append(refined.positions, Vec3::from(&cage.positions[3 * v]) + refinement.cage().positions[vertexOf[v]] -
                                  welded.positions[vertexOf[v]]);
  out = std::move(refined);
  return {};
}

}  // namespace

Status refineCage(const MeshView& cage, const Model& model, const RefineOptions& options, const Progress& progress,
                  Cage& out) {
  return guarded([&] { return refine(cage, model, options, progress, out); });
}

}  // namespace cagecast::cages
