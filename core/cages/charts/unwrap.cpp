#include "charts/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "charts/flatten.hpp"
#include "charts/limbs.hpp"
#include "charts/pack.hpp"
#include "charts/seams.hpp"
#include "charts/segment.hpp"

namespace cagecast::cages {

namespace {

/// Charts with more energy than this are cut in two (4: no stretch; 5: stretched by about a quarter each way).
constexpr double kMostEnergy = 6;
/// Holes longer than this share of the rim are joined with it by a seam.
constexpr double kLargestHole = 0.45;
/// A head, two arms, two legs.
constexpr std::size_t kMostLimbs = 5;
/// Seams on a head cost this much more in front than at the back.
constexpr double kFrontCost = 12;

/// What all steps share.
class Unwrapper {
 public:
  Unwrapper(const TriangleMesh& mesh, const UnwrapOptions& options, const Progress& progress)
      : options_(options), progress_(progress), whole_(static_cast<double>(mesh.triangles.size())) {}

  /// @return false if cancelled.
  bool layOut(Piece piece);
  bool layOutHead(Piece piece);
  bool layOutBody(const Piece& piece);
  bool layOutProp(const Piece& piece);

  std::vector<Chart>& charts() { return charts_; }

 private:
  const UnwrapOptions& options_;
  const Progress& progress_;
  double whole_, done_ = 0;
  std::vector<Chart> charts_;

  [[nodiscard]] SeamCost backCost(const TriangleMesh& mesh) const;
  [[nodiscard]] SeamCost insideCost(const TriangleMesh& body, const TriangleMesh& limb) const;
  bool layOutLimb(const Piece& piece, std::uint32_t tip, const SeamCost& cost);
  bool report() { return !progress_ || progress_(static_cast<float>(0.95 * std::min(1.0, done_ / whole_)), "unwrap"); }
  void accept(Chart chart);
};

Vec3 centreOf(const TriangleMesh& mesh) {
  Vec3 sum{0, 0, 0};
  double whole = 0;
  for (const Triangle3& t : mesh.triangles) {
    const double area = length(areaNormal(mesh, t));
    whole += area;
    for (const std::uint32_t v : t) sum = sum + area / 3 * mesh.positions[v];
  }
  return whole > 0 ? 1 / whole * sum : Vec3{0, 0, 0};
}

void Unwrapper::accept(Chart chart) {
  done_ += static_cast<double>(chart.piece.triangleOf.size());
  charts_.push_back(std::move(chart));
}

SeamCost flatCost() {
  return [](const TriangleMesh&, std::uint32_t, std::uint32_t) { return 1.0; };
}

/// Seams keep to the back and to the plane between left and right.
SeamCost Unwrapper::backCost(const TriangleMesh& mesh) const {
  const Vec3 centre = centreOf(mesh), side = cross(options_.up, options_.front), front = options_.front;
  const double size = diagonalOf(mesh);
  return [=](const TriangleMesh& of, std::uint32_t from, std::uint32_t to) {
    const Vec3 middle = 0.5 * (of.positions[from] + of.positions[to]) - centre;
    const double aside = std::abs(dot(middle, side)) / size, ahead = std::max(0.0, dot(middle, front)) / size;
    return 1 + 20 * aside + kFrontCost * ahead;
  };
}

/// Seams on a limb keep to where it faces the body's middle, down and back.
SeamCost Unwrapper::insideCost(const TriangleMesh& body, const TriangleMesh& limb) const {
  const Vec3 side = cross(options_.up, options_.front);
  const double aside = dot(centreOf(limb) - centreOf(body), side);
  const Vec3 shown = (aside < 0 ? -1.0 : 1.0) * side + 0.5 * (options_.up + options_.front);
  const Vec3 outward = 1 / length(shown) * shown;
  return [outward, normals = vertexNormals(limb)](const TriangleMesh&, std::uint32_t from, std::uint32_t to) {
    return 0.2 + std::max(0.0, 1 + 0.5 * dot(normals[from] + normals[to], outward));
  };
}

bool Unwrapper::layOut(Piece piece) {
  if (!report()) return false;
  Chart chart = flatten(cutToDisk(std::move(piece), kLargestHole, flatCost()));
  if ((chart.valid && chart.energy < kMostEnergy) || chart.piece.mesh.triangles.size() < 2) {
    accept(std::move(chart));
    return true;
  }
  for (Piece& half : splitBy(chart.piece, halvesOf(chart.piece.mesh)))
    if (!layOut(std::move(half))) return false;
  return true;
}

bool Unwrapper::layOutHead(Piece piece) {
  const TriangleMesh& mesh = piece.mesh;
  const Vec3 centre = centreOf(mesh), side = cross(options_.up, options_.front);
  const auto loops = loopsOf(mesh, findTwins(mesh));
  // The crown is the highest place near the middle; the neck is the longest rim, or else the lowest place.
  std::uint32_t crown = 0, bottom = 0;
  double highest = -1e300, lowest = 1e300;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v] - centre;
    const double aside = 2 * std::abs(dot(p, side));
    if (dot(p, options_.up) - aside > highest) highest = dot(p, options_.up) - aside, crown = v;
    if (dot(p, options_.up) + aside < lowest) lowest = dot(p, options_.up) + aside, bottom = v;
  }
  std::vector<std::uint32_t> ends;
  if (loops.empty()) {
    ends.push_back(bottom);
  } else {
    for (const std::uint32_t h : loops[0]) ends.push_back(originOf(mesh, h));
  }
  const SeamCost cost = backCost(mesh);
  return layOut(cutBetween(piece, {&crown, 1}, ends, cost));
}

bool Unwrapper::layOutLimb(const Piece& piece, std::uint32_t tip, const SeamCost& cost) {
  const auto loops = loopsOf(piece.mesh, findTwins(piece.mesh));
  const auto start = std::find(piece.vertexOf.begin(), piece.vertexOf.end(), tip);
  if (loops.empty() || start == piece.vertexOf.end()) return layOut(piece);
  std::vector<std::uint32_t> rim;
  for (const std::uint32_t h : loops[0]) rim.push_back(originOf(piece.mesh, h));
  const auto first = static_cast<std::uint32_t>(start - piece.vertexOf.begin());
  return layOut(cutBetween(piece, {&first, 1}, rim, cost));
}

bool Unwrapper::layOutBody(const Piece& body) {
  const Limbs limbs = limbsOf(body.mesh, kMostLimbs);
  if (limbs.tips.size() < 2) return layOutProp(body);
  const Vec3 centre = centreOf(body.mesh), side = cross(options_.up, options_.front);
  std::uint32_t head = kNone;
  double highest = 0;
  for (std::uint32_t i = 0; i < limbs.tips.size(); ++i) {
    const Vec3 tip = body.mesh.positions[limbs.tips[i]] - centre;
    const double height = dot(tip, options_.up) - 2 * std::abs(dot(tip, side));
    if (height > highest) highest = height, head = i + 1;
  }
  for (std::uint32_t label = 0; label <= limbs.tips.size(); ++label) {
    for (Piece& piece : piecesOf(body, limbs.labels, label)) {
      bool going = true;
      if (label == 0) {
        for (Piece& half : splitBy(piece, frontAndBackOf(piece.mesh, options_.front)))
          going = going && layOut(std::move(half));
      } else if (label == head) {
        going = layOutHead(std::move(piece));
      } else {
        going = layOutLimb(piece, body.vertexOf[limbs.tips[label - 1]], insideCost(body.mesh, piece.mesh));
      }
      if (!going) return false;
    }
  }
  return true;
}

bool Unwrapper::layOutProp(const Piece& piece) {
  for (Piece& side : splitBy(piece, sidesOf(piece, options_)))
    if (!layOut(std::move(side))) return false;
  return true;
}

/// Turns a chart so that up on the model is up, or for charts that lie flat front is up.
void standUpright(Chart& chart, const UnwrapOptions& options) {
  const TriangleMesh& mesh = chart.piece.mesh;
  const std::array<Vec3, 3> directions{options.up, -1.0 * options.front, cross(options.up, options.front)};
  double best = 0;
  Uv turn{0, 1};
  for (const Vec3& axis : directions) {
    // Where the axis, laid onto each triangle, points in the chart.
    Uv sum{0, 0};
    double whole = 0;
    for (const Triangle3& t : mesh.triangles) {
      const Vec3 e1 = mesh.positions[t[1]] - mesh.positions[t[0]], e2 = mesh.positions[t[2]] - mesh.positions[t[0]];
      const Vec3 n = cross(e1, e2);
      const double square = dot(n, n);
      if (!(square > 0)) continue;
      const double b1 = dot(cross(axis, e2), n) / square, b2 = dot(cross(e1, axis), n) / square;
      const double area = std::sqrt(square);
      whole += area;
      for (std::size_t k = 0; k < 2; ++k)
        sum[k] +=
            area * (b1 * (chart.uvs[t[1]][k] - chart.uvs[t[0]][k]) + b2 * (chart.uvs[t[2]][k] - chart.uvs[t[0]][k]));
    }
    const double size = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1]);
    if (!(whole > 0) || size / whole < 0.2 || best > 0) continue;
    best = size;
    turn = {sum[0] / size, sum[1] / size};
  }
  for (Uv& uv : chart.uvs) uv = {uv[0] * turn[1] - uv[1] * turn[0], uv[0] * turn[0] + uv[1] * turn[1]};
}

/// Gives a chart the area that it has on the model.
void scaleToArea(Chart& chart) {
  double flat = 0, solid = 0;
  for (const Triangle3& t : chart.piece.mesh.triangles) {
    flat += doubledArea(chart.uvs[t[0]], chart.uvs[t[1]], chart.uvs[t[2]]);
    solid += length(areaNormal(chart.piece.mesh, t));
  }
  if (!(flat > 0) || !(solid > 0)) return;
  const double scale = std::sqrt(solid / flat);
  for (Uv& uv : chart.uvs) uv = {scale * uv[0], scale * uv[1]};
}

}  // namespace

bool unwrap(const TriangleMesh& mesh, const UnwrapOptions& options, const Progress& progress, Layout& out) {
  out = {};
  Unwrapper unwrapper(mesh, options, progress);
  for (Piece& piece : componentsOf(wholeOf(mesh))) {
    const bool going = options.kind == Kind::head   ? unwrapper.layOutHead(std::move(piece))
                       : options.kind == Kind::body ? unwrapper.layOutBody(piece)
                                                    : unwrapper.layOutProp(piece);
    if (!going) return false;
  }
  std::vector<Chart>& charts = unwrapper.charts();
  for (Chart& chart : charts) {
    scaleToArea(chart);
    standUpright(chart, options);
  }
  packCharts(charts, options.gutter);
  out.triangles.resize(mesh.triangles.size());
  out.chartOf.resize(mesh.triangles.size());
  out.charts = static_cast<std::uint32_t>(charts.size());
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    const Piece& piece = charts[c].piece;
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (std::size_t v = 0; v < piece.mesh.positions.size(); ++v) {
      out.positions.push_back(piece.mesh.positions[v]);
      out.vertexOf.push_back(piece.vertexOf[v]);
      const Uv& uv = charts[c].uvs[v];
      out.uvs.push_back(
          {static_cast<double>(static_cast<float>(uv[0])), static_cast<double>(static_cast<float>(1 - uv[1]))});
    }
    for (std::size_t t = 0; t < piece.triangleOf.size(); ++t) {
      const Triangle3& from = piece.mesh.triangles[t];
      out.triangles[piece.triangleOf[t]] = {first + from[0], first + from[1], first + from[2]};
      out.chartOf[piece.triangleOf[t]] = c;
    }
  }
  return true;
}

}  // namespace cagecast::cages
