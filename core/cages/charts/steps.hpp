#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "charts/unwrap.hpp"
#include "mesh/half_edges.hpp"
#include "mesh/progress.hpp"

/// The steps of unwrapping, each in a file of its own.
namespace cagecast::cages {

/// Tells a caller how far an unwrap is, and remembers if it was cancelled; then everything returns early.
class Ticker {
 public:
  explicit Ticker(const Progress& progress) : progress_(progress) {}

  /// Sets the share that is done.
  void reach(double share) { share_ = std::max(share_, std::min(share, 1.0)); }

  /// Counts work, in triangles looked at, and asks the caller now and then.
  /// @return false if cancelled.
  bool work(std::size_t triangles) {
    work_ += triangles;
    if (work_ < kWorkPerReport || cancelled_) return !cancelled_;
    work_ = 0;
    cancelled_ = !report(progress_, share_, "unwrap");
    return !cancelled_;
  }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  /// Takes about 5 ms natively, 15 ms in WebAssembly.
  static constexpr std::size_t kWorkPerReport = 6000;
  const Progress& progress_;
  double share_ = 0;
  std::size_t work_ = kWorkPerReport;
  bool cancelled_ = false;
};

/// Part of a mesh with vertices of its own, each of which has one connected fan of triangles.
struct Piece {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertexOf;    ///< The vertex of the whole mesh for each vertex; `kNone` for made ones.
  std::vector<std::uint32_t> triangleOf;  ///< The triangle of the whole mesh for each triangle.
};

/// The whole of a mesh, whose vertices may still have several fans: `cutOpen` gives each its own.
Piece wholeOf(const TriangleMesh& mesh);

/// Some triangles of a piece; vertices stay, also those that none of them uses.
template <typename Condition>
Piece partOf(const Piece& piece, const Condition& isIn) {
  Piece part{{piece.mesh.positions, {}}, piece.vertexOf, {}};
  for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t) {
    if (!isIn(t)) continue;
    part.mesh.triangles.push_back(piece.mesh.triangles[t]);
    part.triangleOf.push_back(piece.triangleOf[t]);
  }
  return part;
}

/// Cuts a piece open along edges: vertices are doubled where the surface does not go on round them any more.
/// @param cut  Per half-edge; an edge is cut if one of its two is marked. Empty: none is.
Piece cutOpen(const Piece& piece, const std::vector<bool>& cut = {});

/// The connected pieces of each region of a piece, region by region.
/// @param regions  Per triangle, from 0.
std::vector<Piece> splitBy(const Piece& piece, std::span<const std::uint32_t> regions);

/// The connected pieces of one region of a piece.
std::vector<Piece> piecesOf(const Piece& piece, std::span<const std::uint32_t> regions, std::uint32_t region);

/// The connected pieces of a piece, in the order of their first triangles.
std::vector<Piece> componentsOf(const Piece& piece);

/// The boundary of a piece as closed walks of half-edges, the longest first.
std::vector<std::vector<std::uint32_t>> loopsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> twins);

/// The vertices of a walk of half-edges.
std::vector<std::uint32_t> originsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> walk);
/// The length of a walk of half-edges.
double lengthOf(const TriangleMesh& mesh, std::span<const std::uint32_t> walk);

/// What a seam along an edge costs, per unit of length; above 0.
using SeamCost = std::function<double(const TriangleMesh& mesh, std::uint32_t from, std::uint32_t to)>;

/// Distances along edges from some vertices, with the way back.
struct EdgeDistances {
  std::vector<double> distance;
  std::vector<std::uint32_t> cameBy;  ///< The half-edge by which each vertex was reached; `kNone` at a start.
};

/// @param cost  If empty, edges count their length.
EdgeDistances edgeDistances(const TriangleMesh& mesh, std::span<const std::uint32_t> starts, const SeamCost& cost);

/// Cuts a piece along the cheapest way between two sets of vertices.
Piece cutBetween(const Piece& piece, std::span<const std::uint32_t> starts, std::span<const std::uint32_t> ends,
                 const SeamCost& cost);

/// Cuts a connected piece until it is a disk with small holes: opens closed surfaces, cuts handles, and joins larger
/// holes with the longest boundary loop.
Piece cutToDisk(Piece piece, const SeamCost& cost);

/// Parts of a body that stick out: arms, legs, a head, a tail, ears.
struct Limbs {
  std::vector<std::uint32_t> labels;  ///< Per triangle: 0 for the trunk, i + 1 for limb i.
  std::vector<std::uint32_t> tips;    ///< The outermost vertex of each limb.
};

/// Finds the limbs of a connected piece by the mean distance of each vertex to all others along the surface: limbs are
/// where it rises to a peak, and end where that region runs into another (the join tree). They are cut off along the
/// shortest loop thereabouts.
/// @param most  How many at most; the longest are kept.
Limbs limbsOf(const TriangleMesh& mesh, std::size_t most);

/// Labels the triangles of a piece by the side of a box that they face, in few connected regions.
/// @return a label per triangle; regions of one label are connected.
std::vector<std::uint32_t> sidesOf(const Piece& piece, const UnwrapOptions& options, Ticker& ticker);

/// Labels what faces front and what faces back, with a short border between.
std::vector<std::uint32_t> frontAndBackOf(const TriangleMesh& mesh, const Vec3& front, Ticker& ticker);

/// Whether each triangle is of a face: one connected region, as far as it is turned to the face's front, with a short
/// border. None is if the mesh does not pass before the eyes.
std::vector<bool> faceTriangles(const TriangleMesh& mesh, const FaceFrame& face);

/// Labels two connected halves of a connected piece of at least two triangles.
std::vector<std::uint32_t> halvesOf(const TriangleMesh& mesh);

/// Numbers the connected regions of equal labels: 0, 1, … in the order of their first triangles.
std::vector<std::uint32_t> regionsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& labels);

/// Joins regions smaller than `least` of the whole area, and the smallest ones while there are more than `most`, with
/// the neighbour that they have the longest border with.
/// @param[in,out] regions  Numbered as by `regionsOf`, afterwards with gaps.
void joinSmallRegions(const TriangleMesh& mesh, double least, std::size_t most, Ticker& ticker,
                      std::vector<std::uint32_t>& regions);

/// Twice the signed area.
inline double doubledArea(const Uv& a, const Uv& b, const Uv& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// A box in the plane of UVs; empty until a point is added.
struct UvBox {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Uv low{kFar, kFar}, high{-kFar, -kFar};

  void add(const Uv& uv) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], uv[k]);
      high[k] = std::max(high[k], uv[k]);
    }
  }
  [[nodiscard]] double side(std::size_t k) const { return high[k] - low[k]; }
  [[nodiscard]] bool meets(const UvBox& other) const {
    return low[0] < other.high[0] && other.low[0] < high[0] && low[1] < other.high[1] && other.low[1] < high[1];
  }
};

/// A chart: part of a mesh, laid flat at its true size.
struct Chart {
  Piece piece;
  std::vector<Uv> uvs;
  double energy = 0;   ///< Symmetric Dirichlet, mean by area: 4 without stretch.
  bool valid = false;  ///< No flipped triangle, no overlap.

  [[nodiscard]] UvBox box() const {
    UvBox out;
    for (const Uv& uv : uvs) out.add(uv);
    return out;
  }
  /// The area in the plane of UVs.
  [[nodiscard]] double area() const {
    double out = 0;
    for (const Triangle3& t : piece.mesh.triangles) out += doubledArea(uvs[t[0]], uvs[t[1]], uvs[t[2]]) / 2;
    return out;
  }
};

/// The length of the seams over the middle of a face, in distances of the eyes.
double seamsOnFace(const TriangleMesh& mesh, const FaceFrame& face, const std::vector<Chart>& charts);

/// Lays a piece flat: from a convex map (Tutte) by SLIM, stopping short of overlap.
/// @param piece  With a boundary and of genus 0. Its longest boundary loop becomes the rim, others stay holes.
/// @return an invalid chart if `ticker` is cancelled.
Chart flatten(Piece piece, Ticker& ticker);

/// Pairs of triangles whose insides meet, up to `most`. Exact if the coordinates are 32-bit floats.
std::uint32_t countOverlaps(const std::vector<Uv>& uvs, const std::vector<Triangle3>& triangles, std::uint32_t most);

struct MergeOptions {
  double mostEnergy = 0;   ///< Charts are joined if the result has no more.
  std::size_t enough = 1;  ///< Stops at so many charts.
  double leastFill = 0;    ///< Of the box of a chart.
  double longest = 0;      ///< Longest side of the box of a chart.
  Vec3 axis{0, 0, 0};      ///< Charts that face along it are joined with none that do not; 0 if it does not matter.
};

/// Joins neighbouring charts, those with the longest common border first, where the result lies flat well enough.
/// Seams within the charts stay.
/// @param mesh  The whole mesh that the charts are of.
void mergeCharts(const TriangleMesh& mesh, const MergeOptions& options, Ticker& ticker, std::vector<Chart>& charts);

/// Scales all charts alike and moves them, not turned, into the unit square, as large as they fit.
/// @param gutter  Least distance between charts, and half of it to the border; less if there are thousands of charts.
/// @return false if cancelled.
bool packCharts(double gutter, Ticker& ticker, std::vector<Chart>& charts);

}  // namespace cagecast::cages
